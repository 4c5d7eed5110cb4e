//! Plans, and the agendas that they are made from.

use std::sync::Arc;

use super::network::{Frame, Item, TaskList};
use crate::model::{Action, Cost};
use crate::protocol::ActionId;

/// One action of a plan.
#[derive(Clone, Debug)]
pub struct Step {
    /// What to do.
    pub item: Item,
    /// What it costs.
    pub cost: Cost,
    /// The task that it is a part of.
    pub frame: Option<Arc<Frame>>,
    /// What is to be done after it, as tasks.
    pub rest: TaskList,
}

impl Step {
    /// The action.
    pub fn action(&self) -> &Action {
        self.item.atom()
    }

    /// [`Item::purpose`].
    pub fn purpose(&self) -> &Action {
        self.item.purpose()
    }
}

impl PartialEq for Step {
    fn eq(&self, other: &Self) -> bool {
        self.item == other.item && self.cost == other.cost
    }
}

/// An action first, then actions and tasks (the paper, section 3).
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// In order. Empty if there is nothing left to do.
    pub steps: Vec<Step>,
    /// What follows the last step, not decomposed yet; empty when planned in full.
    pub rest: TaskList,
    /// Of the steps, and the estimate of the rest.
    pub cost: Cost,
}

impl Plan {
    /// The actions in order.
    pub fn actions(&self) -> Vec<Action> {
        self.steps
            .iter()
            .map(|step| step.action().clone())
            .collect()
    }

    /// Whether it resumes or undoes this execution.
    pub fn needs(&self, record: &ActionId) -> bool {
        self.steps.iter().any(|step| step.item.needs(record))
            || self.rest.items().any(|item| item.needs(record))
    }

    /// What each step brings the robot forward by.
    pub fn purposes(&self) -> impl DoubleEndedIterator<Item = &Action> {
        self.steps.iter().map(Step::purpose)
    }
}

/// Why a list of tasks is worth planning for.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Origin {
    /// The goal as it was given.
    Goal,
    /// What follows the action that was executed last.
    Tail,
    /// The action that was running, again.
    Again,
    /// An open ancestor task from its beginning (decision 13).
    Ancestor,
    /// The suspended action resumed (Algorithm 1, step 3a).
    Resume,
    /// The same, after reaching the place where that can be done (decision 13).
    Reach,
    /// The suspended action undone first (Algorithm 1, step 3b).
    RollBack,
}

/// One way to what remains of a goal; cost decides between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Agenda {
    /// What is to be done.
    pub tasks: TaskList,
    /// Why.
    pub origin: Origin,
}
