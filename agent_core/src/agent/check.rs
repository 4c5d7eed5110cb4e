//! What always holds of an agent between two inputs.

use std::collections::BTreeSet;

use super::{Agent, Phase, Record};
use crate::planner::{Item, Planner};

impl<P: Planner> Agent<P> {
    /// Asserts the invariants of [`Agent`]. For tests and simulations: a failure is a bug here.
    ///
    /// # Panics
    ///
    /// If one does not hold.
    pub fn check(&self) {
        let fault = self.fault();
        assert!(fault.is_none(), "{}", fault.unwrap_or_default());
    }

    /// The first of the invariants of [`Agent`] that does not hold, in words.
    pub(super) fn fault(&self) -> Option<String> {
        let running = self.running.as_ref();
        let execution = running.and_then(|running| running.execution());
        let mut goals = BTreeSet::new();
        let mut records = BTreeSet::new();
        for intention in self.all_intentions() {
            let goal = &intention.goal.id;
            if !goals.insert(goal) {
                return Some(format!("{goal} is in two places"));
            }
            if intention.agendas.is_empty() {
                return Some(format!("{goal} has nothing left to do and is not over"));
            }
            let mut known = BTreeSet::new();
            for Record { id, .. } in &intention.records {
                known.insert(id);
                if !records.insert(id) {
                    return Some(format!("{id} is kept twice"));
                }
            }
            for step in intention.plans.iter().flat_map(|plan| &plan.steps) {
                if let Item::Resume { id, .. } = &step.item
                    && !known.contains(id)
                    && execution.is_none_or(|execution| execution.id != *id)
                {
                    return Some(format!(
                        "a plan for {goal} resumes {id}, of which there is no record"
                    ));
                }
            }
        }
        let planning = running.is_some_and(|r| matches!(r.phase, Phase::Planning));
        if !planning && self.planner.is_thinking() {
            return Some("the planner thinks for nobody".to_owned());
        }
        let id = execution.map(|execution| &execution.id);
        if let Some(id) = id.filter(|id| records.contains(id)) {
            return Some(format!("{id} is running and kept as suspended"));
        }
        if let Some((superior, id)) = &self.hold
            && !self.goal_of(superior, id)
        {
            return Some(format!("{superior} waits for {id}, which is not here"));
        }
        None
    }
}
