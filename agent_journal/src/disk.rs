//! Where a journal is kept: on a file that is replaced as a whole or not at all.

use std::fmt::{Debug, Display};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use redb::StorageBackend;
use redb::backends::FileBackend;

use super::error::JournalError;

/// What redb writes to.
pub type Medium = Box<dyn StorageBackend>;

/// Where a journal is kept. Whoever has one is the only one to write there.
pub trait Disk: Debug + Send {
    /// What messages call it.
    fn name(&self) -> String;

    /// What is there, only to be read; `None` if there is nothing.
    ///
    /// # Errors
    /// If that cannot be told.
    fn look(&self) -> io::Result<Option<Medium>>;

    /// What is there, to be written.
    ///
    /// # Errors
    /// If there is nothing, or it cannot be written.
    fn open(&self) -> io::Result<Medium>;

    /// An empty medium beside what is there.
    ///
    /// # Errors
    /// If there is no room for it.
    fn begin_anew(&self) -> io::Result<Medium>;

    /// What was begun anew takes the place of what is there, at once and durably.
    ///
    /// # Errors
    /// If that is not certain. Whatever is there afterwards is whole.
    fn put_in_place(&self) -> io::Result<()>;

    /// What was begun anew is not wanted.
    fn give_up(&self) {}
}

/// A file, the lock beside it, and sometimes its successor.
#[derive(Debug)]
pub struct FileDisk {
    path: PathBuf,
    /// The lock is on a file of its own, since the journal itself may be replaced.
    _lock: File,
}

impl FileDisk {
    /// The journal at `path`, whose directory is made. The system takes the lock from a process that
    /// ends, however it ends.
    ///
    /// # Errors
    /// If another process has it, or the directory cannot be written.
    pub fn lock(path: &Path) -> Result<Self, JournalError> {
        let failed = |why| JournalError::Io {
            place: path.display().to_string(),
            why,
        };
        if let Some(directory) = path.parent() {
            fs::create_dir_all(directory).map_err(failed)?;
        }
        let mut options = OpenOptions::new();
        let options = options.write(true).create(true).truncate(false);
        let lock = options.open(path.with_extension("lock")).map_err(failed)?;
        match lock.try_lock() {
            Ok(()) => Ok(Self {
                path: path.to_owned(),
                _lock: lock,
            }),
            Err(TryLockError::WouldBlock) => Err(JournalError::InUse {
                place: path.display().to_string(),
            }),
            Err(TryLockError::Error(why)) => Err(failed(why)),
        }
    }

    fn successor(&self) -> PathBuf {
        self.path.with_extension("new")
    }
}

impl Disk for FileDisk {
    fn name(&self) -> String {
        self.path.display().to_string()
    }

    fn look(&self) -> io::Result<Option<Medium>> {
        match File::open(&self.path) {
            Ok(file) => Ok(Some(Box::new(ReadOnly(file)))),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn open(&self) -> io::Result<Medium> {
        let mut options = OpenOptions::new();
        let file = options.read(true).write(true).open(&self.path)?;
        backend(file)
    }

    fn begin_anew(&self) -> io::Result<Medium> {
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(true);
        backend(options.open(self.successor())?)
    }

    fn put_in_place(&self) -> io::Result<()> {
        fs::rename(self.successor(), &self.path)?;
        sync_directory(&self.path)
    }

    fn give_up(&self) {
        // What cannot be removed is overwritten next time.
        let _ = fs::remove_file(self.successor());
    }
}

fn backend(file: File) -> io::Result<Medium> {
    let backend = FileBackend::new(file).map_err(io::Error::other)?;
    Ok(Box::new(backend))
}

/// A new name is on the disk only when its directory is.
fn sync_directory(path: &Path) -> io::Result<()> {
    match path.parent() {
        #[cfg(unix)]
        Some(directory) => File::open(directory)?.sync_all(),
        _ => Ok(()),
    }
}

/// A file that is not written to, whatever happens.
#[derive(Debug)]
struct ReadOnly(File);

impl StorageBackend for ReadOnly {
    fn len(&self) -> io::Result<u64> {
        Ok(self.0.metadata()?.len())
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        use std::io::{Read, Seek, SeekFrom};
        let mut file = &self.0;
        file.seek(SeekFrom::Start(offset))?;
        file.read_exact(out)
    }

    fn set_len(&self, _len: u64) -> io::Result<()> {
        Err(refused())
    }

    fn sync_data(&self) -> io::Result<()> {
        Err(refused())
    }

    fn write(&self, _offset: u64, _data: &[u8]) -> io::Result<()> {
        Err(refused())
    }
}

fn refused() -> io::Error {
    io::Error::new(io::ErrorKind::PermissionDenied, "it is only being read")
}

/// A medium of any kind, as redb takes it.
#[derive(Debug)]
pub(super) struct AnyMedium(pub(super) Medium);

impl StorageBackend for AnyMedium {
    fn len(&self) -> io::Result<u64> {
        self.0.len()
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        self.0.read(offset, out)
    }

    fn set_len(&self, len: u64) -> io::Result<()> {
        self.0.set_len(len)
    }

    fn sync_data(&self) -> io::Result<()> {
        self.0.sync_data()
    }

    fn write(&self, offset: u64, data: &[u8]) -> io::Result<()> {
        self.0.write(offset, data)
    }

    fn close(&self) -> io::Result<()> {
        self.0.close()
    }
}

/// In words, without the words that say that it is an error.
pub(super) fn in_words(error: impl Display) -> String {
    let text = error.to_string();
    match text.strip_prefix("I/O error: ") {
        Some(rest) => rest.to_owned(),
        None => text,
    }
}
