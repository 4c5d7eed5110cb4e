//! What always holds of a parallel agent between two inputs.

use std::collections::BTreeSet;

use super::ParallelAgent;
use crate::agent::Agent;
use crate::model::Symbol;
use crate::parallel::Footprint;
use crate::planner::Planner;

impl<P: Planner> ParallelAgent<P> {
    /// Asserts the invariants of [`ParallelAgent`], and those of its agents. For tests and simulations: a
    /// failure is a bug here.
    ///
    /// # Panics
    ///
    /// If one does not hold.
    pub fn check(&self) {
        self.agents().for_each(Agent::check);
        let fault = self.fault();
        assert!(fault.is_none(), "{}", fault.unwrap_or_default());
    }

    pub(super) fn fault(&self) -> Option<String> {
        let belief = self.list.belief();
        for agent in self.agents() {
            if agent.belief() != belief {
                return Some(format!("{} believes otherwise than the list", agent.name()));
            }
        }
        let mut goals = BTreeSet::new();
        for intention in self.intentions() {
            if !goals.insert(&intention.goal.id) {
                return Some(format!("{} is with two agents", intention.goal.id));
            }
        }
        if let Some(running) = self.list.running() {
            return Some(format!("the list pursues {}", running.goal.id));
        }
        let mut taken: BTreeSet<Symbol> = BTreeSet::new();
        for branch in &self.branches {
            if branch.goals().count() > 1 {
                return Some(format!("{} has more than one goal", branch.name()));
            }
            let Some(step) = branch.executing_step() else {
                continue;
            };
            if self.foremost.executing().is_some() {
                let action = step.action();
                return Some(format!("{action} goes on in spite of an emergency"));
            }
            for resource in Footprint::of(&branch.present(), step).resources {
                if taken.contains(&resource) {
                    return Some(format!("two actions need the {resource}"));
                }
                taken.insert(resource);
            }
        }
        None
    }
}
