//! What a vehicle has taken and cannot go on with is given back: another one may be able to.

use super::tasks::goal_of;
use super::{Mind, Vehicle};
use crate::model::Time;
use crate::planner::Planner;
use crate::protocol::{ActionId, GoalId};

/// A goal may be blocked for so long before its task is given back, on the world's clock. What is in the
/// way is often gone sooner, and what was begun would have to be begun again.
const PATIENCE: Time = Time(10_000_000);

impl<A: Mind, P: Planner> Vehicle<A, P> {
    /// Gives tasks back whose goals have been blocked for too long. Nobody has failed: who can do it now
    /// says so when it is offered again, and until then it is open.
    pub(super) fn give_back_what_is_stuck(&mut self) {
        let taken: Vec<(ActionId, GoalId)> = (self.tasks.taken().iter())
            .filter(|(_, taken)| !taken.given_up)
            .map(|(id, _)| (id.clone(), goal_of(id)))
            .filter(|(_, goal)| self.mind.is_blocked(goal))
            .collect();
        self.stuck
            .retain(|id, _| taken.iter().any(|(stuck, _)| stuck == id));
        for (id, _) in taken {
            let since = *self.stuck.entry(id.clone()).or_insert(self.now);
            if since + PATIENCE <= self.now {
                self.stuck.remove(&id);
                self.tasks.give_up(&id);
                self.cancel(&id, "it cannot be done from here at present");
            }
        }
    }

    /// When the next one is given back.
    pub(super) fn stuck_until(&self) -> Option<Time> {
        self.stuck.values().min().map(|since| *since + PATIENCE)
    }
}
