//! Algorithm 3, emergencies, and Algorithm 4, normal goals: what starts, what interrupts, what is
//! resumed.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{Agent, Execution, Goal, Intention, Phase, ResumedBy, Running, WaitsFor};
use crate::model::{Symbol, Task};
use crate::planner::{Item, Planner};
use crate::protocol::{ActionId, GoalId, GoalRequest, Happening, Instruction, Rejection, Urgency};

/// Why the running goal is not to go on at present.
enum Yield {
    /// The user has cancelled it, or its deadline has passed.
    Cancelled,
    /// A superior wants it suspended (Algorithm 5).
    Held,
    /// The user wants it set aside.
    SetAside,
    /// This one goes first (Algorithm 3).
    To(GoalId),
}

impl<P: Planner> Agent<P> {
    /// Step 1 of Algorithms 3 and 4: a user's goal.
    pub(super) fn accept(&mut self, request: GoalRequest) -> Result<GoalId, Rejection> {
        match self.consider(&request) {
            Ok(Some(known)) => Ok(known),
            Ok(None) => Ok(self.take_on(request)),
            Err(rejection) => {
                let reason = rejection.to_string();
                self.emit(request.id.as_ref(), Happening::GoalRejected { reason });
                Err(rejection)
            }
        }
    }

    /// The goal's name if it is known already, or why it is refused.
    fn consider(&self, request: &GoalRequest) -> Result<Option<GoalId>, Rejection> {
        if request.tasks.is_empty() {
            return Err(Rejection::NoTask);
        }
        for task in &request.tasks {
            self.understand(task)?;
        }
        match request
            .id
            .as_ref()
            .and_then(|id| self.tasks_of(id).map(|tasks| (id, tasks)))
        {
            None => Ok(None),
            Some((id, tasks)) if tasks == request.tasks => Ok(Some(id.clone())),
            Some((id, _)) => Err(Rejection::NameTaken(id.clone())),
        }
    }

    /// What a goal is for that is pursued, waits or has ended.
    fn tasks_of(&self, id: &GoalId) -> Option<&[Task]> {
        let ended = self.ended.iter().map(|ended| (&ended.id, &ended.tasks));
        let known = self.all_intentions().map(|i| (&i.goal.id, &i.goal.tasks));
        let mut all = known.chain(ended);
        all.find(|(known, _)| *known == id)
            .map(|(_, tasks)| tasks.as_slice())
    }

    fn take_on(&mut self, request: GoalRequest) -> GoalId {
        let number = self.next_goal;
        self.next_goal += 1;
        let id = request.id.unwrap_or_else(|| self.free_name(number));
        self.emit(
            Some(&id),
            Happening::GoalAccepted {
                tasks: request.tasks.clone(),
                urgency: request.urgency,
                priority: request.priority,
            },
        );
        self.waiting.add(Intention::new(Goal {
            id: id.clone(),
            tasks: request.tasks,
            urgency: request.urgency,
            priority: request.priority,
            deadline: request.deadline.map(|deadline| self.now + deadline),
            number,
            superior: None,
            map: self.map.clone(),
        }));
        id
    }

    /// `g` and a number, `from` that on, that no user has given to a goal.
    fn free_name(&self, from: u64) -> GoalId {
        let mut names = (from..).map(|number| GoalId::from(format!("g{number}")));
        let free = names.find(|name| self.tasks_of(name).is_none());
        // Numbers do not run out.
        free.unwrap_or_default()
    }

    /// Whether a task is one of the domain's, about objects that fit.
    fn understand(&self, task: &Task) -> Result<(), Rejection> {
        let domain = &self.configuration.domain;
        let operators = domain.operators.get(&task.name).map(|o| &o.parameters);
        let Some(parameters) = domain.tasks.get(&task.name).or(operators) else {
            // Actions without a model are those that resume or roll back others.
            let modelled = self.configuration.model.actions.keys();
            let known: BTreeSet<&Symbol> = domain.tasks.keys().chain(modelled).collect();
            let known: Vec<&str> = known.into_iter().map(Symbol::as_str).collect();
            return Err(Rejection::UnknownTask(task.name.clone(), known.join(", ")));
        };
        if parameters.len() != task.args.len() {
            return Err(Rejection::ArgumentCount {
                task: task.clone(),
                wanted: parameters.len(),
                given: task.args.len(),
            });
        }
        let problem = self.problem_of(None);
        for (object, parameter) in task.args.iter().zip(parameters) {
            match problem.kind(object) {
                None => {
                    return Err(Rejection::UnknownObject {
                        task: task.clone(),
                        object: object.clone(),
                    });
                }
                Some(given) if !domain.is_a(given, &parameter.kind) => {
                    return Err(Rejection::WrongType {
                        task: task.clone(),
                        object: object.clone(),
                        given: given.clone(),
                        wanted: parameter.kind.clone(),
                    });
                }
                Some(_) => {}
            }
        }
        Ok(())
    }

    /// A superior's `Execute`: begins at once, even above a goal that the superior holds suspended
    /// here. Read literally, the paper makes it wait for an empty stack (step 4.3), which only the
    /// superior can empty, later (decision 1).
    ///
    /// So it is of the emergencies' kind: it outranks whatever runs when it comes, and an emergency
    /// of the agent's own that comes later outranks it.
    pub(super) fn begin_instruction(&mut self, from: &Symbol, id: ActionId, task: Task) {
        let number = self.next_goal;
        self.next_goal += 1;
        let running = self.running.as_ref().map(|running| &running.intention.goal);
        let emergency = running.filter(|goal| goal.urgency == Urgency::Emergency);
        let goal = Goal {
            id: id.to_string().into(),
            tasks: vec![task],
            urgency: Urgency::Emergency,
            priority: emergency.map_or(i32::MIN, |goal| goal.priority),
            deadline: None,
            number,
            superior: Some((from.clone(), id)),
            map: Arc::clone(&self.map),
        };
        self.waiting.add(Intention::new(goal));
    }

    /// Starts or resumes the goal that goes first, if nothing runs. Returns whether it did.
    pub(super) fn start_next(&mut self) -> bool {
        if self.running.is_some() {
            return false;
        }
        let resumable = self.stack.resumable().map(|intention| &intention.goal);
        let urgent = self.waiting.most_urgent();
        let urgent = urgent.filter(|urgent| resumable.is_none_or(|top| urgent.outranks(top)));
        let normal = self.waiting.next_normal();
        let next = if let Some(urgent) = urgent {
            // Algorithm 3, step 2 or 3e; Algorithm 5.
            self.waiting.remove(&urgent.id.clone())
        } else if resumable.is_some() {
            // Algorithm 3, steps 3f and 3g.
            self.stack.pop()
        } else if self.stack.depth() == 0
            && let Some(normal) = normal
        {
            // Algorithm 4, steps 3 to 5.
            self.waiting.remove(&normal.id.clone())
        } else {
            None
        };
        let Some(mut intention) = next else {
            return false;
        };
        let resumed = std::mem::replace(&mut intention.started, true);
        let goal = intention.goal.id.clone();
        self.map = intention.goal.map.clone();
        self.running = Some(Running {
            intention,
            phase: Phase::Planning,
            resumed,
            set_aside: false,
            broken: None,
            surprised: true,
        });
        if !resumed {
            self.emit(Some(&goal), Happening::GoalStarted);
        }
        self.plan();
        true
    }

    /// Whether the running goal is not to go on; decided anew whenever something has changed, so
    /// that the most urgent of several reasons counts.
    fn reason_to_yield(&self) -> Option<Yield> {
        let running = self.running.as_ref()?;
        let goal = &running.intention.goal;
        let undoing = running
            .execution()
            .is_some_and(|execution| matches!(execution.step.item, Item::RollBack { .. }));
        if running.intention.cancelled.is_some() && !undoing && !self.is_undoing() {
            return Some(Yield::Cancelled);
        }
        if self.hold.is_some() {
            return Some(Yield::Held);
        }
        if running.set_aside {
            return Some(Yield::SetAside);
        }
        let urgent = self.waiting.most_urgent()?;
        urgent.outranks(goal).then(|| Yield::To(urgent.id.clone()))
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
            Yield::To(urgent) => {
                if let Some(running) = self.take_running() {
                    self.push(running.intention, &format!("{urgent} goes first"));
                }
            }
        }
        true
    }

    /// Step 3d.
    fn push(&mut self, intention: Intention, why: &str) {
        let goal = intention.goal.id.clone();
        let action = intention.records.last().map(|r| r.step.purpose().clone());
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
        self.planner.begin(problem, &agendas);
        let budget = self.configuration.policy.expansions_before_stopping;
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
        });
        if !resumed {
            self.emit(Some(&goal), Happening::GoalStarted);
        }
        self.tell_plan(
            "it begins with the action that is running",
            outcome.expanded,
        );
        true
    }
}
