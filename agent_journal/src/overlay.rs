//! Looking at a journal without touching it.

use std::collections::BTreeMap;
use std::io;
use std::sync::{Mutex, MutexGuard, PoisonError};

use redb::StorageBackend;

use super::disk::Medium;

/// What is changed is kept in pieces of this size.
const PIECE: usize = 4096;

/// A medium that is only read. What is written to it is kept in memory: redb puts a journal right
/// that was not closed when it opens it, and nobody knows yet whether it is a journal.
#[derive(Debug)]
pub(super) struct Overlay {
    below: Medium,
    below_len: u64,
    above: Mutex<Above>,
}

#[derive(Debug)]
struct Above {
    len: u64,
    pieces: BTreeMap<u64, Box<[u8; PIECE]>>,
}

impl Overlay {
    pub(super) fn on(below: Medium) -> io::Result<Self> {
        let len = below.len()?;
        Ok(Self {
            below,
            below_len: len,
            above: Mutex::new(Above {
                len,
                pieces: BTreeMap::new(),
            }),
        })
    }

    fn above(&self) -> MutexGuard<'_, Above> {
        // Nothing is left half done where something could panic.
        self.above.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A piece as it is below; beyond the end there are zeros.
    fn piece_below(&self, piece: u64) -> io::Result<Box<[u8; PIECE]>> {
        let mut bytes = Box::new([0; PIECE]);
        let start = piece * PIECE as u64;
        let there = self.below_len.saturating_sub(start).min(PIECE as u64) as usize;
        if there > 0 {
            self.below.read(start, &mut bytes[..there])?;
        }
        Ok(bytes)
    }
}

/// The parts of a range of bytes that lie in one piece each: piece, where in it, how many.
fn parts(offset: u64, len: usize) -> impl Iterator<Item = (u64, usize, usize)> {
    let end = offset + len as u64;
    let mut at = offset;
    std::iter::from_fn(move || {
        (at < end).then(|| {
            let within = (at % PIECE as u64) as usize;
            let count = (end - at).min((PIECE - within) as u64) as usize;
            let part = (at / PIECE as u64, within, count);
            at += count as u64;
            part
        })
    })
}

impl StorageBackend for Overlay {
    fn len(&self) -> io::Result<u64> {
        Ok(self.above().len)
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        let above = self.above();
        let end = offset.checked_add(out.len() as u64);
        if end.is_none_or(|end| end > above.len) {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let mut done = 0;
        for (piece, within, count) in parts(offset, out.len()) {
            let target = &mut out[done..done + count];
            match above.pieces.get(&piece) {
                Some(bytes) => target.copy_from_slice(&bytes[within..within + count]),
                None => target.copy_from_slice(&self.piece_below(piece)?[within..within + count]),
            }
            done += count;
        }
        Ok(())
    }

    fn set_len(&self, len: u64) -> io::Result<()> {
        let mut above = self.above();
        if len < above.len {
            // What is beyond the end reads as zeros should there be an end further out again.
            let last = len / PIECE as u64;
            above.pieces.retain(|piece, _| *piece <= last);
            let mut bytes = match above.pieces.remove(&last) {
                Some(bytes) => bytes,
                None => self.piece_below(last)?,
            };
            bytes[(len % PIECE as u64) as usize..].fill(0);
            above.pieces.insert(last, bytes);
            for piece in last + 1..=self.below_len / PIECE as u64 {
                above.pieces.insert(piece, Box::new([0; PIECE]));
            }
        }
        above.len = len;
        Ok(())
    }

    fn sync_data(&self) -> io::Result<()> {
        Ok(())
    }

    fn write(&self, offset: u64, data: &[u8]) -> io::Result<()> {
        let mut above = self.above();
        let mut done = 0;
        for (piece, within, count) in parts(offset, data.len()) {
            let mut bytes = match above.pieces.remove(&piece) {
                Some(bytes) => bytes,
                None => self.piece_below(piece)?,
            };
            bytes[within..within + count].copy_from_slice(&data[done..done + count]);
            above.pieces.insert(piece, bytes);
            done += count;
        }
        above.len = above.len.max(offset + data.len() as u64);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use redb::backends::InMemoryBackend;

    use super::*;

    #[test]
    fn what_is_written_above_is_read_above_and_not_below() {
        let below = InMemoryBackend::new();
        below.set_len(10_000).unwrap();
        below.write(0, &[1; 10_000]).unwrap();
        let overlay = Overlay::on(Box::new(below)).unwrap();
        overlay.write(4090, &[2; 12]).unwrap();
        let mut read = [0; 16];
        overlay.read(4088, &mut read).unwrap();
        assert_eq!(read, [1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 1, 1]);
        overlay.below.read(4088, &mut read).unwrap();
        assert_eq!(read, [1; 16]);
        assert!(overlay.read(9_999, &mut read).is_err());
        overlay.set_len(5).unwrap();
        overlay.set_len(10_000).unwrap();
        overlay.read(0, &mut read).unwrap();
        assert_eq!(read, [1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        overlay.read(9_000, &mut read).unwrap();
        assert_eq!(read, [0; 16]);
    }
}
