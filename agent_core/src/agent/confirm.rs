//! Whether an action has done what it was for: the three outcomes of execution monitoring.
//!
//! As in the second paper (section 5.2): an action has succeeded when its goal states are confirmed and
//! its protected states were kept; it has failed when a protected state was broken, or when the goal
//! states were not confirmed in time. Confirmed is what was told, by the executor, by the agent's own
//! sensors or by others', and not what the operator predicts. Of an action whose model names no goal
//! states the executor's word is enough.

use std::sync::Arc;

use super::suspension::continuations;
use super::{Agent, Execution, Phase};
use crate::model::{Action, ActionModel, Clause, FactChange};
use crate::planner::{self, Item, Planner};
use crate::protocol::Instruction;

impl<P: Planner> Agent<P> {
    fn model_of(&self, action: &Action) -> Option<&ActionModel> {
        self.configuration.model.actions.get(&action.name)
    }

    /// Whether sensors have to confirm what an action was for.
    pub(super) fn is_monitored(&self, action: &Action) -> bool {
        self.model_of(action)
            .is_some_and(|model| !model.goal_states.is_empty())
    }

    /// The first goal state of an action that does not hold, once all this is known as well.
    fn missing(&self, action: &Action, known: &[&[FactChange]]) -> Option<String> {
        let mut problem = self.problem();
        let belief = Arc::make_mut(&mut problem.belief);
        for changes in known {
            belief.apply_all(changes);
        }
        planner::missing_goal_state(&problem, action)
    }

    /// Whether the goal states of an action hold by what was told, so that it need not be done again
    /// however it has ended.
    fn is_achieved(&self, action: &Action, told: &[FactChange]) -> bool {
        self.is_monitored(action) && self.missing(action, &[told]).is_none()
    }

    /// What sensors tell against an action's having done what it was for.
    fn contradiction(&self, execution: &Execution, told: &[FactChange]) -> Option<String> {
        let purpose = execution.step.purpose();
        let predicted = planner::effect_of(&self.problem(), execution.step.action());
        // What even the operator does not promise cannot be told against it, only waited for.
        self.missing(purpose, &[&predicted])
            .map_or_else(|| self.missing(purpose, &[&predicted, told]), |_| None)
    }

    /// Why an action that was stopped is not to be resumed: what it protects was broken, or it took too
    /// long.
    pub(super) fn failure_of(&self, execution: &Execution) -> Option<String> {
        let broken = self.running.as_ref()?.broken.clone()?;
        self.is_monitored(execution.step.purpose())
            .then_some(broken)
    }

    /// The executor says that the running action is done.
    pub(super) fn said_to_be_done(&mut self, mut execution: Execution, facts: &[FactChange]) {
        let purpose = execution.step.purpose();
        if !self.is_monitored(purpose) {
            return self.succeeded(execution, facts);
        }
        if let Some(reason) = self.failure_of(&execution) {
            return self.fails(execution, reason, facts, None);
        }
        let told = self.known(facts);
        if self.missing(purpose, &[&told]).is_none() {
            return self.succeeded(execution, facts);
        }
        if let Some(why) = self.contradiction(&execution, &told) {
            let reason = format!("{} says that it is done, but {why}", execution.executor);
            return self.fails(execution, reason, facts, None);
        }
        let changes = self.learn(&told);
        execution.done.get_or_insert_default().extend(told);
        if let Some(running) = &mut self.running {
            // Nothing is left that could be stopped.
            running.phase = Phase::Executing(execution);
        }
        self.believed(changes);
    }

    /// Sensors have told something: perhaps what the running action waits for.
    pub(super) fn look_for_confirmation(&mut self, told: &[FactChange]) {
        let Some(running) = &mut self.running else {
            return;
        };
        let (Phase::Executing(execution) | Phase::Stopping(execution)) = &mut running.phase else {
            return;
        };
        let Some(done) = &mut execution.done else {
            return;
        };
        done.extend(told.iter().cloned());
        let facts = done.clone();
        let execution = execution.clone();
        if self.missing(execution.step.purpose(), &[]).is_none() {
            self.succeeded(execution, &facts);
        } else if let Some(why) = self.contradiction(&execution, told) {
            let reason = format!("{} says that it is done, but {why}", execution.executor);
            self.fails(execution, reason, &facts, None);
        }
    }

    /// The time is over for somebody to confirm what the executor says. Returns whether that was waited
    /// for. What must not be done twice may have been done (decision 11).
    pub(super) fn was_not_confirmed(&mut self) -> bool {
        let running = self.running.as_ref();
        let execution = running.and_then(|running| running.execution()).cloned();
        let Some((execution, facts)) = execution.and_then(|it| Some((it.clone(), it.done?))) else {
            return false;
        };
        let why = self.missing(execution.step.purpose(), &[]);
        let why = why.unwrap_or_default();
        let reason = format!("no sensor has confirmed it in time: {why}");
        let model = self.model_of(execution.step.purpose());
        match model.is_none_or(|model| model.repeatable) {
            true => self.fails(execution, reason, &facts, None),
            false => self.end_as_unknown(execution, &reason, &facts),
        }
        true
    }

    /// Something else goes first, and nothing is left to be stopped: then the executor's word is
    /// enough. Whatever turns out otherwise is a surprise like any other. Returns whether it was taken.
    pub(super) fn takes_the_executors_word(&mut self) -> bool {
        let running = self.running.as_ref();
        let execution = running.and_then(|running| running.execution());
        let Some((execution, facts)) = execution.and_then(|it| Some((it, it.done.as_ref()?)))
        else {
            return false;
        };
        let (execution, facts) = (execution.clone(), facts.clone());
        let gives_way = self.gives_way();
        if gives_way {
            self.succeeded(execution, &facts);
        }
        gives_way
    }

    /// The running action has failed, in whatever way; if its goal states hold all the same, it is not
    /// done again.
    pub(super) fn fails(
        &mut self,
        execution: Execution,
        reason: String,
        facts: &[FactChange],
        undo: Option<Item>,
    ) {
        let told = self.known(facts);
        if self.is_achieved(execution.step.purpose(), &told) {
            self.achieved_otherwise(execution, reason, facts);
        } else {
            self.failed(execution, reason, facts, undo);
        }
    }

    /// The running action was stopped because it has failed: no record of it is kept, and it may be
    /// undone, but not resumed.
    pub(super) fn stopped_for_good(
        &mut self,
        execution: Execution,
        reason: String,
        facts: &[FactChange],
    ) {
        let id = execution.id.clone();
        self.instruct(&execution.executor, Instruction::Clear { id });
        let (problem, purpose) = (self.problem(), execution.step.purpose());
        let undo = continuations(&problem, &execution.id, purpose).and_then(|next| next.rollback);
        let mut different = match self.suspension_applies(purpose) {
            true => planner::effect_of_suspension(&problem, purpose),
            false => Vec::new(),
        };
        different.extend(self.known(facts));
        self.fails(execution, reason, &different, undo);
    }

    /// Whether what an action's suspension is to take away is there: if a bottle stands no longer where
    /// it was protected, nobody sets it down at the edge.
    fn suspension_applies(&self, action: &Action) -> bool {
        let Some(model) = self.model_of(action) else {
            return false;
        };
        let Some(suspension) = &model.suspension else {
            return false;
        };
        let protects = |fact| model.protected.contains(&Clause::Fact(true, fact));
        let taken = suspension.effect.remove.iter();
        let mut taken = taken.filter(|change| change.over.is_empty() && change.when.is_empty());
        taken.all(|change| {
            let gone = planner::instance(&change.fact, action);
            let gone = gone.is_some_and(|fact| !self.belief.holds(&fact));
            !(gone && protects(change.fact.clone()))
        })
    }
}
