//! A goal that was accepted, and which of two goes first.

use std::sync::Arc;

use crate::model::{Map, Symbol, Task, Time};
use crate::protocol::{ActionId, GoalId, Urgency};

/// A goal that was accepted.
#[derive(Clone, Debug, PartialEq)]
pub struct Goal {
    /// Its name.
    pub id: GoalId,
    /// What is to be done, in this order.
    pub tasks: Vec<Task>,
    /// Normal or emergency.
    pub urgency: Urgency,
    /// Higher goes first among goals of the same urgency.
    pub priority: i32,
    /// When it has failed if it is not done.
    pub deadline: Option<Time>,
    /// Counts the goals in the order in which they came.
    pub number: u64,
    /// The superior whose instruction this is, and the name of that; `None` for a user's goal.
    pub superior: Option<(Symbol, ActionId)>,
    /// What it is pursued on.
    pub map: Arc<Map>,
}

impl Goal {
    /// Whether this goal interrupts `other` (decision 4), whether that is running, suspended or
    /// has not begun.
    ///
    /// Among emergencies the higher priority goes first, then the newer one: the paper's stack. A
    /// normal goal interrupts nothing; its priority only orders the waiting list.
    pub fn outranks(&self, other: &Self) -> bool {
        self.urgency == Urgency::Emergency && self.rank() > other.rank()
    }

    /// Greater goes first.
    pub(super) fn rank(&self) -> impl Ord + use<> {
        let age = match self.urgency {
            // The newest first.
            Urgency::Emergency => i128::from(self.number),
            // The oldest first.
            Urgency::Normal => -i128::from(self.number),
        };
        (self.urgency, self.priority, age)
    }
}
