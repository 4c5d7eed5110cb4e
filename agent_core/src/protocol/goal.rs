//! What users ask of an agent.

use serde::{Deserialize, Serialize};

use crate::model::{Symbol, Task, Time};

/// The name of a goal: the user's, or one that the agent made.
pub type GoalId = Symbol;

/// Whether a goal waits for its turn.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Ord, PartialOrd, Serialize, Deserialize)]
pub enum Urgency {
    /// Waits until nothing else is going on (Algorithm 4).
    Normal,
    /// Interrupts (Algorithm 3).
    Emergency,
}

/// A goal as it is asked for.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct GoalRequest {
    /// If the user has named it. A second request of the same name and tasks is the same goal and
    /// is acknowledged again.
    pub id: Option<GoalId>,
    /// What is to be done, in this order.
    pub tasks: Vec<Task>,
    /// Normal or emergency.
    pub urgency: Urgency,
    /// Higher goes first among goals of the same urgency; 0 unless given.
    pub priority: i32,
    /// After this long, counted from acceptance, the goal has failed.
    pub deadline: Option<Time>,
}

/// What a user may ask about a goal that was accepted.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Set it aside until the user resumes it.
    Suspend(GoalId),
    /// Let it go on.
    Resume(GoalId),
    /// End it; what was half done is rolled back where the domain says how.
    Cancel(GoalId),
}

/// Why a goal or a command was refused, in words for whoever sent it.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error, Serialize, Deserialize)]
pub enum Rejection {
    /// A goal without a task.
    #[error("the goal has no task")]
    NoTask,
    /// Not in the domain.
    #[error("unknown task `{0}`; this agent knows {1}")]
    UnknownTask(Symbol, String),
    /// Wrong number of arguments.
    #[error("`{task}` takes {wanted} argument(s), not {given}")]
    ArgumentCount {
        /// As written.
        task: Task,
        /// As declared.
        wanted: usize,
        /// As given.
        given: usize,
    },
    /// Not an object of this map and domain.
    #[error("unknown object `{object}` in `{task}`")]
    UnknownObject {
        /// As written.
        task: Task,
        /// Not known.
        object: Symbol,
    },
    /// An object of another type.
    #[error("`{object}` in `{task}` is of type {given}, but {wanted} is wanted")]
    WrongType {
        /// As written.
        task: Task,
        /// The object.
        object: Symbol,
        /// Its type.
        given: Symbol,
        /// The declared type.
        wanted: Symbol,
    },
    /// Another goal of this name has other tasks.
    #[error("there is another goal named `{0}` already")]
    NameTaken(GoalId),
    /// More goals wait than this agent keeps.
    #[error(
        "{waiting} {kind} wait already, and no more than {most} may: cancel one, or ask again later"
    )]
    TooManyWaiting {
        /// `emergencies` or `goals`.
        kind: Symbol,
        /// How many do.
        waiting: usize,
        /// How many may.
        most: usize,
    },
    /// A command about a goal that is not there.
    #[error("there is no goal named `{0}`")]
    UnknownGoal(GoalId),
    /// A command that does not fit.
    #[error("goal `{goal}` {why}")]
    NotNow {
        /// The goal.
        goal: GoalId,
        /// What is in the way.
        why: String,
    },
}
