//! Journals: what is left of a process.

use agent_core::protocol::{Row, Rows};

/// A journal of rows. A writing is there as a whole or not at all.
#[derive(Clone, Debug, Default)]
pub struct Store {
    rows: Rows,
}

impl Store {
    /// Everything that was written.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Writes.
    pub fn write(&mut self, rows: &[Row]) {
        for Row { key, value } in rows {
            match value {
                Some(value) => self.rows.insert(key.clone(), value.clone()),
                None => self.rows.remove(key),
            };
        }
    }

    /// It is gone.
    pub fn lose(&mut self) {
        self.rows.clear();
    }
}
