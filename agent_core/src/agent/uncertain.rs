//! Actions of which nobody can tell how they have ended (decision 11).

use super::{Agent, Execution, Phase};
use crate::model::FactChange;
use crate::planner::{self, Planner};
use crate::protocol::{Happening, Report};

impl<P: Planner> Agent<P> {
    /// Nobody can tell how an action has ended, unless the facts do. An action that may be repeated
    /// is planned for again from what is believed, and has not failed for that. One that must not be
    /// done twice ends the goal, whose outcome is as unknown as its own.
    pub(super) fn uncertain(&mut self, execution: Execution, reason: &str, facts: &[FactChange]) {
        let purpose = execution.step.purpose();
        let model = self.configuration.model.actions.get(&purpose.name);
        let repeatable = model.is_none_or(|model| model.repeatable);
        match self.happened(&execution, facts) {
            Some(true) => self.succeeded(execution, facts),
            Some(false) => self.ended_otherwise(execution, reason.to_owned(), facts),
            None if repeatable => self.ended_otherwise(execution, reason.to_owned(), facts),
            None => self.end_as_unknown(execution, reason, facts),
        }
    }

    /// Whether an action has been done, going by what is told of its effects: all that it was to bring
    /// about, or that some of it is not so. Nothing can be told from what was so before.
    fn happened(&self, execution: &Execution, told: &[FactChange]) -> Option<bool> {
        let effects = planner::effect_of(&self.problem(), execution.step.action());
        let mut all = None;
        for effect in effects {
            let FactChange::Add(fact) = effect else {
                continue;
            };
            if self.belief.holds(&fact) {
                continue;
            }
            if told.contains(&FactChange::Remove(fact.clone())) {
                return Some(false);
            }
            let holds = told.contains(&FactChange::Add(fact));
            all = Some(all.unwrap_or(true) && holds);
        }
        all.filter(|all| *all)
    }

    pub(super) fn end_as_unknown(
        &mut self,
        execution: Execution,
        reason: &str,
        facts: &[FactChange],
    ) {
        let facts = self.known(facts);
        let changes = self.learn(&facts);
        if let Some(running) = &mut self.running {
            running.phase = Phase::Planning;
        }
        let action = execution.step.action().clone();
        let reason = format!("nobody knows whether {action} was done: {reason}");
        let goal = self.running_goal();
        self.emit(
            goal.as_ref(),
            Happening::ActionFinished {
                id: execution.id,
                action,
                failure: Some(reason.clone()),
            },
        );
        self.believed(changes);
        let Some(running) = self.take_running() else {
            return;
        };
        let facts = self.tell_superiors();
        let what = Happening::GoalUnknown {
            reason: reason.clone(),
        };
        self.emit(Some(&running.intention.goal.id), what);
        self.end(running, Report::Unknown { reason, facts });
    }
}
