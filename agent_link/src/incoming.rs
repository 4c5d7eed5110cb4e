//! What has come in, as an input of the machine; and the machine's reply, as an answer.

use std::sync::Arc;

use agent_core::protocol::{GoalRequest, Input, Reply, Urgency};
use serde_json::Value;
use zenoh::bytes::ZBytes;

use crate::channel::Received;
use crate::facts::Reading;
use crate::link::Link;
use crate::mailbox::{Arrival, Asked};
use crate::question::{Question, bounded};
use crate::wire::{
    self, AGENT_LIMIT_BYTES, Answer, CommandVerdict, FactsVerdict, Instruction, Observed,
    ReportBody, USER_LIMIT_BYTES, Verdict, WireError,
};

/// Who waits for the reply to an input.
#[derive(Debug)]
pub(crate) enum ReplyTo {
    Nobody,
    Superior(Received),
    Executor(Received),
    Elsewhere(Received),
    /// Without a question, the verdict is published.
    User(GoalRequest, Option<Question>),
    Commander(Question),
}

impl Link {
    /// What an arrival is to the machine. `None`: it was seen to here.
    pub(crate) fn read<L>(
        &mut self,
        arrival: Arrival,
        local: fn(Value) -> Result<L, WireError>,
    ) -> Option<(Input<L>, ReplyTo)> {
        match arrival {
            Arrival::Instruction(question) => self.read_instruction(question),
            Arrival::Report(question) => {
                let (body, received) = self.reports.open_as("report", question, |body| {
                    wire::body::<ReportBody>("report", body)
                })?;
                let (id, report) = (body.id.0, body.report.into());
                Some((Input::Report { id, report }, ReplyTo::Executor(received)))
            }
            Arrival::Local(question) => {
                let (body, received) = self.local.open_as("message", question, local)?;
                Some((Input::Local(body), ReplyTo::Elsewhere(received)))
            }
            Arrival::Answered(instruction, answer) => {
                let to = instruction;
                Some((Input::Answer { to, answer }, ReplyTo::Nobody))
            }
            Arrival::Goal(urgency, sender, asked) => {
                self.read_goal(urgency, sender.as_deref(), asked)
            }
            Arrival::Command(question) => {
                let command = question
                    .content("command", USER_LIMIT_BYTES)
                    .and_then(|bytes| wire::command_from_user(&bytes));
                match command {
                    Ok(command) => Some((Input::Command(command), ReplyTo::Commander(question))),
                    Err(error) => {
                        question.answer(wire::write(&CommandVerdict::new(&Err(error))));
                        None
                    }
                }
            }
            Arrival::Facts(asked) => read_facts(asked),
            Arrival::Observed(executor, payload) => self.read_observed(&executor, &payload, false),
            Arrival::AllObserved(executor, payload) => {
                self.read_observed(&executor, &payload, true)
            }
            Arrival::WhatHolds(question) => {
                question.answer(wire::write(&self.board.all()));
                None
            }
            Arrival::Neighbour(name, epoch, appeared) => {
                self.neighbour(&name, epoch, appeared);
                None
            }
            // The driver's own business.
            Arrival::Look(..) | Arrival::Superseded(_) => None,
        }
    }

    fn read_instruction<L>(&mut self, question: Question) -> Option<(Input<L>, ReplyTo)> {
        let (body, received) = self.instructions.open("instruction", question)?;
        let refused = match wire::body::<Instruction>("instruction", body) {
            // The report has to find its way back.
            Ok(instruction) => match self.wiring.keys.agent(received.from().as_str()) {
                Ok(_) => {
                    let input = Input::Instruction {
                        from: received.from().clone(),
                        instruction: instruction.into(),
                    };
                    return Some((input, ReplyTo::Superior(received)));
                }
                Err(error) => error.to_string(),
            },
            Err(error) => error.to_string(),
        };
        // Unlike a report, an instruction can be answered with no. It is dealt with by that, and
        // what follows it is not held up.
        tracing::warn!(
            "an instruction from {} is refused: {refused}",
            received.from()
        );
        let answer = Answer::Rejected { reason: refused };
        self.instructions.applied(received, Some(answer));
        None
    }

    fn read_goal<L>(
        &mut self,
        urgency: Urgency,
        sender: Option<&str>,
        asked: Asked,
    ) -> Option<(Input<L>, ReplyTo)> {
        let (goal, question) = match asked {
            Asked::Put(payload) => {
                let goal = bounded(&payload, USER_LIMIT_BYTES)
                    .and_then(|bytes| wire::goal_from_user(urgency, &bytes));
                (goal, None)
            }
            Asked::Query(question) => {
                let goal = question
                    .content("goal", USER_LIMIT_BYTES)
                    .and_then(|bytes| wire::goal_from_user(urgency, &bytes));
                (goal, Some(question))
            }
        };
        match goal {
            Ok(goal) => match self.admit(sender, &goal) {
                Ok(()) => Some((Input::Goal(goal.clone()), ReplyTo::User(goal, question))),
                Err(reason) => {
                    self.tell_user(&Verdict::refused(&goal, reason), question);
                    None
                }
            },
            Err(error) => {
                self.tell_user(&Verdict::unreadable(&error), question);
                None
            }
        }
    }

    fn read_observed<L>(
        &mut self,
        executor: &Arc<str>,
        payload: &ZBytes,
        all: bool,
    ) -> Option<(Input<L>, ReplyTo)> {
        let message = bounded(payload, AGENT_LIMIT_BYTES)
            .and_then(|bytes| wire::read::<Observed>("facts", &bytes));
        let message = match message {
            Ok(message) => message,
            Err(error) => {
                tracing::warn!("from {executor}: {error}");
                return None;
            }
        };
        let reader = self.readers.entry(executor.clone()).or_default();
        let reading = if all {
            reader.all(message)
        } else {
            reader.published(message, &self.wiring.name)
        };
        match reading {
            Reading::Take(facts) => Some((Input::Observation(facts), ReplyTo::Nobody)),
            Reading::Ignore => None,
            Reading::Missed => {
                self.ask_what_holds(executor);
                None
            }
        }
    }

    fn neighbour(&self, name: &str, epoch: u64, appeared: bool) {
        if !appeared {
            tracing::info!("{name} (started at {epoch}) is gone");
            return;
        }
        tracing::info!("{name} (started at {epoch}) is there");
        if name == self.wiring.name {
            tracing::warn!("there are two of {name}: the later one will be listened to");
        }
        if self
            .wiring
            .executors
            .iter()
            .any(|executor| executor == name)
        {
            self.ask_what_holds(&Arc::from(name));
        }
    }

    fn ask_what_holds(&self, executor: &Arc<str>) {
        match self.wiring.keys.agent(executor) {
            Ok(keys) => self.mailbox.ask_what_holds(executor.clone(), keys.facts()),
            Err(error) => tracing::error!("{error}"),
        }
    }

    /// Answers whoever waits. A machine that owes a reply and gives none has a fault; whoever waits
    /// is told so rather than left waiting.
    pub(crate) fn reply(&mut self, to: ReplyTo, reply: Option<Reply>) {
        const FAULT: &str = "the agent gave no answer, which is a fault in it";
        match (to, reply) {
            (ReplyTo::Nobody, _) => {}
            (ReplyTo::Executor(received), _) => self.reports.applied(received, None),
            (ReplyTo::Elsewhere(received), _) => self.local.applied(received, None),
            (ReplyTo::Superior(received), reply) => {
                let answer = match reply {
                    Some(Reply::Instruction(answer)) => Answer::from(&answer),
                    _ => Answer::Rejected {
                        reason: FAULT.to_owned(),
                    },
                };
                self.instructions.applied(received, Some(answer));
            }
            (ReplyTo::User(goal, question), Some(Reply::Goal(result))) => {
                self.tell_user(&Verdict::on(&goal, &result), question);
            }
            (ReplyTo::User(_, question), _) => {
                let fault = WireError::malformed("answer", FAULT);
                self.tell_user(&Verdict::unreadable(&fault), question);
            }
            (ReplyTo::Commander(question), reply) => {
                let verdict = match reply {
                    Some(Reply::Command(result)) => CommandVerdict::new(&result),
                    _ => CommandVerdict::new(&Err(FAULT)),
                };
                question.answer(wire::write(&verdict));
            }
        }
    }

    /// To whoever asked; else to all, since a put has no way back.
    fn tell_user(&self, verdict: &Verdict, question: Option<Question>) {
        let text = wire::write(verdict);
        match (question, text) {
            (Some(question), text) => question.answer(text),
            (None, Ok(text)) => self.publisher.put(self.wiring.keys.goal_answers(), text),
            (None, Err(error)) => tracing::error!("cannot write a verdict: {error}"),
        }
    }
}

fn read_facts<L>(asked: Asked) -> Option<(Input<L>, ReplyTo)> {
    let facts = match asked {
        Asked::Put(payload) => {
            let facts =
                bounded(&payload, USER_LIMIT_BYTES).and_then(|bytes| wire::facts_from_user(&bytes));
            if let Err(error) = &facts {
                tracing::warn!("{error}");
            }
            facts
        }
        Asked::Query(question) => {
            let facts = question
                .content("facts", USER_LIMIT_BYTES)
                .and_then(|bytes| wire::facts_from_user(&bytes));
            question.answer(wire::write(&FactsVerdict::new(&facts)));
            facts
        }
    };
    Some((Input::Observation(facts.ok()?), ReplyTo::Nobody))
}
