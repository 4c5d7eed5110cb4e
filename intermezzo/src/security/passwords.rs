//! Passwords that nobody can guess, and the list of them that the router has.

use crate::exit::Failure;

/// The router's list: a line `name:password` for everybody.
pub(crate) const LIST: &str = "credentials.txt";

/// Where a ready configuration wants the password.
pub(crate) const PLACE: &str = "PASSWORD";

/// No two of these are easily taken for each other, and there are thirty-two.
const LETTERS: &[u8; 32] = b"abcdefghijkmnpqrstuvwxyz23456789";

/// Five bits each: 160 in all.
const LENGTH: usize = 32;

/// A new password.
pub(crate) fn password() -> Result<String, Failure> {
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
