//! Planning: forward-chaining decomposition of tasks, best first by cost, alternatives kept.

mod any;
mod arising;
mod cost;
mod decompose;
mod detour;
mod estimate;
mod graph;
mod hangs_on;
pub mod invariants;
mod matching;
#[cfg(test)]
mod meaning;
mod naive;
mod nearer;
mod network;
mod plan;
mod problem;
#[cfg(test)]
mod random_domain;
mod revise;
mod state;
#[cfg(test)]
mod typing;
mod ways;
mod what_if;

pub use any::{AnyPlanner, PlannerKind};
pub use arising::{Arisen, arising, asks_for};
pub use detour::is_detour;
pub use graph::GraphPlanner;
pub(crate) use hangs_on::with_changes;
pub use hangs_on::{Reliance, hangs_on};
pub use naive::NaivePlanner;
pub use nearer::may_begin_with;
pub use network::{Frame, Item, TaskList};
pub use plan::{Agenda, Origin, Plan, Step};
pub use problem::Problem;
pub use revise::{
    advance, broken_protection, effect_of, effect_of_suspension, instance, missing_goal_state,
    number_of, project, protected_by, simulate,
};
pub use ways::{adds_and_removes, ways_to};
pub use what_if::{Considered, WhatIf, consider, if_mended};

use std::collections::BTreeSet;

use crate::model::{Cost, Fact, FactChange};
use crate::protocol::GoalId;

/// How far a plan is decomposed before it may be followed.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Depth {
    /// To the last action. Only then can an agent tell whether the rest of a suspended plan still
    /// holds.
    #[default]
    Full,
    /// Until the first action is known, as in the paper.
    FirstAction,
    /// Until so many actions are known.
    Actions(usize),
}

impl Depth {
    /// How many actions have to be known, if not all.
    fn actions(self) -> Option<usize> {
        match self {
            Self::Full => None,
            Self::FirstAction => Some(1),
            Self::Actions(actions) => Some(actions.max(1)),
        }
    }
}

/// How to plan.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Settings {
    /// How far plans are decomposed.
    pub depth: Depth,
    /// How many plans are kept, the best included; at least one.
    pub alternatives: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            depth: Depth::Full,
            alternatives: 3,
        }
    }
}

/// What came of planning.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Cheapest first; none if it is proved that there is none.
    pub plans: Vec<Plan>,
    /// Facts that change without the agent, that were asked for and did not hold.
    pub wanted: BTreeSet<Fact>,
    /// Nodes that were expanded.
    pub expanded: u64,
    /// How many of them to find the best plan; the others were for alternatives to it.
    pub expanded_for_best: u64,
    /// Nodes whose cost to the end was estimated or worked out anew: those that were met for the first
    /// time, and those that a change bears on.
    pub evaluated: u64,
    /// Whether no plan is cheaper than the first, or there is none. If not, the planner has acted
    /// before it knew: planning again goes on from what it knows by now.
    pub proved: bool,
}

/// A plan that was kept is one of the best.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Confirmed {
    /// What it costs now.
    pub cost: Cost,
    /// As in [`Outcome`].
    pub expanded: u64,
    /// As in [`Outcome`].
    pub evaluated: u64,
}

/// Something that finds plans, in slices, so that planning never blocks listening (decision 9).
///
/// Decision 7 has three outcomes: plans, the proof that there is none, and *unknown as yet*, which
/// is that [`think`](Self::think) returns `None` and wants to be called again.
///
/// How a planner is used: [`observe`](Self::observe) with every change of the belief, when it
/// happens; [`begin`](Self::begin) with the belief as it is and the agendas of the goal that is
/// pursued; [`think`](Self::think) until there is an outcome. Nothing but `begin`, `think` and `stop`
/// is needed for right answers: what is told besides makes them cheaper. Agendas may be any lists
/// of tasks; those that follow from an earlier plan (what comes after a step, an open task again, an
/// action resumed) are met again in what is known.
pub trait Planner {
    /// Reads a map and a belief that are going to be planned with, which takes as long as they are
    /// large. Otherwise the first [`begin`](Self::begin) does.
    fn prepare(&mut self, _problem: &Problem) {}

    /// Begins to plan for the cheapest of `agendas`. What was begun before is given up.
    fn begin(&mut self, problem: Problem, agendas: &[Agenda]);

    /// Goes on for about so many expansions; `None` if it is not done, or has nothing to do.
    fn think(&mut self, expansions: u64) -> Option<Outcome>;

    /// Says that a plan that was kept still holds and is one of the best for what was begun, if little
    /// planning is enough to know; then there is nothing left to think about. `None` says nothing about
    /// the plan: [`think`](Self::think). A planner that keeps nothing never says so.
    fn confirm(&mut self, _kept: &Plan) -> Option<Confirmed> {
        None
    }

    /// Whether there is something to go on with.
    fn is_thinking(&self) -> bool;

    /// Gives up what was begun.
    fn stop(&mut self);

    /// The belief has changed, in this order. Whoever tells a planner of every change gets
    /// [`begin`](Self::begin) for the price of what has changed; a planner that was not told finds
    /// out by comparing, which takes as long as the belief is large. Planning that is under way
    /// goes on from the new belief, or begins anew.
    fn observe(&mut self, _changes: &[FactChange]) {}

    /// Plans for these agendas that are at hand without any planning, cheapest first. They may be
    /// out of date: whoever asks finds out whether they hold. Changes nothing.
    fn known(&self, _problem: &Problem, _agendas: &[Agenda]) -> Vec<Plan> {
        Vec::new()
    }

    /// A goal is set aside and will be planned for again, by these agendas: what is known of it is
    /// worth keeping. Whoever does not say so may lose it after a while, and nothing else.
    fn keep(&mut self, _goal: &GoalId, _agendas: &[Agenda]) {}

    /// Frames of plans that are found from now on have this number or a higher one: lower ones are
    /// those of another planner, whose plans were written down and read again.
    fn number_frames_from(&mut self, first: u64);

    /// A goal that was set aside is taken up or given up.
    fn release(&mut self, _goal: &GoalId) {}
}
