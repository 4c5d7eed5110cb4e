//! What a vehicle has to know of the agent in it.

use std::collections::BTreeSet;
use std::convert::Infallible;

use crate::agent::{Agent, Intention, WaitsFor};
use crate::model::{Belief, Fact};
use crate::parallel::ParallelAgent;
use crate::planner::Planner;
use crate::protocol::{Durable, GoalId};

/// An agent that plans and acts, whether it does one thing at a time or several.
pub trait Mind: Durable<In = Infallible, Out = Infallible> {
    /// What it holds to be true.
    fn belief(&self) -> &Belief;

    /// All its goals that are not over, with the plans for them.
    fn intentions(&self) -> Vec<&Intention>;

    /// The facts that its goals wait for.
    fn wanted(&self) -> BTreeSet<Fact>;

    /// Whether that goal of its waits for a fact to change, as there is no plan for it.
    fn is_blocked(&self, goal: &GoalId) -> bool;

    /// Whether it has a goal of that name that is not over.
    fn pursues(&self, goal: &GoalId) -> bool {
        self.intentions().iter().any(|it| it.goal.id == *goal)
    }
}

impl<P: Planner> Mind for Agent<P> {
    fn belief(&self) -> &Belief {
        Agent::belief(self)
    }

    fn intentions(&self) -> Vec<&Intention> {
        let stacked = self.stack().entries().iter().map(|entry| &entry.intention);
        let aside = self.aside().goals().iter().map(|(intention, _)| intention);
        let all = self.running().into_iter().chain(stacked).chain(aside);
        all.chain(self.waiting().intentions()).collect()
    }

    fn is_blocked(&self, goal: &GoalId) -> bool {
        let mut aside = self.aside().goals().iter();
        aside.any(|(intention, waits_for)| {
            intention.goal.id == *goal && matches!(waits_for, WaitsFor::Facts(_))
        })
    }

    fn wanted(&self) -> BTreeSet<Fact> {
        let aside = self.aside().goals().iter();
        let facts = aside.filter_map(|(_, waits_for)| match waits_for {
            WaitsFor::User => None,
            WaitsFor::Facts(facts) => Some(facts),
        });
        facts.flatten().cloned().collect()
    }
}

impl<P: Planner + Clone> Mind for ParallelAgent<P> {
    fn belief(&self) -> &Belief {
        ParallelAgent::belief(self)
    }

    fn intentions(&self) -> Vec<&Intention> {
        ParallelAgent::intentions(self).collect()
    }

    fn is_blocked(&self, goal: &GoalId) -> bool {
        self.agents().any(|agent| Mind::is_blocked(agent, goal))
    }

    fn wanted(&self) -> BTreeSet<Fact> {
        let wanted = ParallelAgent::wanted(self).into_iter();
        wanted.flat_map(|(_, facts)| facts).collect()
    }
}
