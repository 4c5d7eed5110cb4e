//! What turns out otherwise: observed facts, protected states, time-outs, deadlines.

use super::{Agent, Phase, Running};
use crate::model::{Fact, FactChange};
use crate::planner::{self, Planner};
use crate::protocol::Happening;

impl<P: Planner> Agent<P> {
    /// The changes that are about predicates and functions of this level.
    pub(super) fn known(&mut self, facts: &[FactChange]) -> Vec<FactChange> {
        let values = facts.iter().filter(|c| matches!(c, FactChange::Set(..)));
        // A superior may know a function that we do not.
        self.new_values = values.cloned().collect();
        let known = facts.iter().filter(|change| self.is_known(change));
        known.cloned().collect()
    }

    /// Whether a change is about a predicate or function of this level.
    pub(super) fn is_known(&self, change: &FactChange) -> bool {
        let domain = &self.configuration.domain;
        let (declared, atom) = match change {
            FactChange::Add(fact) | FactChange::Remove(fact) => {
                (domain.predicates.get(&fact.name), fact)
            }
            FactChange::Set(function, _) => (domain.functions.get(&function.name), function),
        };
        declared.is_some_and(|parameters| parameters.len() == atom.args.len())
    }

    /// Facts that turned out otherwise though nobody acted.
    pub(super) fn observed(&mut self, facts: &[FactChange]) {
        let known = self.known(facts);
        let changes = self.learn(&known);
        if changes.is_empty() {
            return self.look_for_confirmation(&known);
        }
        if let Some(running) = &mut self.running {
            running.surprised = true;
        }
        self.believed(changes);
        if self
            .running
            .as_ref()
            .is_some_and(|r| matches!(r.phase, Phase::Planning | Phase::Ready(_)))
        {
            self.plan();
        }
        self.look_after_the_action();
        self.look_for_confirmation(&known);
        self.tell_of_surprises();
    }

    /// Changes the belief, and tells the planner, which then need not find out. Returns what is
    /// different.
    pub(super) fn learn(&mut self, changes: &[FactChange]) -> Vec<FactChange> {
        let changes = self.belief.apply_all(changes);
        self.memory.touch(&changes);
        self.planner.observe(&changes);
        changes
    }

    /// The belief is different: whoever waits for that goes on, and plans are looked at again.
    pub(super) fn believed(&mut self, changes: Vec<FactChange>) {
        if changes.is_empty() {
            return;
        }
        let facts: Vec<Fact> = changes
            .iter()
            .filter_map(|change| match change {
                FactChange::Add(fact) | FactChange::Remove(fact) => Some(fact.clone()),
                FactChange::Set(..) => None,
            })
            .collect();
        self.emit(None, Happening::BeliefChanged { changes });
        for intention in self.aside.unblock(&facts) {
            self.waiting.add(intention);
        }
        // When it is settled who runs: what is taken up now is planned for, and needs no review.
        self.believes_otherwise = true;
    }

    /// Stops the running action if what it protects is broken, and says if the plan it belongs to
    /// no longer holds.
    fn look_after_the_action(&mut self) {
        let problem = self.problem();
        let execution = self.running.as_ref().and_then(Running::execution);
        let monitored = execution.is_some_and(|it| self.is_monitored(it.step.purpose()));
        let Some(running) = &mut self.running else {
            return;
        };
        let Phase::Executing(execution) = &running.phase else {
            return;
        };
        let purpose = execution.step.purpose();
        // What has done what it was for protects nothing any more.
        let at_work = execution.done.is_none()
            && (!monitored || planner::missing_goal_state(&problem, purpose).is_some());
        let broken = planner::broken_protection(&problem, &execution.step)
            .filter(|_| at_work)
            .map(|why| format!("{why}, which {purpose} protects"));
        let plans = &running.intention.plans;
        let verdict = plans
            .first()
            .map(|plan| planner::simulate(&problem, &plan.steps, true));
        let kept = plans
            .iter()
            .skip(1)
            .filter(|plan| planner::simulate(&problem, &plan.steps, true).is_ok())
            .count();
        let fails = verdict.and_then(Result::err);
        let fitted = std::mem::replace(&mut running.intention.fits, fails.is_none());
        running.broken = running.broken.take().or(broken.clone());
        let why = broken.or(fails);
        if let (true, Some(why)) = (fitted, why) {
            running.intention.fits = false;
            let goal = running.intention.goal.id.clone();
            self.emit(Some(&goal), Happening::PlanRevised { why, kept });
        }
    }

    /// What is due: goals whose deadline has passed, an action that takes too long.
    pub(super) fn watch_the_clock(&mut self) {
        let now = self.now;
        let late: Vec<_> = self
            .all_intentions()
            .filter(|i| i.cancelled.is_none() && i.goal.deadline.is_some_and(|at| at <= now))
            .map(|i| i.goal.id.clone())
            .collect();
        for goal in late {
            self.cancel(&goal, "its deadline has passed");
        }
        let is_late = |running: &Running| running.due().is_some_and(|due| due <= now);
        if !self.running.as_ref().is_some_and(is_late) || self.was_not_confirmed() {
            return;
        }
        let execution = self.running.as_ref().and_then(Running::execution);
        let monitored = execution.is_some_and(|it| self.is_monitored(it.step.purpose()));
        let Some(running) = &mut self.running else {
            return;
        };
        if let Phase::Executing(execution) = &running.phase {
            let purpose = execution.step.purpose().clone();
            // Counts as a failure, so that it is not tried for ever; one that is not resumed counts
            // when it has stopped.
            if !monitored {
                let failures = &mut running.intention.failures;
                let failures = failures.entry(purpose.clone()).or_default();
                *failures = failures.saturating_add(1);
            }
            running.broken = Some(format!("{purpose} takes longer than it may"));
        }
    }
}
