//! What the robot remembers of actions that do not run.

use std::collections::VecDeque;

use agent_core::model::{Action, Fact, Symbol};
use agent_core::protocol::ActionId;
use serde::{Deserialize, Serialize};

use super::Skill;

/// How many actions that are over are remembered. A superior asks again after seconds, not after
/// a thousand actions.
const REMEMBERED: usize = 1000;

/// What is needed to resume an action (the paper, section 4: the action executor's record).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    pub(super) id: ActionId,
    /// To whom the reports go.
    pub(super) superior: Symbol,
    pub(super) action: Action,
    /// What is left to be done: of a speech the rest; of a drive the same drive, since that can
    /// begin anywhere on its arc.
    pub(super) rest: Skill,
}

/// How an action is over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum End {
    Success,
    Failure {
        reason: String,
        blocked_by: Vec<Fact>,
    },
    /// The superior has dropped it.
    Cleared,
}

/// What a robot must not forget when its controller's process dies: the records of suspended
/// actions, how others have ended, and which one was running.
///
/// Whoever keeps it durable writes it down before the message is acknowledged that changed it, and
/// hands it to [`Controller::remembering`](super::Controller::remembering).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Set only in copies that are handed out: while the controller lives, it knows itself.
    pub(super) running: Option<Record>,
    /// In the order of suspension.
    records: Vec<Record>,
    /// Oldest first.
    over: VecDeque<(ActionId, Skill, End)>,
}

impl Memory {
    /// How many suspended actions can be resumed.
    pub(super) fn depth(&self) -> usize {
        self.records.len()
    }

    /// Suspended actions, the latest last.
    pub(super) fn records(&self) -> impl Iterator<Item = &Record> {
        self.records.iter()
    }

    pub(super) fn keep(&mut self, record: Record) {
        self.records.push(record);
    }

    pub(super) fn record(&self, id: &ActionId) -> Option<&Record> {
        self.records.iter().find(|record| record.id == *id)
    }

    pub(super) fn take(&mut self, id: &ActionId) -> Option<Record> {
        let at = self.records.iter().position(|record| record.id == *id)?;
        Some(self.records.remove(at))
    }

    pub(super) fn end(&mut self, id: ActionId, skill: Skill, end: End) {
        if self.over.len() == REMEMBERED {
            self.over.pop_front();
        }
        self.over.push_back((id, skill, end));
    }

    /// How the action is over; `None` if it is not, or if that was long ago.
    pub(super) fn over(&self, id: &ActionId) -> Option<(&Skill, &End)> {
        // From the back: who asks, asks about what has just ended.
        let (_, skill, end) = self.over.iter().rev().find(|(over, ..)| over == id)?;
        Some((skill, end))
    }
}
