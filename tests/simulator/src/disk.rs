//! A disk in memory that forgets what was not synced.

use std::collections::BTreeMap;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use agent_journal::{Disk, Medium, StorageBackend};

use crate::dice::Dice;

const PAGE: usize = 4096;

/// A disk with one journal on it. Copies are the same disk; see [`fork`](Self::fork).
#[derive(Clone, Debug, Default)]
pub struct MemoryDisk(Arc<Mutex<State>>);

#[derive(Clone, Debug, Default)]
struct State {
    files: BTreeMap<u64, Contents>,
    opened: u64,
    current: Option<u64>,
    successor: Option<u64>,
    /// Whoever has opened something in a former life can do nothing with it any more.
    life: u64,
    /// Changes and syncs until the process is no more.
    left: Option<u64>,
    calls: u64,
    full: bool,
}

/// A file as a process sees it, and what of that is certain.
#[derive(Clone, Debug, Default)]
struct Contents {
    seen: Image,
    durable: Image,
    pending: Vec<Change>,
}

#[derive(Clone, Debug, Default)]
struct Image {
    len: u64,
    /// What is not here is zero.
    pages: BTreeMap<u64, Arc<[u8; PAGE]>>,
}

#[derive(Clone, Debug)]
enum Change {
    Len(u64),
    Write(u64, Vec<u8>),
}

impl Image {
    fn apply(&mut self, change: &Change) {
        match change {
            Change::Len(len) => {
                if *len < self.len {
                    let last = len / PAGE as u64;
                    self.pages.retain(|page, _| *page <= last);
                    if let Some(page) = self.pages.get_mut(&last) {
                        Arc::make_mut(page)[(len % PAGE as u64) as usize..].fill(0);
                    }
                }
                self.len = *len;
            }
            Change::Write(offset, data) => {
                let mut rest = &data[..];
                let mut at = *offset;
                while !rest.is_empty() {
                    let within = (at % PAGE as u64) as usize;
                    let (now, later) = rest.split_at(rest.len().min(PAGE - within));
                    let page = self.pages.entry(at / PAGE as u64);
                    let page = page.or_insert_with(|| Arc::new([0; PAGE]));
                    Arc::make_mut(page)[within..within + now.len()].copy_from_slice(now);
                    at += now.len() as u64;
                    rest = later;
                }
                self.len = self.len.max(at);
            }
        }
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        let end = offset.checked_add(out.len() as u64);
        if end.is_none_or(|end| end > self.len) {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let (mut at, mut rest) = (offset, out);
        while !rest.is_empty() {
            let within = (at % PAGE as u64) as usize;
            let many = rest.len().min(PAGE - within);
            let (now, later) = rest.split_at_mut(many);
            match self.pages.get(&(at / PAGE as u64)) {
                Some(page) => now.copy_from_slice(&page[within..within + now.len()]),
                None => now.fill(0),
            }
            at += now.len() as u64;
            rest = later;
        }
        Ok(())
    }
}

impl Contents {
    fn change(&mut self, change: Change) {
        self.seen.apply(&change);
        self.pending.push(change);
    }

    fn sync(&mut self) {
        for change in std::mem::take(&mut self.pending) {
            self.durable.apply(&change);
        }
    }

    /// What is found of it afterwards.
    fn crash(&mut self, dice: &mut Dice) {
        let pending = std::mem::take(&mut self.pending);
        let fate = dice.roll(4);
        let torn = if fate == 3 {
            dice.roll(pending.len() as u64 + 1) as usize
        } else {
            usize::MAX
        };
        for (n, mut change) in pending.into_iter().enumerate() {
            let kept = match fate {
                0 => false,
                // The process is no more, and the system goes on.
                1 => true,
                _ => n == torn || dice.per_mille(500),
            };
            if let (true, Change::Write(_, data)) = (n == torn, &mut change) {
                data.truncate(dice.roll(data.len() as u64) as usize);
            }
            if kept {
                self.durable.apply(&change);
            }
        }
        self.seen = self.durable.clone();
    }
}

impl MemoryDisk {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Another disk with the same on it.
    #[must_use]
    pub fn fork(&self) -> Self {
        Self(Arc::new(Mutex::new(self.state().clone())))
    }

    /// The process that writes to it comes to nothing after so many more changes and syncs.
    pub fn dies_after(&self, calls: u64) {
        self.state().left = Some(calls);
    }

    /// Whether it has come to that.
    pub fn is_dead(&self) -> bool {
        self.state().left == Some(0)
    }

    /// How many changes and syncs there were.
    pub fn calls(&self) -> u64 {
        self.state().calls
    }

    /// Whether nothing can be written.
    pub fn set_full(&self, full: bool) {
        self.state().full = full;
    }

    /// The process is no more, and perhaps the power was gone, too: of what was not synced chance
    /// keeps all, nothing, or any part.
    pub fn crash(&self, dice: &mut Dice) {
        let mut state = self.state();
        state.life += 1;
        state.left = None;
        let (current, successor) = (state.current, state.successor.take());
        if let Some(successor) = successor.filter(|file| Some(*file) != current) {
            state.files.remove(&successor);
        }
        state.files.retain(|file, _| Some(*file) == current);
        for contents in state.files.values_mut() {
            contents.crash(dice);
        }
    }

    fn medium(&self, file: u64) -> Medium {
        Box::new(MemoryMedium {
            disk: self.clone(),
            life: self.state().life,
            file,
        })
    }
}

impl State {
    /// Something is about to be changed.
    fn call(&mut self, life: u64) -> io::Result<()> {
        if self.life != life || self.left == Some(0) {
            return Err(io::Error::other("the process is no more"));
        }
        if self.full {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.left = self.left.map(|left| left - 1);
        self.calls += 1;
        Ok(())
    }

    fn file(&mut self, file: u64) -> io::Result<&mut Contents> {
        self.files
            .get_mut(&file)
            .ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

impl Disk for MemoryDisk {
    fn name(&self) -> String {
        "in memory".to_owned()
    }

    fn look(&self) -> io::Result<Option<Medium>> {
        let current = self.state().current;
        Ok(current.map(|file| self.medium(file)))
    }

    fn open(&self) -> io::Result<Medium> {
        self.look()?.ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn begin_anew(&self) -> io::Result<Medium> {
        let mut state = self.state();
        let life = state.life;
        state.call(life)?;
        state.opened += 1;
        let file = state.opened;
        state.files.insert(file, Contents::default());
        state.successor = Some(file);
        drop(state);
        Ok(self.medium(file))
    }

    fn put_in_place(&self) -> io::Result<()> {
        let mut state = self.state();
        let life = state.life;
        state.call(life)?;
        state.current = state.successor.take();
        Ok(())
    }
}

/// A file that a process has opened.
#[derive(Debug)]
struct MemoryMedium {
    disk: MemoryDisk,
    life: u64,
    file: u64,
}

impl MemoryMedium {
    fn change(&self, change: Change) -> io::Result<()> {
        let mut state = self.disk.state();
        state.call(self.life)?;
        state.file(self.file)?.change(change);
        Ok(())
    }
}

impl StorageBackend for MemoryMedium {
    fn len(&self) -> io::Result<u64> {
        Ok(self.disk.state().file(self.file)?.seen.len)
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        self.disk.state().file(self.file)?.seen.read(offset, out)
    }

    fn set_len(&self, len: u64) -> io::Result<()> {
        self.change(Change::Len(len))
    }

    fn sync_data(&self) -> io::Result<()> {
        let mut state = self.disk.state();
        state.call(self.life)?;
        state.file(self.file)?.sync();
        Ok(())
    }

    fn write(&self, offset: u64, data: &[u8]) -> io::Result<()> {
        self.change(Change::Write(offset, data.to_vec()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_synced_survives_and_what_was_not_may() {
        let mut found = [0; 2];
        for seed in 0..40 {
            let disk = MemoryDisk::default();
            let medium = disk.begin_anew().expect("there is room");
            medium.write(4000, &[1; 200]).expect("there is room");
            medium.sync_data().expect("it is synced");
            disk.put_in_place().expect("it is put in place");
            medium.write(0, &[2; 10]).expect("there is room");
            disk.crash(&mut Dice(seed));
            assert!(medium.write(0, &[3]).is_err(), "it is of a former life");
            let medium = disk.open().expect("it is there");
            let mut bytes = [0; 200];
            medium.read(4000, &mut bytes).expect("it is there");
            assert_eq!(bytes, [1; 200]);
            medium.read(0, &mut bytes).expect("it is there");
            assert!([0, 2].contains(&bytes[0]));
            found[usize::from(bytes[0] == 2)] += 1;
        }
        assert!(found.iter().all(|times| *times > 5), "{found:?}");
    }
}
