//! A temporary directory for the state of a robot. One whose `up` was killed is removed by the next.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use tempfile::TempDir;

/// What the names of all of them begin with.
const PREFIX: &str = "intermezzo-";
/// What tells one of them from a directory that a user has named with `--state`; locked by whoever
/// uses it.
const MARK: &str = "temporary.lock";
/// The mark before it is locked.
const NEW_MARK: &str = "temporary.new";
/// For people who find one.
const WORDS: &[u8] = b"Belongs to an `intermezzo up` without --state. If that was killed, the next one removes this.\n";

/// A directory that is removed when this is dropped.
#[derive(Debug)]
pub(super) struct Temporary {
    directory: TempDir,
    /// Locked. Closed after the directory is removed.
    mark: File,
}

impl Temporary {
    /// Makes one, and removes those of this user that nobody uses any more.
    ///
    /// # Errors
    /// If it cannot be made. Others that cannot be removed are left where they are.
    pub(super) fn new() -> io::Result<Self> {
        Self::new_in(&std::env::temp_dir())
    }

    fn new_in(parent: &Path) -> io::Result<Self> {
        let directory = private_in(parent)?;
        let new = directory.path().join(NEW_MARK);
        let mut mark = File::create_new(&new)?;
        mark.write_all(WORDS)?;
        mark.try_lock()?;
        // It is locked from the moment when it can be seen.
        fs::rename(&new, directory.path().join(MARK))?;
        remove_abandoned(parent, &fs::symlink_metadata(directory.path())?);
        Ok(Self { directory, mark })
    }

    pub(super) fn path(&self) -> &Path {
        self.directory.path()
    }

    /// Whoever holds this file open uses the directory.
    pub(super) fn mark(&self) -> &File {
        &self.mark
    }
}

/// A new one that only its user may look into.
fn private_in(parent: &Path) -> io::Result<TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
    builder.tempdir_in(parent)
}

/// Removes those that no process uses, of the user whose new one is `own`.
fn remove_abandoned(parent: &Path, own: &fs::Metadata) {
    // What cannot be looked for can stay: nobody waits for it.
    let Ok(entries) = fs::read_dir(parent) else {
        return;
    };
    for entry in entries.flatten() {
        let is_ours = entry
            .file_name()
            .to_str()
            .is_some_and(|name| name.starts_with(PREFIX));
        if is_ours && let Err(error) = remove_if_abandoned(&entry.path(), own) {
            tracing::debug!("cannot remove {}: {error}", entry.path().display());
        }
    }
}

fn remove_if_abandoned(directory: &Path, own: &fs::Metadata) -> io::Result<()> {
    // Of the thing itself, not of what a link leads to.
    if !is_private(&fs::symlink_metadata(directory)?, own) {
        return Ok(());
    }
    let mark = match File::open(directory.join(MARK)) {
        Ok(mark) => mark,
        // Not one of these, or just being made or removed.
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(error),
    };
    if mark.try_lock().is_err() {
        return Ok(());
    }
    // The mark goes last: if this process is killed meanwhile, the next one goes on.
    for entry in fs::read_dir(directory)? {
        let entry = entry?;
        let path = entry.path();
        if entry.file_name() == MARK {
            continue;
        }
        if entry.file_type()?.is_dir() {
            fs::remove_dir_all(&path)?;
        } else {
            fs::remove_file(&path)?;
        }
    }
    fs::remove_file(directory.join(MARK))?;
    fs::remove_dir(directory)
}

/// Whether it is a directory of the same user that nobody else may look into.
#[cfg(unix)]
fn is_private(metadata: &fs::Metadata, own: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    metadata.is_dir() && metadata.uid() == own.uid() && metadata.mode() & 0o077 == 0
}

/// Elsewhere a role that outlives its `up` for a moment does not hold its locks: nothing is removed.
#[cfg(not(unix))]
fn is_private(_metadata: &fs::Metadata, _own: &fs::Metadata) -> bool {
    false
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::{PermissionsExt, symlink};
    use std::path::PathBuf;

    use super::*;

    /// As a killed process leaves it.
    fn abandoned(parent: &Path) -> PathBuf {
        let mut temporary = Temporary::new_in(parent).unwrap();
        fs::create_dir(temporary.path().join("robot")).unwrap();
        fs::write(temporary.path().join("robot").join("parent.redb"), "…").unwrap();
        temporary.directory.disable_cleanup(true);
        temporary.path().to_owned()
    }

    /// Makes others until it is gone. Usually that is one; but a process that another test is just
    /// starting has all files of this one for a moment.
    fn is_removed_by_the_next(parent: &Path, directory: &Path) -> bool {
        (0..10_000).any(|_| {
            drop(Temporary::new_in(parent).unwrap());
            !directory.exists()
        })
    }

    #[test]
    fn one_that_was_left_behind_is_removed_by_the_next() {
        let parent = tempfile::tempdir().unwrap();
        let left = abandoned(parent.path());
        assert!(left.join("robot").is_dir());
        assert!(is_removed_by_the_next(parent.path(), &left));
        let next = Temporary::new_in(parent.path()).unwrap();
        assert!(next.path().is_dir());
    }

    #[test]
    fn one_that_is_in_use_stays_as_it_is() {
        let parent = tempfile::tempdir().unwrap();
        let used = Temporary::new_in(parent.path()).unwrap();
        let file = used.path().join("file");
        fs::write(&file, "").unwrap();
        let _other = Temporary::new_in(parent.path()).unwrap();
        assert!(file.is_file());
    }

    #[test]
    fn one_whose_process_is_gone_stays_while_another_that_was_given_the_mark_lives() {
        let parent = tempfile::tempdir().unwrap();
        let mut temporary = Temporary::new_in(parent.path()).unwrap();
        temporary.directory.disable_cleanup(true);
        let path = temporary.path().to_owned();
        // What a child process inherits.
        let of_a_role = temporary.mark().try_clone().unwrap();
        drop(temporary);
        drop(Temporary::new_in(parent.path()).unwrap());
        assert!(path.is_dir());
        drop(of_a_role);
        assert!(is_removed_by_the_next(parent.path(), &path));
    }

    #[test]
    fn what_a_user_has_made_is_not_touched() {
        let parent = tempfile::tempdir().unwrap();
        // A directory for --state that looks like one of ours.
        let named = parent.path().join("intermezzo-state");
        fs::create_dir_all(named.join("robot")).unwrap();
        // One that others may look into is not from here, whatever is in it.
        let open = abandoned(parent.path());
        fs::set_permissions(&open, fs::Permissions::from_mode(0o755)).unwrap();
        // A link to one elsewhere.
        let elsewhere = tempfile::tempdir().unwrap();
        let target = abandoned(elsewhere.path());
        symlink(&target, parent.path().join("intermezzo-link")).unwrap();
        drop(Temporary::new_in(parent.path()).unwrap());
        for directory in [named.join("robot"), open.join("robot"), target] {
            assert!(directory.is_dir(), "{}", directory.display());
        }
    }

    #[test]
    fn one_half_removed_is_removed_by_the_next() {
        let parent = tempfile::tempdir().unwrap();
        let left = abandoned(parent.path());
        fs::remove_dir_all(left.join("robot")).unwrap();
        assert!(is_removed_by_the_next(parent.path(), &left));
    }
}
