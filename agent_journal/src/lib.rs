//! What a role has written down: one file, in which every commit is there as a whole or not at all.
//!
//! The file is a redb database with two tables: `about` says what it is, `rows` is what the
//! [`Station`](agent_core::protocol::Station) gives. Commits are of two phases: redb's one-phase
//! commits trust a checksum to tell whether the last one is whole.
//!
//! A journal that is not ours, not whole or not understood is never written to: it is looked at
//! through an overlay that keeps all changes in memory.
//!
//! After an error nothing is known of what the system has kept of a file, not even when a later call
//! succeeds (a failed `fsync` is reported once). So the next attempt writes everything into a new
//! file, which takes the old one's place.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod disk;
mod error;
mod examine;
mod overlay;
#[cfg(test)]
mod tests;

use std::path::Path;

use agent_core::protocol::{Row, Rows};
use redb::{Database, Durability, TableDefinition, WriteTransaction};

pub use disk::{Disk, FileDisk, Medium};
pub use error::{CommitError, JournalError};
pub use redb::StorageBackend;

use disk::{AnyMedium, in_words};
use examine::{FORMAT_KEY, WHAT_KEY, builder, examine};

/// What is understood here. A release that writes otherwise counts one up.
const FORMAT: u32 = 2;

const ABOUT: TableDefinition<'_, &str, &str> = TableDefinition::new("about");
const ROWS: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("rows");

/// All that is ever read is a few hundred kilobytes.
const CACHE_BYTES: usize = 4 * 1024 * 1024;

/// A file that is longer than this and has grown to more than [`SPARSE`] times its content is
/// written anew when it is opened. An empty one has a megabyte and a half, most of it holes.
const WORTH_REWRITING_BYTES: u64 = 4 * 1024 * 1024;
const SPARSE: u64 = 8;

/// Whose memory a journal is.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Identity {
    /// The robot.
    pub robot: String,
    /// Its part: the name by which others address it.
    pub role: String,
    /// Which map and domains it lives with: a fingerprint of them. What is remembered is in their
    /// words.
    pub place: String,
}

/// A journal says this about itself.
fn about(whose: &Identity) -> [(&'static str, String); 5] {
    [
        (WHAT_KEY, "intermezzo journal".to_owned()),
        (FORMAT_KEY, FORMAT.to_string()),
        ("robot", whose.robot.clone()),
        ("role", whose.role.clone()),
        ("place", whose.place.clone()),
    ]
}

/// An open journal.
#[derive(Debug)]
pub struct Journal {
    disk: Box<dyn Disk>,
    whose: Identity,
    /// Everything that should be in it.
    rows: Rows,
    database: Kept,
}

/// How a journal is written to.
#[derive(Debug)]
enum Kept {
    /// It was only looked at yet: whoever cannot make sense of its rows leaves it as it is.
    Closed,
    Open(Database),
    /// All of it goes into a new file: after an error, or since the old one has grown.
    ToBeWrittenAnew,
}

impl Journal {
    /// The journal in the file `path`, which is made if there is none, and what is in it. One that
    /// is there is not written to before the first [`commit`](Self::commit).
    ///
    /// # Errors
    /// If it is not ours, not whole or not understood; it is untouched then.
    pub fn open(path: &Path, whose: Identity) -> Result<(Self, Rows), JournalError> {
        Self::on(FileDisk::lock(path)?, whose)
    }

    /// As [`open`](Self::open), wherever it is kept.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn on(disk: impl Disk + 'static, whose: Identity) -> Result<(Self, Rows), JournalError> {
        let place = disk.name();
        let failed = |why| JournalError::Io {
            place: place.clone(),
            why,
        };
        let mut journal = Self {
            disk: Box::new(disk),
            whose,
            rows: Rows::new(),
            database: Kept::ToBeWrittenAnew,
        };
        let there = journal.disk.look().map_err(failed)?;
        let len = there.as_ref().map_or(Ok(0), |medium| medium.len());
        let len = len.map_err(failed)?;
        if let Some(medium) = there {
            journal.rows = examine(&place, medium, &journal.whose)?;
            // Whether it can be written, too.
            drop(journal.disk.open().map_err(failed)?);
            if len <= WORTH_REWRITING_BYTES.max(journal.content_bytes() * SPARSE) {
                journal.database = Kept::Closed;
            }
        } else {
            journal
                .write_anew()
                .map_err(|error| failed(std::io::Error::other(in_words(error))))?;
        }
        let rows = journal.rows.clone();
        Ok((journal, rows))
    }

    /// Writes rows down: all of them are on the disk when this returns.
    ///
    /// # Errors
    /// If that is not certain. They are kept and written with the next commit, which may be empty.
    pub fn commit(&mut self, rows: &[Row]) -> Result<(), CommitError> {
        for Row { key, value } in rows {
            match value {
                Some(value) => self.rows.insert(key.clone(), value.clone()),
                None => self.rows.remove(key),
            };
        }
        self.write(rows).map_err(|error| {
            self.database = Kept::ToBeWrittenAnew;
            CommitError {
                place: self.disk.name(),
                why: in_words(error),
            }
        })
    }

    /// What messages call it.
    pub fn name(&self) -> String {
        self.disk.name()
    }

    /// How many rows there are.
    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// How long keys and values are together.
    pub fn content_bytes(&self) -> u64 {
        let rows = self.rows.iter();
        rows.map(|(key, value)| (key.len() + value.len()) as u64)
            .sum()
    }

    fn write(&mut self, rows: &[Row]) -> Result<(), redb::Error> {
        if let Kept::Closed = self.database {
            let medium = AnyMedium(self.disk.open()?);
            self.database = Kept::Open(builder().create_with_backend(medium)?);
        }
        match &self.database {
            Kept::Open(database) => write(database, rows),
            Kept::Closed | Kept::ToBeWrittenAnew => self.write_anew(),
        }
    }

    /// Writes everything into a new file, which takes the place of the old one.
    fn write_anew(&mut self) -> Result<(), redb::Error> {
        match self.successor() {
            Ok(database) => {
                self.database = Kept::Open(database);
                Ok(())
            }
            Err(error) => {
                self.disk.give_up();
                Err(error)
            }
        }
    }

    fn successor(&self) -> Result<Database, redb::Error> {
        let medium = AnyMedium(self.disk.begin_anew()?);
        let database = builder().create_with_backend(medium)?;
        let transaction = begin(&database)?;
        {
            let mut table = transaction.open_table(ABOUT)?;
            for (key, value) in about(&self.whose) {
                table.insert(key, value.as_str())?;
            }
            let mut table = transaction.open_table(ROWS)?;
            for (key, value) in &self.rows {
                table.insert(key.as_str(), value.as_slice())?;
            }
        }
        transaction.commit()?;
        self.disk.put_in_place()?;
        Ok(database)
    }
}

fn write(database: &Database, rows: &[Row]) -> Result<(), redb::Error> {
    let transaction = begin(database)?;
    {
        let mut table = transaction.open_table(ROWS)?;
        for Row { key, value } in rows {
            match value {
                Some(value) => table.insert(key.as_str(), value.as_slice())?,
                None => table.remove(key.as_str())?,
            };
        }
    }
    Ok(transaction.commit()?)
}

fn begin(database: &Database) -> Result<WriteTransaction, redb::Error> {
    let mut transaction = database.begin_write()?;
    transaction.set_durability(Durability::Immediate)?;
    transaction.set_two_phase_commit(true);
    Ok(transaction)
}
