//! Algorithm 4: the waiting goal list, emergencies whose turn has not come, and which goal is next.

use super::{Agent, Goal, Intention, Phase, Running};
use crate::planner::Planner;
use crate::protocol::{GoalId, Happening, Urgency};

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

impl<P: Planner> Agent<P> {
    /// Starts or resumes the goal that goes first, if nothing runs. Returns whether it did.
    pub(super) fn start_next(&mut self) -> bool {
        if self.running.is_some() || self.paused.is_some() || self.holds() {
            return false;
        }
        let resumable = self.stack.resumable().map(|intention| &intention.goal);
        let urgent = self.waiting.most_urgent();
        let urgent = urgent.filter(|urgent| resumable.is_none_or(|top| urgent.outranks(top)));
        let normal = self.waiting.next_normal();
        let next = if let Some(urgent) = urgent {
            // Algorithm 3, step 2 or 3e; Algorithm 5.
            self.waiting.remove(&urgent.id.clone())
        } else if resumable.is_some() {
            // Algorithm 3, steps 3f and 3g.
            self.stack.pop()
        } else if self.stack.depth() == 0
            && let Some(normal) = normal
        {
            // Algorithm 4, steps 3 to 5.
            self.waiting.remove(&normal.id.clone())
        } else {
            None
        };
        let Some(mut intention) = next else {
            return false;
        };
        let resumed = std::mem::replace(&mut intention.started, true);
        let goal = intention.goal.id.clone();
        self.map = intention.goal.map.clone();
        self.running = Some(Running {
            intention,
            phase: Phase::Planning,
            resumed,
            set_aside: false,
            broken: None,
            surprised: true,
            stage: Default::default(),
        });
        if !resumed {
            self.emit(Some(&goal), Happening::GoalStarted);
        }
        self.plan();
        true
    }
}

fn does_not_wait(goal: &Goal) -> bool {
    goal.urgency == Urgency::Emergency
}
