//! Goals that are over: late questions are still answered, for a while.

use super::{Agent, Intention};
use crate::model::{Symbol, Task, Time};
use crate::planner::Planner;
use crate::protocol::{ActionId, GoalId, Report};

/// A goal that is over.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// Its name.
    pub id: GoalId,
    /// What was to be done.
    pub tasks: Vec<Task>,
    /// Whose instruction it was; `None` if a user's goal.
    pub superior: Option<(Symbol, ActionId)>,
    /// [`Report::Success`], [`Report::Failure`] or [`Report::Unknown`].
    pub outcome: Report,
    /// When it ended.
    pub at: Time,
}

impl<P: Planner> Agent<P> {
    /// The goals that are over, the latest last, as far as they are remembered.
    pub fn ended(&self) -> impl DoubleEndedIterator<Item = &Ended> {
        self.ended.iter()
    }

    /// A goal that is over, by its name; `None` if it is not, was forgotten or never was.
    pub fn ended_goal(&self, id: &GoalId) -> Option<&Ended> {
        self.ended.iter().rev().find(|ended| ended.id == *id)
    }

    /// What superiors and users hear of a goal that has ended.
    pub(super) fn remember(&mut self, intention: &Intention, outcome: Report) {
        self.planner.release(&intention.goal.id);
        self.ended.push_back(Ended {
            id: intention.goal.id.clone(),
            tasks: intention.goal.tasks.clone(),
            superior: intention.goal.superior.clone(),
            outcome,
            at: self.now,
        });
        self.next_ended += 1;
        self.forget_ended();
    }

    /// Forgets what is too much, or too old.
    pub(super) fn forget_ended(&mut self) {
        let policy = &self.configuration.policy;
        let old = |ended: &Ended| self.now.since(ended.at) > policy.ended_kept_for;
        while self.ended.len() > policy.ended_kept || self.ended.front().is_some_and(old) {
            self.ended.pop_front();
        }
    }
}
