//! What has come in, as the machine's station takes it; and the station's response, as an answer.

use agent_core::protocol::{self, Arrival, Envelope, GoalRequest, Input, Response, Urgency};
use serde_json::Value;
use zenoh::bytes::ZBytes;

use crate::facts::{Board, Reading};
use crate::link::Link;
use crate::mailbox::{self, Asked, Told};
use crate::question::{Question, bounded};
use crate::wire::{
    self, AGENT_LIMIT_BYTES, Acknowledgement, CommandVerdict, FactsVerdict, Instruction, Message,
    Observed, ReportBody, USER_LIMIT_BYTES, Verdict, WireError,
};

/// Who waits for a response.
#[derive(Debug)]
pub(crate) enum ReplyTo {
    /// Who has sent the message of that number.
    Sender(u64, Question),
    /// Without a question, the verdict is published.
    User(GoalRequest, Option<Question>),
    Commander(Question),
    Witness(Question),
}

/// How a machine is told of a goal that whoever can do it best is to do.
pub(crate) type ForAny<L> = fn(GoalRequest) -> L;

/// What the station takes, and who waits for the response.
type Taken<L> = (Arrival<L>, Option<ReplyTo>);

impl Link {
    /// What an arrival is to the machine's station. `None`: it was seen to here.
    pub(crate) fn read<L>(
        &mut self,
        arrival: mailbox::Arrival,
        local: fn(Value) -> Result<L, WireError>,
        for_any: Option<ForAny<L>>,
    ) -> Option<Taken<L>> {
        use mailbox::Arrival as Raw;
        match arrival {
            Raw::Instruction(question) => self.read_instruction(question),
            Raw::Report(question) => {
                let report = |body| wire::body::<ReportBody>("report", body);
                let (message, sender) = self.read_as("report", question, report)?;
                let message = message.map(|body| protocol::ReportBody {
                    id: body.id.0,
                    report: body.report.into(),
                });
                Some((Arrival::Report(message), Some(sender)))
            }
            Raw::Local(question) => {
                let (message, sender) = self.read_as("message", question, local)?;
                Some((Arrival::Local(message), Some(sender)))
            }
            Raw::Answered(by, line, seq, answer) => {
                let answered = Arrival::Answered {
                    by,
                    line,
                    seq,
                    answer,
                };
                Some((answered, None))
            }
            Raw::Delivered(by, line, seq) => Some((Arrival::Delivered { by, line, seq }, None)),
            Raw::Goal(urgency, sender, asked) => {
                self.read_goal(urgency, sender.as_deref(), asked, for_any)
            }
            Raw::OwnGoal(urgency, asked) => self.read_goal(urgency, None, asked, None),
            Raw::Said(by, payload) => {
                let said = bounded(&payload, AGENT_LIMIT_BYTES)
                    .and_then(|bytes| wire::read("message", &bytes))
                    .and_then(|message| said_by(&by, message))
                    .and_then(local);
                match said {
                    Ok(said) => Some(nobody_waits(Input::Local(said))),
                    Err(error) => {
                        tracing::warn!("{error}");
                        None
                    }
                }
            }
            Raw::Command(question) => {
                let command = question
                    .content("command", USER_LIMIT_BYTES)
                    .and_then(|bytes| wire::command_from_user(&bytes));
                match command {
                    Ok(command) => Some((
                        Arrival::Input(Input::Command(command)),
                        Some(ReplyTo::Commander(question)),
                    )),
                    Err(error) => {
                        question.answer(wire::write(&CommandVerdict::new(&Err(error))));
                        None
                    }
                }
            }
            Raw::Facts(asked) => read_facts(asked),
            Raw::Observed(told, payload) => self.read_observed(&told, &payload, false),
            Raw::AllObserved(told, payload) => self.read_observed(&told, &payload, true),
            Raw::WhatHolds(question) => {
                let board = match question.asker() {
                    None => Some(&self.board),
                    Some(superior) => self.boards.get(&**superior),
                };
                let nothing = || Board::new(self.wiring.epoch).all();
                let all = board.map_or_else(nothing, Board::all);
                question.answer(wire::write(&all));
                None
            }
            Raw::Neighbour {
                name,
                epoch,
                line,
                appeared,
            } => self.read_neighbour(&name, epoch, line, appeared),
            // The driver's own business.
            Raw::Look(..) | Raw::Superseded(_) | Raw::Outdated(..) => None,
        }
    }

    /// A message, whose sender has a name that can be answered. What cannot be read is refused.
    fn read_message(
        &self,
        what: &'static str,
        question: Question,
    ) -> Option<(Message<Value>, Question)> {
        let message = question
            .content(what, AGENT_LIMIT_BYTES)
            .and_then(|bytes| wire::read::<Message<Value>>(what, &bytes));
        let refused = match (message, question.asker()) {
            (Ok(message), Some(asker)) if **asker != *message.sender() => {
                let sender = message.sender();
                format!("the {what} says that it is from `{sender}`, and its key from `{asker}`")
            }
            (Ok(message), _) => match self.wiring.keys.agent(message.sender()) {
                Ok(_) => return Some((message, question)),
                Err(error) => error.to_string(),
            },
            (Err(error), _) => error.to_string(),
        };
        tracing::warn!("{refused}");
        acknowledge(question, &Acknowledgement::refused(None, refused));
        None
    }

    /// A message, with the content as what `read` makes of it. What makes no sense here is refused,
    /// and will come again: nothing that a sender says may be lost.
    fn read_as<B>(
        &self,
        what: &'static str,
        question: Question,
        read: impl FnOnce(Value) -> Result<B, WireError>,
    ) -> Option<(Envelope<B>, ReplyTo)> {
        let (message, question) = self.read_message(what, question)?;
        let envelope = Envelope::from(message);
        let seq = envelope.seq;
        match read(envelope.body.clone()) {
            Ok(body) => {
                let envelope = envelope.map(|_| body);
                Some((envelope, ReplyTo::Sender(seq, question)))
            }
            Err(error) => {
                tracing::warn!("from {}: {error}", envelope.from);
                acknowledge(question, &Acknowledgement::refused(Some(seq), error));
                None
            }
        }
    }

    fn read_instruction<L>(&self, question: Question) -> Option<Taken<L>> {
        let (message, question) = self.read_message("instruction", question)?;
        let ahead = message.is_ahead();
        let envelope = Envelope::from(message).map(|body| {
            let instruction = wire::body::<Instruction>("instruction", body);
            instruction.map(protocol::Instruction::from)
        });
        let sender = (!ahead).then_some(ReplyTo::Sender(envelope.seq, question));
        match (&envelope.body, ahead) {
            (Ok(instruction), _) => {
                let instruction = instruction.clone();
                let envelope = envelope.map(|_| instruction);
                let arrival = match ahead {
                    true => Arrival::StopAhead(envelope),
                    false => Arrival::Instruction(envelope),
                };
                Some((arrival, sender))
            }
            (Err(error), false) => {
                // Unlike a report, an instruction can be answered with no. It is dealt with by that,
                // and what follows it is not held up.
                tracing::warn!("an instruction from {} is refused: {error}", envelope.from);
                let reason = error.to_string();
                Some((Arrival::Unreadable(envelope.map(|_| reason)), sender))
            }
            // Its original follows.
            (Err(_), true) => None,
        }
    }

    fn read_goal<L>(
        &mut self,
        urgency: Urgency,
        sender: Option<&str>,
        asked: Asked,
        for_any: Option<ForAny<L>>,
    ) -> Option<Taken<L>> {
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
                Ok(()) => {
                    let input = match for_any {
                        Some(for_any) => Input::Local(for_any(goal.clone())),
                        None => Input::Goal(goal.clone()),
                    };
                    let sender = ReplyTo::User(goal, question);
                    Some((Arrival::Input(input), Some(sender)))
                }
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

    fn read_observed<L>(&mut self, told: &Told, payload: &ZBytes, all: bool) -> Option<Taken<L>> {
        let message = bounded(payload, AGENT_LIMIT_BYTES)
            .and_then(|bytes| wire::read::<Observed>("facts", &bytes));
        let message = match message {
            Ok(message) => message,
            Err(error) => {
                tracing::warn!("from {}: {error}", told.executor);
                return None;
            }
        };
        let reader = self.readers.entry(told.clone()).or_default();
        let reading = if all {
            reader.all(message)
        } else {
            reader.published(message, &self.wiring.name)
        };
        match reading {
            Reading::Take(facts) => Some(nobody_waits(Input::Observation(facts))),
            Reading::Ignore => None,
            Reading::Missed => {
                self.ask_what_holds(told);
                None
            }
        }
    }

    fn read_neighbour<L>(
        &mut self,
        name: &str,
        epoch: u64,
        line: u64,
        appeared: bool,
    ) -> Option<Taken<L>> {
        let is_there = if appeared { "there" } else { "gone" };
        tracing::info!("{name} (started at {epoch}) is {is_there}");
        if name == self.wiring.name {
            if appeared {
                tracing::warn!("there are two of {name}: the later one will be listened to");
            }
            return None;
        }
        let mut executors = self.wiring.executors.iter();
        if appeared && executors.any(|executor| executor == name) {
            for alone in [false, true] {
                let executor = name.into();
                if !alone || self.wiring.signs {
                    self.ask_what_holds(&Told { executor, alone });
                }
            }
        }
        let there = self.neighbours.hear(name, epoch, appeared);
        if appeared {
            self.hurry(name);
            let name = name.into();
            return Some((Arrival::Appeared { name, line }, None));
        }
        let name = name.into();
        let there = there?;
        Some(nobody_waits(Input::Neighbour { name, there }))
    }

    fn ask_what_holds(&self, told: &Told) {
        let key = self.wiring.keys.agent(&told.executor);
        let key = key.and_then(|its| match told.alone {
            true => its.facts_for(&self.wiring.name),
            false => Ok(its.facts()),
        });
        match key {
            Ok(key) => self.mailbox.ask_what_holds(told.clone(), key),
            Err(error) => tracing::error!("{error}"),
        }
    }

    /// Answers whoever waits, for a machine whose memory begins in the epoch `line`.
    pub(crate) fn respond(&self, to: ReplyTo, response: Response, line: u64) {
        match (to, response) {
            (ReplyTo::Sender(_, question), response) => {
                let answer = match response {
                    Response::Applied { seq, answer } => {
                        Acknowledgement::applied(line, seq, answer.as_ref().map(Into::into))
                    }
                    Response::Superseded { seq } => Acknowledgement::superseded(seq),
                    Response::Gap { seq, due } => {
                        let reason = format_args!("message {due} is due, not {seq}");
                        Acknowledgement::refused(Some(seq), reason)
                    }
                    Response::Goal(_) | Response::Command(_) | Response::Noted => {
                        Acknowledgement::refused(None, FAULT)
                    }
                };
                acknowledge(question, &answer);
            }
            (ReplyTo::User(goal, question), Response::Goal(result)) => {
                let mut verdict = Verdict::on(&goal, &result);
                if self.wiring.in_team {
                    verdict = verdict.said_by(&self.wiring.name);
                }
                self.tell_user(&verdict, question);
            }
            (ReplyTo::User(goal, question), _) => {
                self.tell_user(&Verdict::refused(&goal, FAULT.to_owned()), question);
            }
            (ReplyTo::Commander(question), response) => {
                let verdict = match response {
                    Response::Command(result) => CommandVerdict::new(&result),
                    _ => CommandVerdict::new(&Err(FAULT)),
                };
                question.answer(wire::write(&verdict));
            }
            (ReplyTo::Witness(question), _) => {
                question.answer(wire::write(&FactsVerdict::new(&Ok::<_, WireError>(()))));
            }
        }
    }

    /// Tells whoever waits that nothing is acknowledged, since the journal cannot be written.
    pub(crate) fn not_written(&self, to: ReplyTo, trouble: &str) {
        match to {
            ReplyTo::Sender(seq, question) => {
                acknowledge(question, &Acknowledgement::refused(Some(seq), trouble));
            }
            ReplyTo::User(goal, question) => {
                self.tell_user(
                    &Verdict::refused(&goal, not_acknowledged(trouble)),
                    question,
                );
            }
            ReplyTo::Commander(question) => {
                let verdict = CommandVerdict::new(&Err(not_acknowledged(trouble)));
                question.answer(wire::write(&verdict));
            }
            ReplyTo::Witness(question) => {
                let verdict = FactsVerdict::new(&Err::<(), _>(not_acknowledged(trouble)));
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

/// A machine that owes a reply and gives none has a fault; whoever waits is told so rather than left
/// waiting.
const FAULT: &str = "the agent gave no answer, which is a fault in it";

/// What was asked for has been heard, and may be done.
fn not_acknowledged(trouble: &str) -> String {
    format!("{trouble}; it is not acknowledged: it may be done all the same, or forgotten")
}

/// Nobody of a team speaks for another: what is said is by whom the key names.
fn said_by(by: &str, message: Value) -> Result<Value, WireError> {
    match message["by"].as_str() {
        Some(says) if says == by => Ok(message),
        says => {
            let says = says.unwrap_or("nobody");
            let why = format_args!("it says that it is by `{says}`, and its key by `{by}`");
            Err(WireError::malformed("message", why))
        }
    }
}

fn nobody_waits<L>(input: Input<L>) -> Taken<L> {
    (Arrival::Input(input), None)
}

fn acknowledge(question: Question, answer: &Acknowledgement) {
    question.answer(wire::write(answer));
}

fn read_facts<L>(asked: Asked) -> Option<Taken<L>> {
    let (facts, question) = match asked {
        Asked::Put(payload) => {
            let facts =
                bounded(&payload, USER_LIMIT_BYTES).and_then(|bytes| wire::facts_from_user(&bytes));
            (facts, None)
        }
        Asked::Query(question) => {
            let facts = question
                .content("facts", USER_LIMIT_BYTES)
                .and_then(|bytes| wire::facts_from_user(&bytes));
            (facts, Some(question))
        }
    };
    match (facts, question) {
        (Ok(facts), question) => Some((
            Arrival::Input(Input::Observation(facts)),
            question.map(ReplyTo::Witness),
        )),
        (Err(error), None) => {
            tracing::warn!("{error}");
            None
        }
        (Err(error), Some(question)) => {
            question.answer(wire::write(&FactsVerdict::new(&Err::<(), _>(error))));
            None
        }
    }
}
