//! The planner that was chosen when the program began.

use super::{
    Agenda, Confirmed, GraphPlanner, NaivePlanner, Outcome, Plan, Planner, Problem, Settings,
};
use crate::model::FactChange;
use crate::protocol::GoalId;

/// The planners that there are.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum PlannerKind {
    /// [`GraphPlanner`]: keeps what it has found out, and finds out anew what a change bears on.
    #[default]
    Graph,
    /// [`NaivePlanner`]: from scratch each time.
    Naive,
}

/// One of the planners.
#[derive(Clone, Debug)]
pub enum AnyPlanner {
    /// [`PlannerKind::Graph`].
    Graph(GraphPlanner),
    /// [`PlannerKind::Naive`].
    Naive(NaivePlanner),
}

impl AnyPlanner {
    /// A planner of that kind that has nothing to do.
    pub fn new(kind: PlannerKind, settings: Settings) -> Self {
        match kind {
            PlannerKind::Graph => Self::Graph(GraphPlanner::new(settings)),
            PlannerKind::Naive => Self::Naive(NaivePlanner::new(settings)),
        }
    }

    fn planner(&self) -> &dyn Planner {
        match self {
            Self::Graph(planner) => planner,
            Self::Naive(planner) => planner,
        }
    }

    fn planner_mut(&mut self) -> &mut dyn Planner {
        match self {
            Self::Graph(planner) => planner,
            Self::Naive(planner) => planner,
        }
    }
}

impl Planner for AnyPlanner {
    fn begin(&mut self, problem: Problem, agendas: &[Agenda]) {
        self.planner_mut().begin(problem, agendas);
    }

    fn think(&mut self, expansions: u64) -> Option<Outcome> {
        self.planner_mut().think(expansions)
    }

    fn confirm(&mut self, kept: &Plan) -> Option<Confirmed> {
        self.planner_mut().confirm(kept)
    }

    fn is_thinking(&self) -> bool {
        self.planner().is_thinking()
    }

    fn stop(&mut self) {
        self.planner_mut().stop();
    }

    fn prepare(&mut self, problem: &Problem) {
        self.planner_mut().prepare(problem);
    }

    fn observe(&mut self, changes: &[FactChange]) {
        self.planner_mut().observe(changes);
    }

    fn known(&self, problem: &Problem, agendas: &[Agenda]) -> Vec<Plan> {
        self.planner().known(problem, agendas)
    }

    fn keep(&mut self, goal: &GoalId, agendas: &[Agenda]) {
        self.planner_mut().keep(goal, agendas);
    }

    fn number_frames_from(&mut self, first: u64) {
        self.planner_mut().number_frames_from(first);
    }

    fn release(&mut self, goal: &GoalId) {
        self.planner_mut().release(goal);
    }
}
