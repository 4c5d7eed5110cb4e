//! What a controller writes down, and how it comes back from that.

use agent_core::model::Symbol;
use agent_core::protocol::{ActionId, Durable, Ledger, Row, Rows, Unreadable, read_row};

use super::active::{Active, Begun, Cut};
use super::{Controller, MotorCommand};
use crate::memory::Memory;

const LAST_TICKET: &str = "m/ticket";
const RUNNING: &str = "m/running";
const WAITING: &str = "m/waiting";
const FAULTS: &str = "m/faults";

impl Durable for Controller {
    fn write_down(&mut self) -> Vec<Row> {
        let ledger = &mut self.ledger;
        ledger.put(LAST_TICKET.to_owned(), &self.last_ticket);
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
        self.surroundings.write_down(ledger);
        ledger.take()
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.last_ticket = read_row(rows, LAST_TICKET)?.unwrap_or_default();
        self.faults
            .go_on_from(read_row(rows, FAULTS)?.unwrap_or_default());
        self.memory = Memory::recall(rows)?;
        self.surroundings.recall(rows)?;
        let running: Option<Begun> = read_row(rows, RUNNING)?;
        self.active = running.map(|mut begun| {
            // That the world had started anew is still so.
            begun.cut = begun.cut.or(Some(Cut::Controller));
            let at = begun.at;
            Active::found(begun, at)
        });
        self.waiting = read_row(rows, WAITING)?;
        self.ledger = Ledger::of(rows, "m/");
        // What was said when it was made had another number.
        self.outputs.clear();
        self.what_waits_was_recalled();
        self.halt();
        Ok(())
    }

    fn is_suspended(&self, _: &Symbol, id: &ActionId) -> bool {
        self.memory.record(id).is_some()
    }

    fn is_stop(command: &MotorCommand) -> bool {
        command.is_stop()
    }
}
