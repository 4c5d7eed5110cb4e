//! An agent that is one of several of the same robot: it waits for leave before it acts, and rests when
//! it is told to.
//!
//! While it waits for leave, every change of the belief has it plan again: what it is going to do is
//! bound as late as can be.

use super::{Agent, Phase};
use crate::model::{Fact, Time};
use crate::planner::{Plan, Planner, Problem, Step};

/// What an agent waits for leave for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Ready {
    /// To begin the first action of its plan.
    Step,
    /// To do without a plan (decision 7); these facts would help.
    NoPlan(Vec<Fact>),
}

/// What an agent would do next, if it were allowed to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Proposal<'a> {
    /// Begin this plan.
    Plan(&'a Plan),
    /// Give the goal up, or set it aside until one of these facts changes: there is no plan.
    NoPlan(&'a [Fact]),
}

impl<P: Planner> Agent<P> {
    /// What it waits for leave for; `None` if it waits for something else.
    pub fn proposal(&self) -> Option<Proposal<'_>> {
        let running = self.running.as_ref()?;
        let Phase::Ready(ready) = &running.phase else {
            return None;
        };
        if self.is_to_yield() {
            return None;
        }
        match ready {
            Ready::NoPlan(wanted) => Some(Proposal::NoPlan(wanted)),
            Ready::Step => running.intention.plans.first().map(Proposal::Plan),
        }
    }

    /// Gives it leave to do what it proposes. Nothing happens if it proposes nothing.
    pub fn grant(&mut self, now: Time) {
        self.now = self.now.max(now);
        let proposed = self.proposal().map(|proposal| match proposal {
            Proposal::Plan(plan) => Ok(plan.steps.first().cloned()),
            Proposal::NoPlan(wanted) => Err(wanted.to_vec()),
        });
        match proposed {
            None | Some(Ok(None)) => return,
            Some(Ok(Some(step))) => self.begin(step),
            Some(Err(wanted)) => self.do_without_a_plan(wanted),
        }
        self.settle();
    }

    /// Has it rest, for a reason in words, or go on. To rest, the running action is suspended if it can
    /// be, and ends if it cannot; the goal goes onto the stack as for an emergency, and is resumed from
    /// there as ever.
    pub fn pause(&mut self, now: Time, why: Option<&str>) {
        self.now = self.now.max(now);
        self.paused = why.map(str::to_owned);
        self.settle();
    }

    /// Whether it was told to rest.
    pub fn is_to_rest(&self) -> bool {
        self.paused.is_some()
    }

    /// The same without doing anything about it: before anything has come in since a restart.
    pub(crate) fn was_paused(&mut self, why: Option<&str>) {
        self.paused = why.map(str::to_owned);
    }

    /// Whether it will know more without anything coming in.
    pub(crate) fn is_planning(&self) -> bool {
        let planning = |phase: &Phase| matches!(phase, Phase::Planning);
        let running = self.running.as_ref();
        self.unsettled || running.is_some_and(|it| planning(&it.phase)) && !self.is_paused()
    }

    /// The step that is being executed.
    pub(crate) fn executing_step(&self) -> Option<&Step> {
        let execution = self.running.as_ref().and_then(super::Running::execution);
        execution.map(|execution| &execution.step)
    }

    /// Everything that a plan for the running goal depends on.
    pub(crate) fn present(&self) -> Problem {
        self.problem()
    }

    pub(super) fn wait_without_a_plan(&mut self, wanted: Vec<Fact>) {
        if let Some(running) = &mut self.running {
            running.phase = Phase::Ready(Ready::NoPlan(wanted));
        }
    }
}
