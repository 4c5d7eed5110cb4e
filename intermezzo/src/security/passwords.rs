//! Passwords that nobody can guess, and the list of them that the router has.

use std::path::{Path, PathBuf};

use super::folder::{Folder, read};
use crate::exit::Failure;

/// The router's list: a line `name:password` for everybody.
pub(crate) const LIST: &str = "credentials.txt";

/// The router's list, as it is and as it will be.
pub(crate) struct Passwords {
    path: PathBuf,
    lines: Vec<String>,
}

impl Passwords {
    /// A new one, for that folder.
    pub(crate) fn none(dir: &Path) -> Self {
        Self {
            path: dir.join(LIST),
            lines: Vec::new(),
        }
    }

    /// The one in that folder.
    pub(crate) fn read(dir: &Path) -> Result<Self, Failure> {
        let mut list = Self::none(dir);
        let text = read(&list.path)?;
        list.lines = text.lines().map(ToOwned::to_owned).collect();
        Ok(list)
    }

    /// The ready configuration of somebody, with a new password that is on the list from now on.
    pub(crate) fn known_by(&mut self, name: &str, ready: &str) -> Result<String, Failure> {
        if self.lines.iter().any(|line| is_of(line, name)) {
            let there = format!("{} knows `{name}` already", self.path.display());
            return Err(Failure::bad_input(there));
        }
        let password = password()?;
        self.lines.push(format!("{name}:{password}"));
        Ok(ready.replace(PLACE, &password))
    }

    /// Takes somebody off the list.
    pub(crate) fn forget(&mut self, name: &str) {
        self.lines.retain(|line| !is_of(line, name));
    }

    /// What stands in the file.
    pub(crate) fn text(&self) -> String {
        self.lines.iter().map(|line| format!("{line}\n")).collect()
    }

    /// Writes it into its folder.
    pub(crate) fn write(&self, dir: &Path) -> Result<(), Failure> {
        let mut folder = Folder::new(dir, true);
        folder.put(LIST, self.text());
        folder.write().map(|_| ())
    }
}

fn is_of(line: &str, name: &str) -> bool {
    line.split(':').next() == Some(name)
}

/// Where a ready configuration wants the password.
pub(crate) const PLACE: &str = "PASSWORD";

/// No two of these are easily taken for each other, and there are thirty-two.
const LETTERS: &[u8; 32] = b"abcdefghijkmnpqrstuvwxyz23456789";

/// Five bits each: 160 in all.
const LENGTH: usize = 32;

/// A new password.
fn password() -> Result<String, Failure> {
    let mut random = [0; LENGTH];
    getrandom::fill(&mut random)
        .map_err(|error| Failure::failed(format_args!("this machine has no chance: {error}")))?;
    let letters = random.iter().map(|byte| usize::from(*byte) % LETTERS.len());
    Ok(letters
        .filter_map(|place| LETTERS.get(place).copied().map(char::from))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_passwords_are_alike() {
        let passwords: std::collections::BTreeSet<String> =
            (0..100).map(|_| password().unwrap()).collect();
        assert_eq!(passwords.len(), 100);
        assert!(passwords.iter().all(|password| password.len() == LENGTH));
    }
}
