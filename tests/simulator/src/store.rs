//! Journals: what is left of a process.

use agent_core::protocol::{Row, Rows};
use agent_journal::{Identity, Journal};

use crate::dice::Dice;
use crate::disk::MemoryDisk;

/// A journal of rows. A writing is there as a whole or not at all.
#[derive(Debug, Default)]
pub struct Store {
    rows: Rows,
    /// The product's own journal beside it; then `rows` is what must be in that.
    real: Option<Real>,
}

#[derive(Debug, Default)]
struct Real {
    disk: MemoryDisk,
    journal: Option<Journal>,
    /// What is found otherwise, if a crash came while that was being written.
    or_else: Option<Rows>,
}

fn whose(role: &str) -> Identity {
    Identity {
        robot: "ring".to_owned(),
        role: role.to_owned(),
        place: "ring".to_owned(),
    }
}

impl Store {
    /// One in the product's own journal, on a disk that forgets.
    pub fn real() -> Self {
        Self {
            rows: Rows::new(),
            real: Some(Real::default()),
        }
    }

    /// Everything that was written.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// A process begins with it.
    ///
    /// # Errors
    /// If the journal cannot be read, or has not in it what was written.
    pub fn open(&mut self, role: &str) -> Result<&Rows, String> {
        let Some(real) = &mut self.real else {
            return Ok(&self.rows);
        };
        let opened = Journal::on(real.disk.clone(), whose(role));
        let (journal, found) = opened.map_err(|error| error.to_string())?;
        real.journal = Some(journal);
        let or_else = real.or_else.take();
        if found != self.rows {
            if or_else.as_ref() != Some(&found) {
                return Err(differences(&self.rows, &found));
            }
            self.rows = found;
        }
        Ok(&self.rows)
    }

    /// Writes.
    ///
    /// # Errors
    /// If the journal says that it cannot.
    pub fn write(&mut self, rows: Vec<Row>) -> Result<(), String> {
        let journal = self.real.as_mut().and_then(|real| real.journal.as_mut());
        let written = match journal {
            Some(journal) => journal.commit(&rows).map_err(|error| error.to_string()),
            None => Ok(()),
        };
        apply(&mut self.rows, rows);
        written
    }

    /// Tries to write to a disk that is full.
    ///
    /// # Errors
    /// If the journal says that it can.
    pub fn write_in_vain(&mut self, rows: &[Row]) -> Result<(), String> {
        let Some(real) = &mut self.real else {
            return Ok(());
        };
        let Some(journal) = &mut real.journal else {
            return Ok(());
        };
        real.disk.set_full(true);
        let written = journal.commit(rows);
        real.disk.set_full(false);
        match written {
            Ok(()) if !rows.is_empty() => Err("it has written to a full disk".to_owned()),
            _ => Ok(()),
        }
    }

    /// The process dies, perhaps while it writes rows that are not known to be there afterwards.
    pub fn crash(&mut self, interrupted: Option<&[Row]>, dice: &mut Dice) {
        let Some(real) = &mut self.real else {
            return;
        };
        if let (Some(rows), Some(journal)) = (interrupted, &mut real.journal) {
            real.disk.dies_after(dice.roll(MOST_CALLS));
            let mut after = self.rows.clone();
            apply(&mut after, rows.iter().cloned());
            match journal.commit(rows) {
                Ok(()) => self.rows = after,
                Err(_) => real.or_else = Some(after),
            }
        }
        real.disk.crash(dice);
        real.journal = None;
    }

    /// It is gone.
    pub fn lose(&mut self) {
        self.rows.clear();
        if let Some(real) = &mut self.real {
            *real = Real::default();
        }
    }
}

/// A writing rarely takes more changes of a file than this.
const MOST_CALLS: u64 = 16;

/// Makes rows what they are after a writing.
pub fn apply(to: &mut Rows, rows: impl IntoIterator<Item = Row>) {
    for Row { key, value } in rows {
        match value {
            Some(value) => to.insert(key, value),
            None => to.remove(&key),
        };
    }
}

fn differences(wanted: &Rows, found: &Rows) -> String {
    let keys = wanted.keys().chain(found.keys());
    let other: Vec<&String> = keys
        .filter(|key| wanted.get(*key) != found.get(*key))
        .take(5)
        .collect();
    format!("of what was written these rows are not there, or others: {other:?}")
}
