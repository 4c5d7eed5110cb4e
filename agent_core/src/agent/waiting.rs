//! The waiting goal list (Algorithm 4), and emergencies whose turn has not come.

use super::goal::Goal;
use super::intention::Intention;
use crate::protocol::{GoalId, Urgency};

/// Goals that are neither running nor suspended nor set aside.
///
/// A goal that was set aside and may go on comes back to here with its plans.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WaitingGoals {
    goals: Vec<Intention>,
}

impl WaitingGoals {
    /// Algorithm 4, step 2. Where it stands is decided by rank, not by when it was added.
    pub fn add(&mut self, intention: Intention) {
        self.goals.push(intention);
    }

    /// The goal that goes first among those that do not wait for an empty stack.
    pub fn most_urgent(&self) -> Option<&Goal> {
        let urgent = self.goals.iter().map(|intention| &intention.goal);
        urgent
            .filter(|goal| does_not_wait(goal))
            .max_by_key(|goal| goal.rank())
    }

    /// The normal goal that is next (Algorithm 4, step 3).
    pub fn next_normal(&self) -> Option<&Goal> {
        let normal = self.goals.iter().map(|intention| &intention.goal);
        normal
            .filter(|goal| !does_not_wait(goal))
            .max_by_key(|goal| goal.rank())
    }

    /// Algorithm 4, step 4.
    pub fn remove(&mut self, goal: &GoalId) -> Option<Intention> {
        let place = self
            .goals
            .iter()
            .position(|waiting| waiting.goal.id == *goal)?;
        Some(self.goals.remove(place))
    }

    /// All of them, in the order in which they came.
    pub fn intentions(&self) -> &[Intention] {
        &self.goals
    }

    pub(super) fn intentions_mut(&mut self) -> impl Iterator<Item = &mut Intention> {
        self.goals.iter_mut()
    }
}

fn does_not_wait(goal: &Goal) -> bool {
    goal.urgency == Urgency::Emergency
}
