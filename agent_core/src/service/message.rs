//! What vehicles say to all others of their team.

use serde::{Deserialize, Serialize};

use crate::model::{Fact, Symbol, Task, Time};
use crate::protocol::{ActionId, GoalRequest, Urgency};

/// The name of a task, which its publisher has given it.
pub type TaskId = Symbol;

/// What a vehicle says to all others.
///
/// It may arrive late, twice, out of order or not at all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Message {
    /// Who says it.
    pub by: Symbol,
    /// When it was said, on the world's clock.
    pub at: Time,
    /// What.
    pub body: Body,
}

/// What is said.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Body {
    /// How the tasks of the sender stand, all of them. Said at regular intervals, so it also says that
    /// the sender lives.
    Tasks(Tasks),
    /// To the publisher of a task: what it would cost the sender.
    Bid(Bid),
    /// Facts.
    Told(Vec<Told>),
    /// The sender wants to know whether these hold.
    Need(Vec<Fact>),
    /// A user's goal for whoever can do it best. No vehicle says this to others: it is how a goal that
    /// is for nobody in particular comes to the one that publishes it.
    Goal(GoalRequest),
}

/// How the tasks stand that somebody has published.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tasks {
    /// Those that nobody has yet.
    pub offers: Vec<Offer>,
    /// Those that somebody has. Who is not named any more may go on until its lease has run out.
    pub awards: Vec<Award>,
    /// A sum over the facts that the sender knows: whose is another knows other facts.
    pub digest: u64,
}

/// A task that nobody has yet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offer {
    /// Which.
    pub task: TaskId,
    /// The name of the execution, if it is given to somebody now. Each time that it is offered anew it
    /// has another one.
    pub id: ActionId,
    /// What is to be done.
    pub what: Task,
    /// Normal or emergency.
    pub urgency: Urgency,
    /// As of a goal.
    pub priority: i32,
    /// When it has failed, on the world's clock.
    pub deadline: Option<Time>,
}

/// A task that somebody has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Award {
    /// Which.
    pub task: TaskId,
    /// The execution.
    pub id: ActionId,
    /// What is to be done.
    pub what: Task,
    /// Who has it.
    pub to: Symbol,
}

/// What a task would cost somebody.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bid {
    /// The execution that was offered.
    pub id: ActionId,
    /// How long until it would be done; `None` if the sender cannot do it.
    pub cost: Option<Time>,
    /// What the sender would have to know to tell whether it can.
    pub lacks: Vec<Fact>,
}

/// A fact with its source and its age.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Told {
    /// Which.
    pub fact: Fact,
    /// Whether it holds.
    pub holds: bool,
    /// Who has seen it.
    pub source: Symbol,
    /// When, on the world's clock.
    pub at: Time,
}
