//! A planner that says how long it took.

use std::time::{Duration, Instant};

use agent_core::model::FactChange;
use agent_core::planner::{Agenda, AnyPlanner, Confirmed, Outcome, Plan, Planner, Problem};
use agent_core::protocol::GoalId;

/// What a planner has done since somebody last looked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Meter {
    /// In `begin` and `think`: planning for the goal that is pursued. What else a planner is told
    /// (changes, goals to be kept in mind) is not planning for that goal, and is not counted here.
    pub planning: Duration,
    /// Nodes expanded.
    pub expanded: u64,
    /// Nodes evaluated.
    pub evaluated: u64,
}

impl Meter {
    /// Both.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            planning: self.planning + other.planning,
            expanded: self.expanded + other.expanded,
            evaluated: self.evaluated + other.evaluated,
        }
    }

    /// What was done after an earlier look.
    pub(crate) fn since(self, before: Self) -> Self {
        Self {
            planning: self.planning.saturating_sub(before.planning),
            expanded: self.expanded - before.expanded,
            evaluated: self.evaluated - before.evaluated,
        }
    }
}

/// A planner with a meter.
#[derive(Clone, Debug)]
pub struct Metered {
    planner: AnyPlanner,
    meter: Meter,
}

impl Metered {
    pub(crate) fn new(planner: AnyPlanner) -> Self {
        Self {
            planner,
            meter: Meter::default(),
        }
    }

    /// What it has done since it was made; who looks twice takes the difference.
    pub(crate) fn meter(&self) -> Meter {
        self.meter
    }
}

impl Planner for Metered {
    fn prepare(&mut self, problem: &Problem) {
        self.planner.prepare(problem);
    }

    fn begin(&mut self, problem: Problem, agendas: &[Agenda]) {
        let begun = Instant::now();
        self.planner.begin(problem, agendas);
        self.meter.planning += begun.elapsed();
    }

    fn think(&mut self, expansions: u64) -> Option<Outcome> {
        let begun = Instant::now();
        let outcome = self.planner.think(expansions);
        self.meter.planning += begun.elapsed();
        if let Some(outcome) = &outcome {
            self.meter.expanded += outcome.expanded;
            self.meter.evaluated += outcome.evaluated;
        }
        outcome
    }

    fn confirm(&mut self, kept: &Plan) -> Option<Confirmed> {
        let begun = Instant::now();
        let confirmed = self.planner.confirm(kept);
        self.meter.planning += begun.elapsed();
        if let Some(confirmed) = confirmed {
            self.meter.expanded += confirmed.expanded;
            self.meter.evaluated += confirmed.evaluated;
        }
        confirmed
    }

    fn is_thinking(&self) -> bool {
        self.planner.is_thinking()
    }

    fn stop(&mut self) {
        self.planner.stop();
    }

    fn observe(&mut self, changes: &[FactChange]) {
        self.planner.observe(changes);
    }

    fn known(&self, problem: &Problem, agendas: &[Agenda]) -> Vec<Plan> {
        self.planner.known(problem, agendas)
    }

    fn keep(&mut self, goal: &GoalId, agendas: &[Agenda]) {
        self.planner.keep(goal, agendas);
    }

    fn number_frames_from(&mut self, first: u64) {
        self.planner.number_frames_from(first);
    }

    fn release(&mut self, goal: &GoalId) {
        self.planner.release(goal);
    }
}
