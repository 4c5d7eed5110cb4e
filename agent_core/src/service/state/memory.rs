//! What the state service writes down.

use super::{Known, StateService, sum};
use crate::model::Fact;
use crate::protocol::{Ledger, Row, Rows, Unreadable, read_rows};

const KNOWN: &str = "m/state/known/";

impl StateService {
    /// The rows that are different from what the last call gave. Keys begin with `m/state/`.
    pub fn write_down(&mut self) -> Vec<Row> {
        for fact in std::mem::take(&mut self.touched) {
            if let Some(known) = self.table.get(&fact) {
                self.ledger.put(format!("{KNOWN}{fact}"), &(&fact, known));
            }
        }
        self.ledger.take()
    }

    /// Makes a service that has just been made know what it knew when it wrote the rows down. What it
    /// needs and watches follows from what the vehicle does.
    ///
    /// # Errors
    /// If a row cannot be read.
    pub fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        for row in read_rows::<(Fact, Known)>(rows, KNOWN) {
            let (_, (fact, known)) = row?;
            self.digest = self.digest.wrapping_add(sum(&fact, &known));
            self.table.insert(fact, known);
        }
        self.ledger = Ledger::of(rows, KNOWN);
        Ok(())
    }
}
