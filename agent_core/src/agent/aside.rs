//! Goals that wait for something else than their turn.

use std::collections::BTreeSet;

use super::intention::Intention;
use crate::model::Fact;
use crate::protocol::GoalId;

/// What a goal that was set aside waits for.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum WaitsFor {
    /// For the user to let it go on.
    User,
    /// For one of these facts to change (decision 7: the goal is *blocked*).
    Facts(BTreeSet<Fact>),
}

/// Goals set aside so that others go on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GoalsAside {
    goals: Vec<(Intention, WaitsFor)>,
}

impl GoalsAside {
    /// Adds one.
    pub fn add(&mut self, intention: Intention, waits_for: WaitsFor) {
        self.goals.push((intention, waits_for));
    }

    /// Takes one out.
    pub fn remove(&mut self, goal: &GoalId) -> Option<Intention> {
        let place = self
            .goals
            .iter()
            .position(|(aside, _)| aside.goal.id == *goal)?;
        Some(self.goals.remove(place).0)
    }

    /// Takes out all that wait for one of these facts.
    pub fn unblock(&mut self, changed: &[Fact]) -> Vec<Intention> {
        let unblocked = self.goals.extract_if(.., |(_, waits_for)| match waits_for {
            WaitsFor::User => false,
            WaitsFor::Facts(facts) => changed.iter().any(|fact| facts.contains(fact)),
        });
        unblocked.map(|(intention, _)| intention).collect()
    }

    /// All of them, with what they wait for.
    pub fn goals(&self) -> &[(Intention, WaitsFor)] {
        &self.goals
    }

    pub(super) fn intentions_mut(&mut self) -> impl Iterator<Item = &mut Intention> {
        self.goals.iter_mut().map(|(intention, _)| intention)
    }
}
