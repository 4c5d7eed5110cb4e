//! What a part writes down, and how it comes back from that.

use agent_core::protocol::{Ledger, Row, Rows, Unreadable, read_row};

use super::{Active, Begun, Part};
use crate::memory::Memory;

const RUNNING: &str = "m/running";
const WAITING: &str = "m/waiting";
const FAULTS: &str = "m/faults";

impl Part {
    pub(crate) fn write_down(&mut self) -> Vec<Row> {
        let ledger = &mut self.ledger;
        ledger.put(FAULTS.to_owned(), &self.faults.position());
        match &self.active {
            Some(active) => ledger.put(RUNNING.to_owned(), &active.begun),
            None => ledger.remove(RUNNING),
        }
        match &self.waiting {
            Some(waiting) => ledger.put(WAITING.to_owned(), waiting),
            None => ledger.remove(WAITING),
        }
        self.memory.write_down(ledger);
        ledger.take()
    }

    /// To be [settled](Self::settle) next.
    pub(crate) fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.faults
            .go_on_from(read_row(rows, FAULTS)?.unwrap_or_default());
        self.memory = Memory::recall(rows)?;
        let running: Option<Begun> = read_row(rows, RUNNING)?;
        self.active = running.map(|begun| Active {
            begun,
            fault: None,
            errand_at: None,
        });
        self.waiting = read_row(rows, WAITING)?;
        self.ledger = Ledger::of(rows, "m/");
        Ok(())
    }
}
