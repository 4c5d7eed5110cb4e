//! Goals of users: what this vehicle can do itself it does, the rest it publishes.

use super::{EndedTask, Mind, Vehicle};
use crate::model::Time;
use crate::planner::Planner;
use crate::protocol::{Command, GoalId, GoalRequest, Happening, Input, Rejection, Reply, Urgency};
use crate::service::{NewTask, Outcome, TaskId};

/// So many goals that were published and are over are remembered.
const ENDED_KEPT: usize = 1000;

/// So many tasks of users are published at a time, emergencies and others together.
const MOST_PUBLISHED: usize = 64;

impl<A: Mind, P: Planner> Vehicle<A, P> {
    /// A goal of a user's. `for_any`: whoever can do it best is to do it.
    pub(super) fn goal(&mut self, request: GoalRequest, for_any: bool) -> Reply {
        if let Some(known) = self.known(&request) {
            return Reply::Goal(known);
        }
        let published = match request.tasks.as_slice() {
            [task] if for_any || !self.can_do(task) => Some(task.clone()),
            // What belongs together is not torn apart.
            _ => None,
        };
        let fits = published.is_some_and(|task| {
            let domain = &self.domain;
            let declared = domain.tasks.get(&task.name);
            let operators = domain.operators.get(&task.name).map(|it| &it.parameters);
            let problem = self.problem();
            declared.or(operators).is_some_and(|parameters| {
                parameters.len() == task.args.len()
                    && task.args.iter().zip(parameters).all(|(object, parameter)| {
                        let kind = problem.kind(object);
                        kind.is_some_and(|kind| domain.is_a(kind, &parameter.kind))
                    })
            })
        });
        if !fits {
            // The agent says what is wrong with it, if anything is.
            let reply = self.mind.handle(self.now, Input::Goal(request));
            return reply.unwrap_or(Reply::Goal(Err(Rejection::NoTask)));
        }
        Reply::Goal(self.publish_for_user(request))
    }

    /// A goal that is known already.
    fn known(&self, request: &GoalRequest) -> Option<Result<GoalId, Rejection>> {
        let id = request.id.as_ref()?;
        let published = self.tasks.published().get(id);
        let published = published.filter(|_| self.for_users.contains(id));
        let ended = self.ended.iter().rev().find(|ended| ended.id == *id);
        let what = published
            .map(|task| &task.new.what)
            .or(ended.map(|ended| &ended.what))?;
        Some(match request.tasks.as_slice() {
            [task] if task == what => Ok(id.clone()),
            _ => Err(Rejection::NameTaken(id.clone())),
        })
    }

    fn publish_for_user(&mut self, request: GoalRequest) -> Result<GoalId, Rejection> {
        if self.for_users.len() >= MOST_PUBLISHED {
            return Err(Rejection::TooManyWaiting {
                kind: "goals".into(),
                waiting: self.for_users.len(),
                most: MOST_PUBLISHED,
            });
        }
        let Some(what) = request.tasks.first().cloned() else {
            return Err(Rejection::NoTask);
        };
        if let Some(id) = &request.id
            && (self.tasks.published().contains_key(id) || self.mind.pursues(id))
        {
            return Err(Rejection::NameTaken(id.clone()));
        }
        let new = NewTask {
            what,
            urgency: request.urgency,
            priority: request.priority,
            deadline: request.deadline.map(|deadline| self.now + deadline),
        };
        let accepted = Happening::GoalAccepted {
            tasks: request.tasks,
            urgency: request.urgency,
            priority: request.priority,
        };
        let id = request.id.unwrap_or_else(|| self.tasks.free_name());
        self.emit(Some(id.clone()), accepted);
        self.for_users.insert(id.clone());
        self.publish(Some(id.clone()), new);
        Ok(id)
    }

    /// Publishes a task, which is told to people unless it is published already.
    pub(super) fn publish(&mut self, id: Option<TaskId>, new: NewTask) {
        let is_new = id
            .as_ref()
            .is_none_or(|id| !self.tasks.published().contains_key(id));
        let (what, urgency) = (new.what.clone(), new.urgency);
        let id = self.tasks.publish(id, new);
        if is_new {
            self.emit(Some(id), Happening::TaskOffered { what, urgency });
        }
    }

    /// A user's wish about a goal.
    pub(super) fn command(&mut self, command: Command) -> Reply {
        let (Command::Suspend(goal) | Command::Resume(goal) | Command::Cancel(goal)) = &command;
        if !self.for_users.contains(goal) {
            let reply = self.mind.handle(self.now, Input::Command(command));
            return reply.unwrap_or(Reply::Command(Ok(())));
        }
        let goal = goal.clone();
        if matches!(command, Command::Cancel(_)) {
            let reason = "the user has cancelled it".to_owned();
            self.tasks.withdraw(&goal, Some(reason));
            return Reply::Command(Ok(()));
        }
        let why = "was given to the team; it can only be cancelled".to_owned();
        Reply::Command(Err(Rejection::NotNow { goal, why }))
    }

    /// A task of ours is over.
    pub(super) fn task_ended(&mut self, id: TaskId, what: crate::model::Task, outcome: Outcome) {
        let (by, failure) = match &outcome {
            Outcome::Done { by } => (by.clone(), None),
            Outcome::Failed { reason } | Outcome::Unknown { reason } => {
                (None, Some(reason.clone()))
            }
        };
        let ended = Happening::TaskEnded {
            what: what.clone(),
            by,
            failure,
        };
        self.emit(Some(id.clone()), ended);
        if !self.for_users.remove(&id) {
            return;
        }
        let happening = match outcome.clone() {
            Outcome::Done { .. } => Happening::GoalSucceeded,
            Outcome::Failed { reason } => Happening::GoalFailed { reason },
            Outcome::Unknown { reason } => Happening::GoalUnknown { reason },
        };
        self.emit(Some(id.clone()), happening);
        let at: Time = self.now;
        self.ended.push_back(EndedTask {
            id,
            what,
            outcome,
            at,
        });
        while self.ended.len() > ENDED_KEPT {
            self.ended.pop_front();
        }
    }

    /// The goal that a task given to us is in the agent.
    pub(super) fn goal_for(
        &mut self,
        id: GoalId,
        what: crate::model::Task,
        urgency: Urgency,
        priority: i32,
    ) -> Result<(), String> {
        let request = GoalRequest {
            id: Some(id),
            tasks: vec![what],
            urgency,
            priority,
            deadline: None,
        };
        match self.mind.handle(self.now, Input::Goal(request)) {
            Some(Reply::Goal(Err(rejection))) => Err(rejection.to_string()),
            _ => Ok(()),
        }
    }
}
