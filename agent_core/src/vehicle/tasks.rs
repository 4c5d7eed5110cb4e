//! What the task service wants done, and what becomes of the tasks that others have given us.

use super::{Mind, Vehicle};
use crate::model::Symbol;
use crate::planner::Planner;
use crate::protocol::{
    ActionId, Answer, Command, GoalId, Happening, Input, Instruction, Output, Reply, Report,
};
use crate::service::TaskOutput;

impl<A: Mind, P: Planner> Vehicle<A, P> {
    /// Does what the task service wants done. Returns whether that was anything.
    pub(super) fn serve_tasks(&mut self) -> bool {
        let mut any = false;
        while let Some(output) = self.tasks.poll_output() {
            any = true;
            match output {
                TaskOutput::Say(message) => self.outputs.push_back(Output::Local(message)),
                TaskOutput::Assess(offer) => self.assessments.add(offer),
                TaskOutput::Give {
                    to,
                    id,
                    what,
                    urgency,
                    priority,
                } => {
                    let task = self.tasks.task_of_execution(&id).cloned();
                    let given = Happening::TaskGiven {
                        what: what.clone(),
                        to: to.clone(),
                    };
                    self.emit(task, given);
                    if to == self.name {
                        let goal = goal_of(&id);
                        if let Err(reason) = self.goal_for(goal, what, urgency, priority) {
                            self.end_execution(&id, failure(reason));
                        }
                    } else {
                        let instruction = Instruction::Execute {
                            id,
                            action: what,
                            map: None,
                        };
                        self.outputs.push_back(Output::Instruct { to, instruction });
                    }
                }
                TaskOutput::TakeBack { from, id } if from == self.name => {
                    self.cancel(&id, "it is not to be done any more");
                }
                TaskOutput::TakeBack { from: to, id } => {
                    let instruction = Instruction::Clear { id };
                    self.outputs.push_back(Output::Instruct { to, instruction });
                }
                TaskOutput::GiveUp { id, reason, .. } => self.cancel(&id, &reason),
                TaskOutput::Ended {
                    task,
                    what,
                    outcome,
                } => self.task_ended(task, what, outcome),
            }
        }
        any
    }

    /// From another vehicle.
    pub(super) fn instructed(&mut self, from: &Symbol, instruction: Instruction) -> Answer {
        let id = instruction.id();
        if id.agent != *from {
            let reason = format!("{id} is not for {from} to give or to take back");
            return Answer::Rejected { reason };
        }
        match instruction {
            Instruction::Execute { id, .. } => {
                // What was bid for is what is done.
                let taken = match self.tasks.take(self.now, &id) {
                    Ok(taken) => taken.clone(),
                    Err(unwilling) => {
                        let reason = unwilling.to_string();
                        return Answer::Rejected { reason };
                    }
                };
                let goal = goal_of(&id);
                if self.mind.pursues(&goal) {
                    return Answer::Accepted;
                }
                match self.goal_for(goal, taken.what, taken.urgency, taken.priority) {
                    Ok(()) => {
                        let (to, report) = (from.clone(), Report::Started);
                        self.outputs.push_back(Output::Report { to, id, report });
                        Answer::Accepted
                    }
                    Err(reason) => {
                        self.tasks.let_go(&id);
                        Answer::Rejected { reason }
                    }
                }
            }
            Instruction::Clear { id } => {
                if self.tasks.taken().contains_key(&id) {
                    self.cancel(&id, &format!("{from} does not want it done any more"));
                }
                Answer::Accepted
            }
            Instruction::Suspend { .. } | Instruction::Resume { .. } => Answer::Rejected {
                reason: "a vehicle decides itself when to do a task; it can be taken back"
                    .to_owned(),
            },
        }
    }

    /// Ends the work on an execution, which is rolled back where the domain says how. What comes of it is
    /// reported when it stands still.
    pub(super) fn cancel(&mut self, id: &ActionId, reason: &str) {
        let goal = goal_of(id);
        if self.mind.pursues(&goal) {
            // It may be ending already.
            let _ = self
                .mind
                .handle(self.now, Input::Command(Command::Cancel(goal)));
        } else {
            self.end_execution(id, failure(reason.to_owned()));
        }
    }

    /// A goal of the agent's has ended: if it is a task that was given to us, whoever has given it is told.
    pub(super) fn goal_ended(&mut self, goal: &GoalId, happening: &Happening) {
        let report = match happening {
            Happening::GoalSucceeded => Report::Success { facts: Vec::new() },
            Happening::GoalFailed { reason } => failure(reason.clone()),
            Happening::GoalUnknown { reason } => Report::Unknown {
                reason: reason.clone(),
                facts: Vec::new(),
            },
            _ => return,
        };
        let taken = self.tasks.taken().keys();
        let id = taken.into_iter().find(|id| goal_of(id) == *goal).cloned();
        if let Some(id) = id {
            self.end_execution(&id, report);
        }
    }

    fn end_execution(&mut self, id: &ActionId, mut report: Report) {
        let Some(taken) = self.tasks.taken().get(id) else {
            return;
        };
        if taken.given_up && matches!(report, Report::Failure { .. }) {
            let facts = Vec::new();
            report = Report::Suspended { facts };
        }
        let to = taken.publisher.clone();
        self.tasks.let_go(id);
        if to == self.name {
            self.tasks.reported(id, &report);
        } else {
            let id = id.clone();
            self.outputs.push_back(Output::Report { to, id, report });
        }
    }

    /// What another vehicle has answered to an instruction of ours. `false`: it is none of a task's.
    pub(super) fn task_answered(&mut self, to: &Instruction, answer: &Answer) -> bool {
        let is_task = self.tasks.is_own(to.id());
        if is_task && matches!(to, Instruction::Execute { .. }) {
            self.tasks.answered(to.id(), answer);
        }
        is_task
    }

    /// Gives the agent an input, and sees to what it says.
    pub(super) fn tell_mind(&mut self, input: Input<std::convert::Infallible>) -> Option<Reply> {
        let reply = self.mind.handle(self.now, input);
        self.listen_to_mind();
        reply
    }

    /// Takes all that the agent says. Returns whether that was anything.
    pub(super) fn listen_to_mind(&mut self) -> bool {
        let mut any = false;
        while let Some(output) = self.mind.poll_output() {
            any = true;
            match output {
                Output::Event(event) => {
                    if let Some(goal) = event.goal.clone() {
                        self.goal_ended(&goal, &event.what);
                    }
                    if let Happening::BeliefChanged { changes } = &event.what {
                        if !self.learning {
                            self.states.sensed(self.now, changes);
                        }
                        self.believes_otherwise = true;
                    }
                    self.outputs.push_back(Output::Event(event));
                }
                Output::Instruct { to, instruction } => {
                    self.outputs.push_back(Output::Instruct { to, instruction });
                }
                Output::Report { to, id, report } => {
                    self.outputs.push_back(Output::Report { to, id, report });
                }
                Output::Observed { facts, reported_to } if !facts.is_empty() => {
                    self.outputs
                        .push_back(Output::Observed { facts, reported_to });
                }
                Output::Observed { .. } | Output::Seen { .. } => {}
                Output::Local(never) => match never {},
            }
        }
        any
    }
}

/// The goal of the agent's that an execution is.
pub(super) fn goal_of(id: &ActionId) -> GoalId {
    id.to_string().into()
}

fn failure(reason: String) -> Report {
    Report::Failure {
        reason,
        facts: Vec::new(),
        blocked_by: Vec::new(),
    }
}
