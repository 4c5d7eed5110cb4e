//! Which robots run on this machine, and where they can be reached.
//!
//! Each has a file in the user's runtime directory, and holds a lock on it for as long as it
//! lives. The system takes the lock from a process that ends, however it ends, so a file that
//! nobody holds is stale; no process number has to be trusted.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use crate::keys::{Keys, NameError};

/// No entry is longer; what is, is not ours.
const MAX_ENTRY_BYTES: u64 = 4096;

/// Held while entries come and go, so that none is taken away that was put there meanwhile.
const GUARD: &str = ".lock";

/// A robot that runs.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct RunningRobot {
    /// Its name.
    pub robot: String,
    /// Where its router listens.
    pub endpoint: String,
    /// The process that carries the router.
    pub pid: u32,
    /// When that started, in seconds since 1970.
    pub started_unix_s: u64,
}

/// Why a robot was not found or not entered.
#[derive(Debug, thiserror::Error)]
pub enum RegistryError {
    /// None at all.
    #[error("no robot is running; start one with `intermezzo up maps/museum`")]
    NoneRunning,
    /// Not this one.
    #[error("robot `{wanted}` is not running; running: {running}")]
    NotRunning {
        /// The name that was given.
        wanted: String,
        /// Those that do run.
        running: String,
    },
    /// Which one is meant?
    #[error("{count} robots are running: {running}; choose one with --robot")]
    Several {
        /// How many.
        count: usize,
        /// Their names.
        running: String,
    },
    /// There can be one of a name.
    #[error(
        "robot `{}` is running already (process {}): end that one, or choose another name with --robot",
        .0.robot, .0.pid
    )]
    Taken(RunningRobot),
    /// Not a name.
    #[error(transparent)]
    Name(#[from] NameError),
    /// Somebody else could write there.
    #[error(
        "the directory {} is not this user's alone: remove it, or set XDG_RUNTIME_DIR to one that is",
        .0.display()
    )]
    NotPrivate(PathBuf),
    /// The file system.
    #[error("cannot use {}: {why}", path.display())]
    Io {
        /// Where.
        path: PathBuf,
        /// In the system's words.
        why: io::Error,
    },
}

/// The directory with one file for each running robot.
#[derive(Clone, Debug)]
pub struct Registry {
    directory: PathBuf,
}

/// Keeps a robot in the registry while it lives.
#[derive(Debug)]
pub struct Entry {
    path: PathBuf,
    registry: Registry,
    /// Locked.
    _file: File,
}

impl Registry {
    /// That of the user: in `$XDG_RUNTIME_DIR`, or else among temporary files.
    pub fn of_user() -> Result<Self, RegistryError> {
        let directory = match std::env::var_os("XDG_RUNTIME_DIR") {
            Some(runtime) if !runtime.is_empty() => PathBuf::from(runtime).join("intermezzo"),
            _ => {
                let user = std::env::var("USER").unwrap_or_else(|_| "user".to_owned());
                let user: String = user.chars().filter(|c| c.is_alphanumeric()).collect();
                std::env::temp_dir().join(format!("intermezzo-{user}"))
            }
        };
        Self::at(&directory)
    }

    /// That in `directory`, which is made if it is not there.
    pub fn at(directory: &Path) -> Result<Self, RegistryError> {
        make_private(directory)?;
        Ok(Self {
            directory: directory.to_owned(),
        })
    }

    /// Enters a robot of this process. It stays until the result is dropped or the process ends.
    pub fn enter(&self, robot: &str, endpoint: &str) -> Result<Entry, RegistryError> {
        Keys::new(robot)?;
        let _guard = self.guard()?;
        let path = self.directory.join(format!("{robot}.json"));
        if let Some(running) = self.look(&path)? {
            return Err(RegistryError::Taken(running));
        }
        let entry = RunningRobot {
            robot: robot.to_owned(),
            endpoint: endpoint.to_owned(),
            pid: std::process::id(),
            started_unix_s: SystemTime::now()
                .duration_since(UNIX_EPOCH)
                .map_or(0, |since| since.as_secs()),
        };
        // Complete and locked before anyone can see it.
        let unfinished = self.directory.join(format!(".{robot}.new"));
        let file = (|| {
            let mut file = File::create(&unfinished)?;
            file.lock()?;
            file.write_all(&serde_json::to_vec(&entry)?)?;
            fs::rename(&unfinished, &path)?;
            Ok(file)
        })()
        .map_err(at(&path))?;
        Ok(Entry {
            path,
            registry: self.clone(),
            _file: file,
        })
    }

    /// All robots that run, by name. Stale files are removed.
    pub fn running(&self) -> Result<Vec<RunningRobot>, RegistryError> {
        let _guard = self.guard()?;
        let mut running = Vec::new();
        for file in fs::read_dir(&self.directory).map_err(at(&self.directory))? {
            let path = file.map_err(at(&self.directory))?.path();
            if path
                .extension()
                .is_some_and(|extension| extension == "json")
            {
                running.extend(self.look(&path)?);
            }
        }
        running.sort_by(|a, b| a.robot.cmp(&b.robot));
        Ok(running)
    }

    /// The robot of this name; without a name, the only one that runs.
    pub fn find(&self, robot: Option<&str>) -> Result<RunningRobot, RegistryError> {
        let mut running = self.running()?;
        let names = running.iter().map(|entry| entry.robot.as_str());
        let names = names.collect::<Vec<_>>().join(", ");
        match (robot, running.len()) {
            (_, 0) => Err(RegistryError::NoneRunning),
            (None, 1) => Ok(running.remove(0)),
            (None, count) => Err(RegistryError::Several {
                count,
                running: names,
            }),
            (Some(wanted), _) => running
                .into_iter()
                .find(|entry| entry.robot == wanted)
                .ok_or_else(|| RegistryError::NotRunning {
                    wanted: wanted.to_owned(),
                    running: names,
                }),
        }
    }

    /// The entry in a file. One that nobody holds is removed; one that makes no sense is not ours.
    fn look(&self, path: &Path) -> Result<Option<RunningRobot>, RegistryError> {
        let mut file = match File::open(path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(why) => return Err(at(path)(why)),
        };
        match file.try_lock_shared() {
            Err(TryLockError::WouldBlock) => {}
            Ok(()) => {
                tracing::info!("{} was left behind and is removed", path.display());
                fs::remove_file(path).map_err(at(path))?;
                return Ok(None);
            }
            Err(TryLockError::Error(why)) => return Err(at(path)(why)),
        }
        let mut text = Vec::new();
        let mut limited = Read::by_ref(&mut file).take(MAX_ENTRY_BYTES);
        limited.read_to_end(&mut text).map_err(at(path))?;
        match serde_json::from_slice(&text) {
            Ok(entry) => Ok(Some(entry)),
            Err(error) => {
                tracing::warn!("{} is not a robot's entry: {error}", path.display());
                Ok(None)
            }
        }
    }

    /// One process at a time.
    fn guard(&self) -> Result<File, RegistryError> {
        let path = self.directory.join(GUARD);
        let mut options = OpenOptions::new();
        let options = options.write(true).create(true).truncate(false);
        let file = options.open(&path).map_err(at(&path))?;
        file.lock().map_err(at(&path))?;
        Ok(file)
    }
}

impl Drop for Entry {
    fn drop(&mut self) {
        // If this fails, the next to look removes the file.
        if let Ok(_guard) = self.registry.guard() {
            let _ = fs::remove_file(&self.path);
        }
    }
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> RegistryError + Copy {
    |why| RegistryError::Io {
        path: path.to_owned(),
        why,
    }
}

/// Makes the directory for this user alone, or makes sure that it is.
///
/// Among temporary files anyone may have made it first, to send this user's goals elsewhere.
fn make_private(directory: &Path) -> Result<(), RegistryError> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::DirBuilderExt;
        builder.mode(0o700);
    }
    builder.create(directory).map_err(at(directory))?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let found = fs::symlink_metadata(directory).map_err(at(directory))?;
        if !found.is_dir() || found.mode() & 0o077 != 0 {
            return Err(RegistryError::NotPrivate(directory.to_owned()));
        }
        // A file made here belongs to this process's user; so should the directory.
        let path = directory.join(GUARD);
        let mut options = OpenOptions::new();
        let options = options.write(true).create(true).truncate(false);
        let own = options.open(&path).and_then(|file| file.metadata());
        if own.map_err(at(&path))?.uid() != found.uid() {
            return Err(RegistryError::NotPrivate(directory.to_owned()));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn registry() -> (tempfile::TempDir, Registry) {
        let parent = tempfile::tempdir().unwrap();
        let registry = Registry::at(&parent.path().join("intermezzo")).unwrap();
        (parent, registry)
    }

    #[test]
    fn the_only_robot_needs_no_name_and_of_several_one_must_be_chosen() {
        let (_parent, registry) = registry();
        let error = registry.find(None).unwrap_err().to_string();
        assert_eq!(
            error,
            "no robot is running; start one with `intermezzo up maps/museum`"
        );
        let a = registry.enter("a", "tcp/127.0.0.1:1").unwrap();
        assert_eq!(registry.find(None).unwrap().endpoint, "tcp/127.0.0.1:1");
        let _b = registry.enter("b", "tcp/127.0.0.1:2").unwrap();
        let error = registry.find(None).unwrap_err().to_string();
        assert_eq!(error, "2 robots are running: a, b; choose one with --robot");
        assert_eq!(registry.find(Some("b")).unwrap().robot, "b");
        let error = registry.find(Some("c")).unwrap_err().to_string();
        assert_eq!(error, "robot `c` is not running; running: a, b");
        drop(a);
        assert_eq!(registry.find(None).unwrap().robot, "b");
    }

    #[test]
    fn there_is_one_robot_of_a_name_and_its_name_is_no_path() {
        let (_parent, registry) = registry();
        let _a = registry.enter("a", "tcp/127.0.0.1:1").unwrap();
        let error = registry.enter("a", "tcp/127.0.0.1:2").unwrap_err();
        assert!(error.to_string().contains("is running already"), "{error}");
        assert!(registry.enter("../a", "x").is_err());
    }

    #[test]
    fn what_a_dead_process_left_behind_is_removed() {
        let (_parent, registry) = registry();
        let path = registry.directory.join("dead.json");
        let entry = r#"{"robot":"dead","endpoint":"x","pid":1,"started_unix_s":0}"#;
        fs::write(&path, entry).unwrap();
        assert_eq!(registry.running().unwrap(), []);
        assert!(!path.exists());
        fs::write(&path, entry).unwrap();
        assert!(registry.enter("dead", "tcp/127.0.0.1:1").is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn a_directory_that_others_can_write_to_is_refused() {
        use std::os::unix::fs::PermissionsExt;
        let parent = tempfile::tempdir().unwrap();
        let open = parent.path().join("intermezzo");
        fs::create_dir(&open).unwrap();
        fs::set_permissions(&open, fs::Permissions::from_mode(0o777)).unwrap();
        let error = Registry::at(&open).unwrap_err();
        assert!(matches!(error, RegistryError::NotPrivate(_)), "{error}");
    }
}
