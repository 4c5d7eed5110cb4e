//! The planners of agents under test.

use std::sync::Arc;

use agent_core::model::FactChange;
use agent_core::planner::{
    Agenda, AnyPlanner, Confirmed, Outcome, Plan, Planner, PlannerKind, Problem, Settings,
};
use agent_core::protocol::GoalId;

/// Which planner an agent under test has.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Planning {
    /// The one that agents have unless told otherwise.
    #[default]
    AsShipped,
    /// The baseline.
    FromScratch,
    /// The one that agents have, and the baseline beside it, which must come to the same costs.
    Both,
}

/// A planner of an agent under test.
#[derive(Clone, Debug)]
pub struct TestPlanner {
    planner: AnyPlanner,
    /// Plans the same from scratch.
    judge: Option<AnyPlanner>,
    settings: Settings,
    asked: Option<(Problem, Vec<Agenda>)>,
}

impl TestPlanner {
    /// A planner that has nothing to do.
    pub fn new(planning: Planning, settings: Settings) -> Self {
        let kind = match planning {
            Planning::AsShipped | Planning::Both => PlannerKind::default(),
            Planning::FromScratch => PlannerKind::Naive,
        };
        Self {
            planner: AnyPlanner::new(kind, settings),
            judge: (planning == Planning::Both)
                .then(|| AnyPlanner::new(PlannerKind::Naive, settings)),
            settings,
            asked: None,
        }
    }

    /// Whether there is a plan, and what the best costs, is no matter of the planner.
    fn compare(&mut self, outcome: &Outcome) {
        let (Some(judge), Some((problem, agendas))) = (&mut self.judge, self.asked.take()) else {
            return;
        };
        let list: Vec<String> = agendas.iter().map(|a| format!("{:?}", a.tasks)).collect();
        judge.begin(problem, &agendas);
        let Some(expected) = judge.think(u64::MAX) else {
            panic!("from scratch, planning for {list:?} does not end");
        };
        let cost = |outcome: &Outcome| outcome.plans.first().map(|plan| plan.cost);
        assert_eq!(
            cost(outcome),
            cost(&expected),
            "{:?} {}\n{:?}\nfrom scratch {:?}",
            list,
            self.settings.alternatives,
            outcome.plans.first().map(|plan| plan.actions()),
            expected.plans.first().map(|plan| plan.actions()),
        );
    }
}

impl Planner for TestPlanner {
    fn begin(&mut self, problem: Problem, agendas: &[Agenda]) {
        if self.judge.is_some() {
            self.asked = Some((problem.clone(), agendas.to_vec()));
        }
        self.planner.begin(problem, agendas);
    }

    fn think(&mut self, expansions: u64) -> Option<Outcome> {
        let outcome = self.planner.think(expansions)?;
        self.compare(&outcome);
        Some(outcome)
    }

    fn confirm(&mut self, kept: &Plan) -> Option<Confirmed> {
        let confirmed = self.planner.confirm(kept)?;
        if let (Some(judge), Some((problem, agendas))) = (&mut self.judge, self.asked.take()) {
            judge.begin(problem, &agendas);
            let expected = judge
                .think(u64::MAX)
                .and_then(|found| found.plans.first().cloned());
            let cost = expected.as_ref().map(|plan| plan.cost);
            assert_eq!(
                Some(confirmed.cost),
                cost,
                "{kept:?}\nfrom scratch {expected:?}"
            );
        }
        Some(confirmed)
    }

    fn is_thinking(&self) -> bool {
        self.planner.is_thinking()
    }

    fn stop(&mut self) {
        self.planner.stop();
    }

    fn prepare(&mut self, problem: &Problem) {
        self.planner.prepare(problem);
    }

    fn observe(&mut self, changes: &[FactChange]) {
        self.planner.observe(changes);
        if let Some((problem, _)) = &mut self.asked {
            Arc::make_mut(&mut problem.belief).apply_all(changes);
        }
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
