//! What goes down, what is answered, and what comes up.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::model::{Action, Fact, FactChange, Map, Symbol, Time};

/// Which execution of an action is meant: its superior's name, the epoch of that superior's start,
/// and a running number. Never used twice, so a late message can be told from a new one.
#[derive(Clone, Debug, Eq, PartialEq, Ord, PartialOrd, Hash, Serialize, Deserialize)]
pub struct ActionId {
    /// Who gave the instruction.
    pub agent: Symbol,
    /// New at every start of that agent.
    pub epoch: u64,
    /// Counts within the epoch.
    pub number: u64,
}

impl fmt::Display for ActionId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}.{}", self.agent, self.epoch, self.number)
    }
}

/// What a superior tells its executor, be that a child agent or a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Instruction {
    /// Begin; at once, never queued (decision 1).
    Execute {
        /// A new name for this execution.
        id: ActionId,
        /// What to do. To a child agent it is a task.
        action: Action,
        /// The map of the place it is to be done in, for a child agent (the paper, section 7).
        map: Option<Map>,
    },
    /// Stop if you can: both questions of Algorithm 3(b) in one.
    Suspend {
        /// The execution to stop.
        id: ActionId,
    },
    /// Take up the record kept for `id` (Algorithm 5, step 9).
    Resume {
        /// The execution that was suspended.
        id: ActionId,
        /// The map, again: the child may have worked elsewhere meanwhile.
        map: Option<Map>,
    },
    /// Drop the record kept for `id` (Algorithm 2, step 5; Algorithm 5, step 8). Idempotent.
    Clear {
        /// The execution that will not be resumed.
        id: ActionId,
    },
}

impl Instruction {
    /// The execution that this is about.
    pub fn id(&self) -> &ActionId {
        match self {
            Self::Execute { id, .. }
            | Self::Suspend { id }
            | Self::Resume { id, .. }
            | Self::Clear { id } => id,
        }
    }
}

/// What an executor answers at once. Only [`Report`]s say how it went on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// `Execute`, `Resume`: begun. `Clear`: dropped, or there was nothing to drop.
    Accepted,
    /// `Suspend`: stopping; a [`Report::Suspended`] follows, or the end if that came first.
    Suspending,
    /// `Suspend`: it cannot be suspended and ends by itself.
    Refused {
        /// How long that will take.
        finishes_in: Time,
    },
    /// `Suspend`, `Resume`, `Clear`: it has ended already, and so. Without the outcome in here, an
    /// answer that overtakes a report of success has the goal done twice.
    Finished {
        /// [`Report::Success`], [`Report::Failure`] or [`Report::Unknown`].
        outcome: Report,
    },
    /// Not understood or not possible; nothing has changed.
    Rejected {
        /// In words for a person.
        reason: String,
    },
}

/// What comes up about an execution. Reports of one execution arrive in order and once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Report {
    /// It has begun, or has begun again after a suspension.
    Started,
    /// How far it is, from 0 to 1.
    Progress {
        /// Done so far.
        fraction: f64,
    },
    /// It has ended as it should.
    Success {
        /// What is true now, at the receiver's level.
        facts: Vec<FactChange>,
    },
    /// It has ended otherwise.
    Failure {
        /// In words for a person.
        reason: String,
        /// What is true now, at the receiver's level.
        facts: Vec<FactChange>,
        /// Facts that would have to hold for it to succeed, so that the receiver can plan round
        /// them (decision 7).
        blocked_by: Vec<Fact>,
    },
    /// It has ended, and nobody can tell how: its process died in between, and what it does must
    /// not be done twice (decision 11).
    Unknown {
        /// In words for a person.
        reason: String,
        /// What is true now, at the receiver's level.
        facts: Vec<FactChange>,
    },
    /// The executor stands still and keeps a record to resume from. Also without having been
    /// asked: after a restart, or when it has lost its superior.
    Suspended {
        /// What is true now, at the receiver's level.
        facts: Vec<FactChange>,
    },
}

/// A report with what it is about, as it travels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReportBody {
    /// Which execution.
    pub id: ActionId,
    /// How it goes.
    pub report: Report,
}

impl Report {
    /// Whether nothing more can come about this execution.
    pub fn is_end(&self) -> bool {
        matches!(
            self,
            Self::Success { .. } | Self::Failure { .. } | Self::Unknown { .. }
        )
    }
}
