//! Step 1 of Algorithms 3 and 4: goals as users give them.

use std::collections::BTreeSet;

use super::{Agent, Goal, Intention};
use crate::model::{Symbol, Task};
use crate::planner::Planner;
use crate::protocol::{GoalId, GoalRequest, Happening, Rejection, Urgency};

impl<P: Planner> Agent<P> {
    /// Step 1 of Algorithms 3 and 4: a user's goal.
    pub(super) fn accept(&mut self, request: GoalRequest) -> Result<GoalId, Rejection> {
        self.accept_beside(request, 0)
    }

    /// The same, if so many goals of that urgency wait elsewhere that count as this agent's.
    pub(super) fn accept_beside(
        &mut self,
        request: GoalRequest,
        elsewhere: usize,
    ) -> Result<GoalId, Rejection> {
        match self.consider(&request, elsewhere) {
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
    pub(super) fn consider(
        &self,
        request: &GoalRequest,
        elsewhere: usize,
    ) -> Result<Option<GoalId>, Rejection> {
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
            None => self.room_for(request.urgency, elsewhere).map(|()| None),
            Some((id, tasks)) if tasks == request.tasks => Ok(Some(id.clone())),
            Some((id, _)) => Err(Rejection::NameTaken(id.clone())),
        }
    }

    /// Whether one more goal of this urgency may wait. What superiors ask for is bounded by them.
    fn room_for(&self, urgency: Urgency, elsewhere: usize) -> Result<(), Rejection> {
        let waiting = self.waiting_of(urgency) + elsewhere;
        let most = self.configuration.policy.most_waiting;
        if waiting < most {
            return Ok(());
        }
        let kind = match urgency {
            Urgency::Normal => "goals",
            Urgency::Emergency => "emergencies",
        };
        Err(Rejection::TooManyWaiting {
            kind: kind.into(),
            waiting,
            most,
        })
    }

    /// How many goals of users of that urgency are not pursued.
    pub(crate) fn waiting_of(&self, urgency: Urgency) -> usize {
        let running = self.running.iter().map(|running| &running.intention);
        let of_kind = |intention: &&Intention| {
            intention.goal.superior.is_none() && intention.goal.urgency == urgency
        };
        let all = self.all_intentions().filter(of_kind).count();
        all - running.filter(of_kind).count()
    }

    /// What a goal is for that is pursued, waits or has ended.
    pub(crate) fn tasks_of(&self, id: &GoalId) -> Option<&[Task]> {
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
}
