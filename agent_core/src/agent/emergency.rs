//! Algorithm 3: emergency goal handling. What interrupts, and what is set aside for it.

use super::{Agent, Execution, Intention, Phase, ResumedBy, Running, WaitsFor};
use crate::planner::{Item, Planner, may_begin_with};
use crate::protocol::{GoalId, Happening, Instruction};

/// A plan takes at least about so many expansions for each of its actions, alternatives included.
const EXPANSIONS_AN_ACTION: u64 = 8;

/// Why the running goal is not to go on at present.
enum Yield {
    /// The user has cancelled it, or its deadline has passed.
    Cancelled,
    /// A superior wants it suspended (Algorithm 5).
    Held,
    /// The user wants it set aside.
    SetAside,
    /// Nothing is to run here at present ([`Agent::pause`]).
    Paused(String),
    /// A superior is gone: nothing is started before it is back.
    Alone,
    /// This one goes first (Algorithm 3).
    To(GoalId),
}

impl<P: Planner> Agent<P> {
    /// Whether the running goal is not to go on.
    pub(super) fn is_to_yield(&self) -> bool {
        self.reason_to_yield().is_some()
    }

    /// Whether the running goal is not to go on; decided anew whenever something has changed, so
    /// that the most urgent of several reasons counts.
    fn reason_to_yield(&self) -> Option<Yield> {
        let running = self.running.as_ref()?;
        let goal = &running.intention.goal;
        let undoing = running
            .execution()
            .is_some_and(|execution| matches!(execution.step.item, Item::RollBack { .. }));
        let undone = running.intention.orphaned || !undoing && !self.is_undoing();
        if running.intention.cancelled.is_some() && undone {
            return Some(Yield::Cancelled);
        }
        if self.hold.is_some() {
            return Some(Yield::Held);
        }
        if running.set_aside {
            return Some(Yield::SetAside);
        }
        if let Some(why) = &self.paused {
            return Some(Yield::Paused(why.clone()));
        }
        if self.holds() {
            return Some(Yield::Alone);
        }
        let urgent = self.waiting.most_urgent()?;
        urgent.outranks(goal).then(|| Yield::To(urgent.id.clone()))
    }

    /// Whether the running goal is to end or to make room, and not only to rest.
    pub(super) fn gives_way(&self) -> bool {
        !matches!(self.reason_to_yield(), None | Some(Yield::Alone))
    }

    /// Sets the running goal aside if it is not to go on and no action runs for it (steps 3c and
    /// 3d). Returns whether it did.
    pub(super) fn yields_now(&mut self) -> bool {
        let Some(reason) = self.reason_to_yield() else {
            return false;
        };
        match reason {
            Yield::Cancelled => self.roll_back_or_give_up(),
            Yield::Held => self.push_held(),
            Yield::SetAside => {
                if let Some(running) = self.take_running() {
                    self.tell_suspended(&running.intention, "the user wants it set aside");
                    self.aside.add(running.intention, WaitsFor::User);
                }
            }
            Yield::Paused(why) => {
                if let Some(running) = self.take_running() {
                    self.push(running.intention, &why);
                }
            }
            // It stays where it is, and is planned for when the superior is back.
            Yield::Alone => self.planner.stop(),
            Yield::To(urgent) => {
                if let Some(running) = self.take_running() {
                    self.push(running.intention, &format!("{urgent} goes first"));
                }
            }
        }
        true
    }

    /// Whether the running goal has come to rest because a superior is gone.
    pub(super) fn is_paused(&self) -> bool {
        matches!(self.reason_to_yield(), Some(Yield::Alone))
    }

    /// Step 3d.
    fn push(&mut self, intention: Intention, why: &str) {
        let goal = intention.goal.id.clone();
        let action = intention.records.last().map(|r| r.step.purpose().clone());
        self.planner.keep(&intention.goal.id, &intention.agendas);
        self.stack.push(intention, ResumedBy::Agent);
        let why = why.to_owned();
        self.emit(Some(&goal), Happening::GoalSuspended { why, action });
    }

    pub(super) fn tell_suspended(&mut self, intention: &Intention, why: &str) {
        let action = intention.records.last().map(|r| r.step.purpose().clone());
        let why = why.to_owned();
        let what = Happening::GoalSuspended { why, action };
        self.emit(Some(&intention.goal.id), what);
    }

    /// Step 3b: asks the executor to suspend the running action, if there is a reason to, it can
    /// be suspended, and it does not serve what goes first.
    pub(super) fn stop_if_due(&mut self) {
        let reason = self.reason_to_yield();
        let broken = self.running.as_ref().is_some_and(|r| r.broken.is_some());
        if reason.is_none() && !broken {
            return;
        }
        if let Some(Yield::To(urgent)) = &reason
            && self.configuration.policy.keep_what_helps
            && self.hand_over(urgent)
        {
            return;
        }
        let Some(running) = &mut self.running else {
            return;
        };
        let Phase::Executing(execution) = &running.phase else {
            return;
        };
        let execution = execution.clone();
        running.phase = Phase::Stopping(execution.clone());
        let model = self
            .configuration
            .model
            .actions
            .get(&execution.step.purpose().name);
        let undoing = matches!(execution.step.item, Item::RollBack { .. });
        if !undoing && model.is_some_and(|model| model.suspension.is_some()) {
            let id = execution.id;
            self.instruct(&execution.executor, Instruction::Suspend { id });
        }
    }

    /// Decision 8: if the emergency's best plan begins with the action that runs, and that is
    /// found out within the budget, the action goes on and belongs to the emergency; the
    /// interrupted goal is pushed without an action.
    fn hand_over(&mut self, urgent: &GoalId) -> bool {
        let Some(intention) = self
            .waiting
            .intentions()
            .iter()
            .find(|i| i.goal.id == *urgent)
        else {
            return false;
        };
        let Some(execution) = self.running.as_ref().and_then(Running::execution).cloned() else {
            return false;
        };
        let running_action = execution.step.purpose().clone();
        if intention.goal.superior.is_some()
            || matches!(execution.step.item, Item::RollBack { .. })
            || intention
                .records
                .iter()
                .any(|record| record.id != execution.id)
        {
            return false;
        }
        let (problem, agendas) = (self.problem_of(Some(intention)), intention.agendas.clone());
        let budget = self.configuration.policy.expansions_before_stopping;
        let most = budget / EXPANSIONS_AN_ACTION;
        // The robot drives on while this is found out, so not even the planner is asked in vain.
        let may = agendas
            .iter()
            .any(|agenda| may_begin_with(&problem, &agenda.tasks, &running_action, most));
        if !may {
            return false;
        }
        self.planner.begin(problem, &agendas);
        let outcome = self.planner.think(budget);
        self.planner.stop();
        let Some(outcome) = outcome else {
            return false;
        };
        let helps = |first: &crate::planner::Step| {
            matches!(first.item, Item::Task(_)) && *first.purpose() == running_action
        };
        let best = outcome.plans.first().and_then(|plan| plan.steps.first());
        let Some(first) = best.filter(|first| helps(first)).cloned() else {
            return false;
        };
        let Some(mut emergency) = self.waiting.remove(urgent) else {
            return false;
        };
        let Some(mut interrupted) = self.take_running() else {
            return false;
        };
        interrupted.intention.hand_over(&execution.step);
        let why = format!("{urgent} goes first; {running_action} serves it too and goes on");
        // The plans stay as they are, with the running action at their head: once it is done,
        // they go on behind it.
        self.push(interrupted.intention, &why);
        let resumed = std::mem::replace(&mut emergency.started, true);
        let goal = emergency.goal.id.clone();
        emergency.plans = outcome.plans;
        emergency.fits = true;
        self.map = emergency.goal.map.clone();
        self.running = Some(Running {
            intention: emergency,
            phase: Phase::Executing(Execution {
                step: first,
                ..execution
            }),
            resumed: false,
            set_aside: false,
            broken: None,
            surprised: false,
            stage: Default::default(),
        });
        if !resumed {
            self.emit(Some(&goal), Happening::GoalStarted);
        }
        self.tell_plan(
            "it begins with the action that is running",
            outcome.expanded_for_best,
        );
        true
    }
}
