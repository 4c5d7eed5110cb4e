//! A disk that is slow, full, or gone at the wrong moment.

use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard};

use agent_link::Memory;
use agent_link::journal::{Disk, Identity, Journal, Medium, StorageBackend};

/// A disk in memory that outlives whoever writes to it, and does what it is told.
#[derive(Clone, Debug, Default)]
pub struct ToyDisk {
    files: Arc<Mutex<Files>>,
    mood: Arc<Mood>,
}

type Bytes = Arc<Mutex<Vec<u8>>>;

#[derive(Debug, Default)]
struct Files {
    journal: Option<Bytes>,
    successor: Option<Bytes>,
}

#[derive(Debug, Default)]
struct Mood {
    /// Shut, full.
    is: Mutex<(bool, bool)>,
    changed: Condvar,
}

impl ToyDisk {
    /// The journal on it.
    pub fn memory(&self) -> Memory {
        let whose = Identity {
            robot: "near".into(),
            role: "toy".into(),
            place: "here".into(),
        };
        Some(Journal::on(self.clone(), whose).expect("it is a journal of this robot"))
    }

    /// A disk with what is on it now: what somebody finds after a kill at this moment.
    pub fn after_a_kill(&self) -> Self {
        let copy = Self::default();
        let bytes = locked(&self.files).journal.as_ref().map(|file| {
            let bytes = locked(file).clone();
            Arc::new(Mutex::new(bytes))
        });
        locked(&copy.files).journal = bytes;
        copy
    }

    /// All that is on it now.
    pub fn bytes(&self) -> Vec<u8> {
        let files = locked(&self.files);
        let journal = files.journal.as_ref();
        journal.map_or_else(Vec::new, |file| locked(file).clone())
    }

    /// While it is shut, whoever writes waits.
    pub fn shut(&self, shut: bool) {
        locked(&self.mood.is).0 = shut;
        self.mood.changed.notify_all();
    }

    /// While it is full, nothing can be written.
    pub fn full(&self, full: bool) {
        locked(&self.mood.is).1 = full;
    }

    fn medium(&self, file: Option<&Bytes>) -> io::Result<Medium> {
        let bytes = file.ok_or(io::ErrorKind::NotFound)?.clone();
        let mood = self.mood.clone();
        Ok(Box::new(ToyMedium { bytes, mood }))
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().expect("nobody panics with it")
}

impl Disk for ToyDisk {
    fn name(&self) -> String {
        "the toy disk".into()
    }

    fn look(&self) -> io::Result<Option<Medium>> {
        let files = locked(&self.files);
        let journal = files.journal.as_ref();
        journal
            .map(|journal| self.medium(Some(journal)))
            .transpose()
    }

    fn open(&self) -> io::Result<Medium> {
        self.medium(locked(&self.files).journal.as_ref())
    }

    fn begin_anew(&self) -> io::Result<Medium> {
        let mut files = locked(&self.files);
        files.successor = Some(Bytes::default());
        self.medium(files.successor.as_ref())
    }

    fn put_in_place(&self) -> io::Result<()> {
        let mut files = locked(&self.files);
        files.journal = files.successor.take();
        Ok(())
    }
}

#[derive(Debug)]
struct ToyMedium {
    bytes: Bytes,
    mood: Arc<Mood>,
}

impl ToyMedium {
    fn check(&self) -> io::Result<()> {
        let is = self.mood.is.lock().expect("nobody panics with it");
        let is = self
            .mood
            .changed
            .wait_while(is, |(shut, _)| *shut)
            .expect("nobody panics with it");
        if is.1 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        Ok(())
    }
}

impl StorageBackend for ToyMedium {
    fn len(&self) -> io::Result<u64> {
        Ok(locked(&self.bytes).len() as u64)
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        let bytes = locked(&self.bytes);
        let part = bytes.get(offset as usize..offset as usize + out.len());
        out.copy_from_slice(part.ok_or(io::ErrorKind::UnexpectedEof)?);
        Ok(())
    }

    fn set_len(&self, len: u64) -> io::Result<()> {
        locked(&self.bytes).resize(len as usize, 0);
        Ok(())
    }

    fn sync_data(&self) -> io::Result<()> {
        self.check()
    }

    fn write(&self, offset: u64, data: &[u8]) -> io::Result<()> {
        self.check()?;
        let mut bytes = locked(&self.bytes);
        let end = offset as usize + data.len();
        if bytes.len() < end {
            bytes.resize(end, 0);
        }
        bytes[offset as usize..end].copy_from_slice(data);
        Ok(())
    }
}
