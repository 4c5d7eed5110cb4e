//! What always holds of an agent between two inputs.

use std::collections::BTreeSet;

use super::{Agent, Phase};
use crate::planner::{Item, Planner};

impl<P: Planner> Agent<P> {
    /// Asserts the invariants of [`Agent`]. For tests and simulations: a failure is a bug here.
    ///
    /// # Panics
    ///
    /// If one does not hold.
    pub fn check(&self) {
        let mut goals = BTreeSet::new();
        let mut records = BTreeSet::new();
        for intention in self.all_intentions() {
            let goal = &intention.goal.id;
            assert!(goals.insert(goal), "{goal} is in two places");
            assert!(
                !intention.agendas.is_empty(),
                "{goal} has nothing left to do and is not over"
            );
            let known: BTreeSet<_> = intention.records.iter().map(|record| &record.id).collect();
            for id in &known {
                assert!(records.insert((*id).clone()), "{id} is kept twice");
            }
            let running = self
                .running
                .as_ref()
                .and_then(|running| running.execution());
            for step in intention.plans.iter().flat_map(|plan| &plan.steps) {
                if let Item::Resume { id, .. } = &step.item {
                    let is_running = running.is_some_and(|execution| execution.id == *id);
                    assert!(
                        known.contains(id) || is_running,
                        "a plan for {goal} resumes {id}, of which there is no record"
                    );
                }
            }
        }
        let planning = self
            .running
            .as_ref()
            .is_some_and(|r| matches!(r.phase, Phase::Planning));
        assert!(
            planning || !self.planner.is_thinking(),
            "the planner thinks for nobody"
        );
        if let Some(running) = self
            .running
            .as_ref()
            .and_then(|running| running.execution())
        {
            assert!(
                !records.contains(&running.id),
                "{} is running and kept as suspended",
                running.id
            );
        }
    }
}
