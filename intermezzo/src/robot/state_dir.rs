//! Where a robot's roles keep what must not be lost.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::temporary::Temporary;
use crate::exit::Failure;

/// Locked by the `up` that uses the directory.
const UP: &str = "up.lock";
/// Locked by that `up` and all its roles, for as long as any of them lives.
const ROLES: &str = "roles.lock";
/// The roles of an `up` that was killed stop the robot and end within this.
const PATIENCE: Duration = Duration::from_secs(15);
/// A process that is just being started has for a moment all files of the one that starts it, locks
/// included. Whoever uses the directory still has its lock after this.
const MOMENT: Duration = Duration::from_millis(300);
/// Between two looks.
const RETRY: Duration = Duration::from_millis(20);
/// No list of processes is longer; what is, is not ours.
const MAX_LIST_BYTES: u64 = 4096;

/// The directory with the journals of one robot, for this `up` alone.
#[derive(Debug)]
pub(super) struct StateDir {
    /// What the roles are given: their files are in a folder of the robot's name in it.
    pub(super) path: PathBuf,
    roles: File,
    /// Locked.
    _up: File,
    /// Removed at the end, after the locks are gone.
    _temporary: Option<Temporary>,
}

impl StateDir {
    /// Takes the directory of `robot` in `wanted`, or in a temporary one that is gone at the end (or, if
    /// this process is killed, when the next one is made). Waits until the roles of an `up` that was
    /// killed have ended.
    ///
    /// # Errors
    /// If another `up` uses it, or processes that do will not end.
    pub(super) async fn take(wanted: Option<&Path>, robot: &str) -> Result<Self, Failure> {
        let (path, temporary) = match wanted {
            Some(path) => (path.to_owned(), None),
            None => {
                let temporary = Temporary::new().and_then(|temporary| {
                    share_with_children(temporary.mark())?;
                    Ok(temporary)
                });
                let temporary = temporary.map_err(|error| {
                    Failure::failed(format_args!("cannot make a temporary directory: {error}"))
                        .advice("name a directory with --state")
                })?;
                (temporary.path().to_owned(), Some(temporary))
            }
        };
        let own = path.join(robot);
        let failed = |error: io::Error| {
            Failure::bad_input(format_args!(
                "cannot keep state in {}: {error}",
                own.display()
            ))
            .advice("name a directory that you may write to with --state")
        };
        make_private(&own).map_err(failed)?;
        let mut up = open(&own.join(UP)).map_err(failed)?;
        if !locked_within(&up, MOMENT).await.map_err(failed)? {
            let process = match list(&mut up) {
                list if list.is_empty() => String::new(),
                list => format!(" (process {list})"),
            };
            return Err(Failure::bad_input(format_args!(
                "the state of robot `{robot}` in {} is in use by another `intermezzo up`{process}",
                path.display()
            ))
            .advice("end that one, or choose another --state or --robot"));
        }
        write(&mut up, &std::process::id().to_string()).map_err(failed)?;
        let mut roles = open(&own.join(ROLES)).map_err(failed)?;
        if !locked_within(&roles, PATIENCE).await.map_err(failed)? {
            return Err(Failure::failed(format_args!(
                "processes of robot `{robot}` that were started earlier still use its state in {} and do not end: {}",
                path.display(),
                list(&mut roles)
            ))
            .advice("end them, with kill -9 if need be"));
        }
        share_with_children(&roles).map_err(failed)?;
        Ok(Self {
            path,
            roles,
            _up: up,
            _temporary: temporary,
        })
    }

    /// Notes the processes that use it, for people who find them left over.
    pub(super) fn note(&mut self, processes: &str) {
        if let Err(error) = write(&mut self.roles, processes) {
            tracing::warn!("cannot note the processes of the roles: {error}");
        }
    }
}

fn open(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    options.open(path)
}

/// Whether the lock could be had in that time.
async fn locked_within(file: &File, patience: Duration) -> io::Result<bool> {
    let asked = Instant::now();
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(true),
            Err(TryLockError::WouldBlock) if asked.elapsed() >= patience => return Ok(false),
            Err(TryLockError::WouldBlock) => tokio::time::sleep(RETRY).await,
            Err(TryLockError::Error(error)) => return Err(error),
        }
    }
}

fn write(file: &mut File, text: &str) -> io::Result<()> {
    file.set_len(0)?;
    file.rewind()?;
    file.write_all(text.as_bytes())
}

/// What was noted in a file, on one line.
fn list(file: &mut File) -> String {
    let mut text = String::new();
    let read = file.rewind().and_then(|()| {
        Read::by_ref(file)
            .take(MAX_LIST_BYTES)
            .read_to_string(&mut text)
    });
    match read {
        Ok(_) => text.lines().collect::<Vec<_>>().join(", "),
        Err(_) => String::new(),
    }
}

/// What the robot is to do and believes is nobody else's business.
fn make_private(directory: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(directory)
}

/// Processes that are started from now on hold the file's lock too: the system takes it from the
/// last of them, however they end.
#[cfg(unix)]
fn share_with_children(file: &File) -> io::Result<()> {
    use nix::fcntl::{FcntlArg, FdFlag, fcntl};
    fcntl(file, FcntlArg::F_SETFD(FdFlag::empty()))?;
    Ok(())
}

#[cfg(not(unix))]
fn share_with_children(_file: &File) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn two_cannot_use_the_same_state_and_the_second_is_told_who_does() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("new");
        let first = StateDir::take(Some(&path), "robot").await.unwrap();
        let failure = StateDir::take(Some(&path), "robot").await.unwrap_err();
        let process = format!("(process {})", std::process::id());
        assert!(failure.what.contains(&process), "{failure:?}");
        let other = StateDir::take(Some(&path), "other").await;
        assert!(other.is_ok(), "{other:?}");
        drop(first);
        let again = StateDir::take(Some(&path), "robot").await;
        assert!(again.is_ok(), "{again:?}");
    }

    #[tokio::test]
    async fn a_temporary_one_is_removed_at_the_end() {
        let state = StateDir::take(None, "robot").await.unwrap();
        let path = state.path.clone();
        assert!(path.join("robot").is_dir());
        drop(state);
        assert!(!path.exists());
    }

    #[tokio::test]
    async fn a_directory_that_cannot_be_is_named() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("file");
        fs::write(&file, "").unwrap();
        let failure = StateDir::take(Some(&file), "robot").await.unwrap_err();
        assert!(failure.what.contains("file"), "{failure:?}");
    }

    /// A process with the lock, as a role that outlives its `up` for a while.
    #[cfg(unix)]
    #[tokio::test]
    async fn the_roles_of_a_former_up_are_waited_for() {
        let directory = tempfile::tempdir().unwrap();
        let mut state = StateDir::take(Some(directory.path()), "robot")
            .await
            .unwrap();
        let mut role = tokio::process::Command::new("cat")
            .stdin(std::process::Stdio::piped())
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        state.note("child 1");
        drop(state);
        let taken = StateDir::take(Some(directory.path()), "robot");
        let mut taken = std::pin::pin!(taken);
        let waits = tokio::time::timeout(Duration::from_millis(200), &mut taken).await;
        assert!(waits.is_err(), "{waits:?}");
        drop(role.stdin.take());
        let taken = taken.await;
        assert!(taken.is_ok(), "{taken:?}");
        role.wait().await.unwrap();
    }
}
