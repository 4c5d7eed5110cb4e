//! What a vehicle writes down: what its agent and its services do, and the goals that it has published
//! for users.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::{EndedTask, Mind, Vehicle};
use crate::model::{Symbol, Task, Time};
use crate::planner::{Planner, arising};
use crate::protocol::{ActionId, Durable, Ledger, Row, Rows, Unreadable, read_row};
use crate::service::{Message, Outcome};

const FOR_USERS: &str = "m/vehicle/for-users";
const ENDED: &str = "m/vehicle/ended";
const PREFIX: &str = "m/vehicle/";

/// As it is written down.
#[derive(Serialize, Deserialize)]
struct EndedRow(Symbol, Task, Time, Option<Symbol>, Option<String>, bool);

impl<A: Mind, P: Planner> Durable for Vehicle<A, P> {
    fn write_down(&mut self) -> Vec<Row> {
        let mut rows = self.mind.write_down();
        rows.append(&mut self.tasks.write_down());
        rows.append(&mut self.states.write_down());
        self.ledger.put(FOR_USERS.to_owned(), &self.for_users);
        let ended: Vec<EndedRow> = self.ended.iter().map(ended_row).collect();
        self.ledger.put(ENDED.to_owned(), &ended);
        rows.append(&mut self.ledger.take());
        rows
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        let services = [PREFIX, "m/task/", "m/state/"];
        let of_mind = rows.iter().filter(|(key, _)| {
            let mut services = services.iter();
            !services.any(|prefix| key.starts_with(prefix))
        });
        let of_mind: Rows = of_mind
            .map(|(key, value)| (key.clone(), value.clone()))
            .collect();
        self.mind.recall(&of_mind)?;
        self.tasks.recall(rows)?;
        self.states.recall(rows)?;
        self.for_users = read_row::<BTreeSet<Symbol>>(rows, FOR_USERS)?.unwrap_or_default();
        let ended: Vec<EndedRow> = read_row(rows, ENDED)?.unwrap_or_default();
        self.ended = ended.into_iter().map(ended_task).collect();
        self.ledger = Ledger::of(rows, PREFIX);
        // What is to be done by what is believed now has been seen to.
        self.arisen = arising(&self.problem());
        Ok(())
    }

    fn is_suspended(&self, superior: &Symbol, id: &ActionId) -> bool {
        self.mind.is_suspended(superior, id)
    }

    /// Of a task, who has or had it; of an action, whoever executes.
    fn believes(&self, by: &Symbol, id: &ActionId) -> bool {
        match self.tasks.is_own(id) {
            true => self.tasks.executor_of(id) == Some(by),
            false => self.executors.contains(by),
        }
    }

    fn is_stop(_: &Message) -> bool {
        false
    }
}

fn ended_row(ended: &EndedTask) -> EndedRow {
    let (by, reason, unknown) = match &ended.outcome {
        Outcome::Done { by } => (by.clone(), None, false),
        Outcome::Failed { reason } => (None, Some(reason.clone()), false),
        Outcome::Unknown { reason } => (None, Some(reason.clone()), true),
    };
    EndedRow(
        ended.id.clone(),
        ended.what.clone(),
        ended.at,
        by,
        reason,
        unknown,
    )
}

fn ended_task(EndedRow(id, what, at, by, reason, unknown): EndedRow) -> EndedTask {
    let outcome = match reason {
        None => Outcome::Done { by },
        Some(reason) if unknown => Outcome::Unknown { reason },
        Some(reason) => Outcome::Failed { reason },
    };
    EndedTask {
        id,
        what,
        outcome,
        at,
    }
}
