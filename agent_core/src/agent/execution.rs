//! Algorithm 2: planning and plan execution.

use super::leave::Ready;
use super::{Agent, Execution, Phase, Repair, Running};
use crate::model::{FactChange, Symbol, Time};
use crate::planner::{self, Item, Planner, Step};
use crate::protocol::{ActionId, Answer, Happening, Instruction, Output, Report};

impl Running {
    /// When the running action has taken too long.
    pub(super) fn due(&self) -> Option<Time> {
        match &self.phase {
            Phase::Executing(execution) => execution.due,
            Phase::Planning | Phase::Ready(_) | Phase::Stopping(_) => None,
        }
    }

    pub(super) fn execution(&self) -> Option<&Execution> {
        match &self.phase {
            Phase::Planning | Phase::Ready(_) => None,
            Phase::Executing(execution) | Phase::Stopping(execution) => Some(execution),
        }
    }
}

impl<P: Planner> Agent<P> {
    /// Step 7a: tells the executor to execute the next action of the selected plan.
    pub(super) fn execute_next(&mut self) {
        let Some(running) = &mut self.running else {
            return;
        };
        let Some(plan) = running.intention.plans.first() else {
            return self.plan();
        };
        let Some(step) = plan.steps.first().cloned() else {
            return if plan.rest.is_empty() {
                self.succeed()
            } else {
                self.plan()
            };
        };
        if self.configuration.policy.asks_leave {
            running.phase = Phase::Ready(Ready::Step);
            return;
        }
        self.begin(step);
    }

    /// The same, once it is known that this is the action.
    pub(super) fn begin(&mut self, step: Step) {
        let Some(running) = &mut self.running else {
            return;
        };
        running.intention.failed = None;
        let goal = running.intention.goal.id.clone();
        let map = self.map_for(&step);
        let (id, executor) = match &step.item {
            Item::Resume { id, .. } => {
                let Some(running) = &mut self.running else {
                    return;
                };
                // The record is used up; plans may go on to name it while the action runs.
                let records = &mut running.intention.records;
                let Some(place) = records.iter().position(|record| record.id == *id) else {
                    // `forget` removes such plans, so this does not come about; plan again.
                    running.intention.forget(id);
                    return self.plan();
                };
                let executor = records.remove(place).executor;
                let action = step.action().clone();
                self.emit(
                    Some(&goal),
                    Happening::ActionResumed {
                        id: id.clone(),
                        action,
                    },
                );
                self.instruct(
                    &executor,
                    Instruction::Resume {
                        id: id.clone(),
                        map,
                    },
                );
                (id.clone(), executor)
            }
            Item::Task(action) | Item::RollBack { action, .. } => {
                let executor = self.executor_for(&step);
                if let Item::RollBack { id, .. } = &step.item {
                    self.clear(id);
                }
                let id = ActionId {
                    agent: self.configuration.name.clone(),
                    epoch: self.configuration.epoch,
                    number: self.next_action,
                };
                self.next_action += 1;
                self.emit(
                    Some(&goal),
                    Happening::ActionStarted {
                        id: id.clone(),
                        action: action.clone(),
                    },
                );
                self.instruct(
                    &executor,
                    Instruction::Execute {
                        id: id.clone(),
                        action: action.clone(),
                        map,
                    },
                );
                (id, executor)
            }
        };
        self.last_executor = executor.clone();
        let due = self.due(&executor, &step);
        if let Some(running) = &mut self.running {
            running.surprised = false;
            running.phase = Phase::Executing(Execution {
                id,
                executor,
                step,
                due,
                done: None,
            });
        }
    }

    /// When an action that begins now has taken too long; `None` if it may take any time, as it may
    /// while its executor is gone.
    pub(super) fn due(&self, executor: &Symbol, step: &Step) -> Option<Time> {
        if !self.neighbours.has(executor) {
            return None;
        }
        let model = self.configuration.model.actions.get(&step.purpose().name)?;
        let seconds =
            planner::number_of(&self.problem(), model.timeout_s.as_ref()?, step.purpose())?;
        Some(self.now + Time::from_secs(seconds))
    }

    /// Steps 7b and 7c: a report about an execution.
    pub(super) fn reported(&mut self, id: &ActionId, report: Report) {
        let execution = self.running.as_ref().and_then(Running::execution);
        // Whatever is not about the running action is old: repeated, or overtaken by an answer
        // that carried the outcome.
        let Some(execution) = execution.filter(|execution| execution.id == *id).cloned() else {
            return;
        };
        match report {
            Report::Started | Report::Progress { .. } => {}
            Report::Success { facts } => self.said_to_be_done(execution, &facts),
            Report::Failure {
                reason,
                facts,
                blocked_by,
            } => {
                if let Some(running) = &mut self.running {
                    running.intention.blocked_by.extend(blocked_by);
                }
                self.fails(execution, reason, &facts, None);
            }
            Report::Unknown { reason, facts } => self.uncertain(execution, &reason, &facts),
            Report::Suspended { facts } => self.suspended(execution, &facts),
        }
    }

    /// What an executor answered to an instruction.
    pub(super) fn answered(&mut self, to: &Instruction, answer: Answer) {
        match (to, answer) {
            // A record that is gone is gone, whatever became of it.
            (Instruction::Clear { .. }, _) => {}
            (_, Answer::Accepted | Answer::Suspending | Answer::Refused { .. }) => {}
            (_, Answer::Finished { outcome }) => self.reported(to.id(), outcome),
            (_, Answer::Rejected { reason }) => {
                let facts = Vec::new();
                let blocked_by = Vec::new();
                let report = Report::Failure {
                    reason,
                    facts,
                    blocked_by,
                };
                self.reported(to.id(), report);
            }
        }
    }

    /// Step 7b after a success: deletes the executed action from all plans.
    pub(super) fn succeeded(&mut self, execution: Execution, facts: &[FactChange]) {
        let step = execution.step;
        let predicted = planner::effect_of(&self.problem(), step.action());
        let mut changes = self.learn(&predicted);
        let facts = self.known(facts);
        let surprises = self.learn(&facts);
        let surprised = !surprises.is_empty();
        changes.extend(surprises);
        let model = self.configuration.model.actions.get(&step.purpose().name);
        let repeatable = model.is_none_or(|model| model.repeatable);
        let achieves_state = model.is_some_and(|model| model.achieves_state);
        if let Some(running) = &mut self.running {
            running.phase = Phase::Planning;
            running.surprised |= surprised;
            running.intention.after(&step, repeatable);
            let plans = &mut running.intention.plans;
            plans.retain_mut(|plan| planner::advance(plan, step.purpose()));
        }
        if achieves_state {
            self.each_other_intention(|other| other.done_by_another(step.purpose()));
        }
        let goal = self.running_goal();
        let (id, action) = (execution.id, step.action().clone());
        let what = match step.item {
            Item::RollBack { .. } => Happening::ActionRolledBack { id, action },
            Item::Task(_) | Item::Resume { .. } => Happening::ActionFinished {
                id,
                action,
                failure: None,
            },
        };
        self.emit(goal.as_ref(), what);
        self.believed(changes);
        self.conclude();
    }

    /// Step 7b after a failure: the action is still to be done, and the facts say why it was not.
    ///
    /// `undo`: what undoes it, if it was stopped halfway and is not to be resumed.
    pub(super) fn failed(
        &mut self,
        execution: Execution,
        reason: String,
        facts: &[FactChange],
        undo: Option<Item>,
    ) {
        if let Some(running) = &mut self.running {
            let purpose = execution.step.purpose().clone();
            if self.configuration.policy.repair == Repair::Nearest {
                running.intention.failed = Some((purpose.clone(), false));
            }
            let failures = running.intention.failures.entry(purpose).or_default();
            *failures = failures.saturating_add(1);
        }
        self.not_done(execution, reason, facts, undo);
    }

    /// The action counts as failed, and what it was for is so all the same: it goes on behind it.
    pub(super) fn achieved_otherwise(
        &mut self,
        execution: Execution,
        reason: String,
        facts: &[FactChange],
    ) {
        let step = execution.step;
        let facts = self.known(facts);
        let changes = self.learn(&facts);
        let model = self.configuration.model.actions.get(&step.purpose().name);
        let repeatable = model.is_none_or(|model| model.repeatable);
        if let Some(running) = &mut self.running {
            running.phase = Phase::Planning;
            running.surprised = true;
            let intention = &mut running.intention;
            intention.last_failure = Some(format!("{} failed: {reason}", step.action()));
            intention.forget(&execution.id);
            intention.after(&step, repeatable);
            let plans = &mut intention.plans;
            plans.retain_mut(|plan| planner::advance(plan, step.purpose()));
        }
        let goal = self.running_goal();
        let what = Happening::ActionFinished {
            id: execution.id,
            action: step.action().clone(),
            failure: Some(reason),
        };
        self.emit(goal.as_ref(), what);
        self.believed(changes);
        self.conclude();
    }

    /// The same, if the action is not to blame.
    pub(super) fn ended_otherwise(
        &mut self,
        execution: Execution,
        reason: String,
        facts: &[FactChange],
    ) {
        self.not_done(execution, reason, facts, None);
    }

    fn not_done(
        &mut self,
        execution: Execution,
        reason: String,
        facts: &[FactChange],
        undo: Option<Item>,
    ) {
        let step = execution.step;
        let facts = self.known(facts);
        let changes = self.learn(&facts);
        if let Some(running) = &mut self.running {
            running.phase = Phase::Planning;
            running.surprised = true;
            let intention = &mut running.intention;
            intention.last_failure = Some(format!("{} failed: {reason}", step.action()));
            intention.around(&step, None, None);
            intention.forget(&execution.id);
            if undo.is_some() {
                intention.around(&step, None, undo);
            }
        }
        let goal = self.running_goal();
        self.emit(
            goal.as_ref(),
            Happening::ActionFinished {
                id: execution.id,
                action: step.action().clone(),
                failure: Some(reason),
            },
        );
        self.believed(changes);
        self.conclude();
    }

    /// An action has ended or was suspended: is the goal over (7d), is it to be set aside, or does
    /// it go on (7f)?
    pub(super) fn conclude(&mut self) {
        let Some(running) = &mut self.running else {
            return;
        };
        running.broken = None;
        if running.intention.is_over() {
            return self.succeed();
        }
        if self.yields_now() {
            return;
        }
        let problem = self.problem();
        let Some(running) = &self.running else {
            return;
        };
        let goes_on = !running.surprised
            && running.intention.plans.first().is_some_and(|plan| {
                !plan.steps.is_empty() && planner::simulate(&problem, &plan.steps, false).is_ok()
            });
        if goes_on {
            self.execute_next();
        } else {
            self.plan();
        }
    }

    /// Steps 7d and 8: the goal is reached, or what was half done of a cancelled one is undone.
    pub(super) fn succeed(&mut self) {
        if let Some(reason) = self
            .running
            .as_ref()
            .and_then(|r| r.intention.cancelled.clone())
        {
            return self.give_up(&reason, Vec::new());
        }
        let Some(running) = self.take_running() else {
            return;
        };
        let facts = self.tell_superiors();
        self.emit(Some(&running.intention.goal.id), Happening::GoalSucceeded);
        self.end(running, Report::Success { facts });
    }

    /// Steps 7e and 8: the goal is given up.
    pub(super) fn give_up(&mut self, reason: &str, blocked_by: Vec<crate::model::Fact>) {
        let Some(running) = self.take_running() else {
            return;
        };
        let facts = self.tell_superiors();
        self.emit(
            Some(&running.intention.goal.id),
            Happening::GoalFailed {
                reason: reason.to_owned(),
            },
        );
        let outcome = Report::Failure {
            reason: reason.to_owned(),
            facts,
            blocked_by,
        };
        self.end(running, outcome);
    }

    pub(super) fn take_running(&mut self) -> Option<Running> {
        self.planner.stop();
        self.running.take()
    }

    pub(super) fn end(&mut self, running: Running, outcome: Report) {
        let intention = running.intention;
        self.clear_all(&intention);
        self.remember(&intention, outcome.clone());
        if intention.orphaned {
            return;
        }
        if let Some((superior, id)) = intention.goal.superior {
            if self.hold.as_ref() == Some(&(superior.clone(), id.clone())) {
                self.hold = None;
            }
            self.outputs.push_back(Output::Report {
                to: superior,
                id,
                report: outcome,
            });
        }
    }

    pub(super) fn running_goal(&self) -> Option<crate::protocol::GoalId> {
        self.running
            .as_ref()
            .map(|running| running.intention.goal.id.clone())
    }
}
