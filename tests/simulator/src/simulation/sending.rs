//! What goes out of a process, and over the network.

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Answer, Effect, Response};
use executor_sim::MotorCommand;

use crate::counts::Counted;
use crate::mutant::Mutant;
use crate::process::{AnyEffect, Kind, Way};
use crate::scenario::Who;
use crate::wire::{Channel, Message};

use super::seeing::superiors;
use super::{Due, Simulation, TIMEOUT};

impl Simulation<'_> {
    pub(super) fn send_effect(&mut self, who: Who, epoch: u64, effect: AnyEffect) {
        match effect {
            Effect::Instruct { to, message } => {
                let Some(to) = Who::of(to.as_str()) else {
                    return;
                };
                let seq = message.seq;
                self.enqueue(
                    who,
                    Kind::Instruction,
                    to,
                    seq,
                    Message::Instruction(message),
                );
            }
            Effect::StopAhead { to, message } => {
                if let Some(to) = Who::of(to.as_str()) {
                    self.send(who, to, Message::StopAhead(message));
                }
            }
            Effect::Report { to, message } => {
                let Some(to) = Who::of(to.as_str()) else {
                    return;
                };
                let seq = message.seq;
                self.enqueue(who, Kind::Report, to, seq, Message::Report(message));
            }
            Effect::Local(message) => {
                if let Some(ticket) = begun_by(&message.body) {
                    self.law.commanded(epoch, ticket);
                }
                let seq = message.seq;
                self.enqueue(who, Kind::Local, Who::World, seq, Message::Command(message));
            }
            Effect::Observed { facts, reported_to } => {
                let node = &mut self.nodes[who.index()];
                node.board.tell(&facts);
                let seq = node.board.seq;
                for to in superiors(who, self.scenario.two_children) {
                    let facts = facts.clone();
                    let reported = reported_to.as_ref().is_some_and(|by| *by == to.name());
                    let all = false;
                    let message = Message::Facts {
                        epoch,
                        seq,
                        facts,
                        reported,
                        all,
                    };
                    self.send(who, *to, message);
                }
            }
            // Nobody here is the body of several.
            Effect::Seen { .. } => {}
            Effect::Event { number, event } => {
                self.tell(|| {
                    let goal = event.goal.as_ref().map_or("", Symbol::as_str);
                    format!(
                        "{who:<9} event {number} {goal} [{}] {:?}",
                        event.stack_depth, event.what
                    )
                });
            }
            Effect::Respond { to, response, line } => self.respond(who, to, response, line),
        }
    }

    pub(super) fn respond(&mut self, who: Who, to: Way, response: Response, line: u64) {
        match to {
            Way::User(request) => {
                let goal = self.requests[request as usize].goal;
                if let Response::Goal(Ok(id)) = &response {
                    let id = id.clone();
                    self.law.acknowledged(&id, line);
                    self.count(Counted::GoalsAcknowledged);
                }
                self.tell(|| format!("{who:<9} answers about goal{goal}: {response:?}"));
                self.send(who, Who::User, Message::Verdict(request));
            }
            Way::Neighbour {
                who: to,
                line: its,
                epoch,
                kind,
            } => {
                let mut response = response;
                if let Response::Applied { seq, answer } = &mut response
                    && let Some(answer) = answer
                {
                    let told = (who, line, to, its, *seq);
                    if self.mutant == Some(Mutant::ForgetAnswers) && self.law.was_answered(told) {
                        *answer = Answer::Accepted;
                    }
                    self.law.answers(self.now, told, answer);
                }
                let message = Message::Response {
                    epoch,
                    kind,
                    response,
                    line,
                };
                self.send(who, to, message);
            }
        }
    }

    pub(super) fn enqueue(&mut self, who: Who, kind: Kind, to: Who, seq: u64, message: Message) {
        let channels = &mut self.nodes[who.index()].channels;
        let at = channels
            .iter()
            .position(|channel| channel.kind == kind && channel.to == to);
        let at = at.unwrap_or_else(|| {
            channels.push(Channel::new(kind, to));
            channels.len() - 1
        });
        channels[at].queue.push_back((seq, message));
        if channels[at].queue.len() == 1 {
            channels[at].attempts = 0;
            self.attempt(who, kind, to);
        }
    }

    /// Sends the first of a channel, and sees to it that it is sent again.
    pub(super) fn attempt(&mut self, who: Who, kind: Kind, to: Who) {
        let epoch = self.nodes[who.index()].epoch;
        let channel = match who {
            Who::World => Some(&mut self.world_says),
            _ => self.nodes[who.index()]
                .channels
                .iter_mut()
                .find(|channel| channel.kind == kind && channel.to == to),
        };
        let Some(channel) = channel else {
            return;
        };
        let Some((seq, message)) = channel.queue.front().cloned() else {
            return;
        };
        channel.attempts += 1;
        let attempt = channel.attempts;
        self.send(who, to, message);
        self.after(
            TIMEOUT,
            Due::Retry {
                who,
                epoch,
                kind,
                to,
                seq,
                attempt,
            },
        );
    }

    pub(super) fn retry(
        &mut self,
        who: Who,
        epoch: u64,
        (kind, to): (Kind, Who),
        seq: u64,
        attempt: u32,
    ) {
        let node = &self.nodes[who.index()];
        if node.epoch != epoch || (node.role.is_none() && who != Who::World) {
            return;
        }
        if let Some((_, until)) = node.frozen {
            return self.plan(
                until,
                Due::Retry {
                    who,
                    epoch,
                    kind,
                    to,
                    seq,
                    attempt,
                },
            );
        }
        let channel = match who {
            Who::World => Some(&self.world_says),
            _ => node
                .channels
                .iter()
                .find(|channel| channel.kind == kind && channel.to == to),
        };
        let still = channel.is_some_and(|channel| {
            channel.attempts == attempt && channel.queue.front().is_some_and(|(s, _)| *s == seq)
        });
        if still {
            self.count(Counted::MessagesSentAgain);
            self.attempt(who, kind, to);
        }
    }

    /// Puts a message on the network, which may lose, repeat and delay it.
    pub(super) fn send(&mut self, from: Who, to: Who, message: Message) {
        self.count(Counted::Messages);
        let now = self.now;
        let spread = self.scenario.spread.0;
        let mut delay = self.scenario.delay.0 + self.draw(2, spread + 1);
        let bad = self
            .weather
            .iter()
            .find(|(until, ..)| *until > now)
            .copied();
        if self.is_cut(from, to) {
            self.count(Counted::MessagesLost);
            return;
        }
        if let Some((_, lost, twice, late)) = bad {
            if self.draw(3, 1000) < lost {
                self.count(Counted::MessagesLost);
                self.tell(|| format!("{from:<9} -> {to}: {} is lost", message.kind()));
                return;
            }
            if self.draw(4, 1000) < late {
                self.count(Counted::MessagesLate);
                delay += self.draw(5, 3_000_000);
            }
            if self.draw(6, 1000) < twice {
                self.count(Counted::MessagesTwice);
                let later = Time(delay + self.draw(7, 2_000_000));
                let message = message.clone();
                self.put_on(later, from, to, message);
            }
        }
        self.put_on(Time(delay), from, to, message);
    }

    fn put_on(&mut self, delay: Time, from: Who, to: Who, message: Message) {
        let robot = self.robot;
        let message = Box::new(message);
        let deliver = Due::Deliver {
            robot,
            from,
            to,
            message,
        };
        self.after(delay, deliver);
    }

    pub(super) fn is_cut(&self, one: Who, other: Who) -> bool {
        self.cuts.iter().any(|cut| {
            cut.until > self.now
                && ((cut.one, cut.other) == (one, other) || (cut.other, cut.one) == (one, other))
        })
    }
}

/// The number of a command that moves something.
pub(super) fn begun_by(command: &MotorCommand) -> Option<u64> {
    match command {
        MotorCommand::Drive { ticket, .. }
        | MotorCommand::Speak { ticket, .. }
        | MotorCommand::SetDoor { ticket, .. }
        | MotorCommand::Deed { ticket, .. } => Some(ticket.0),
        MotorCommand::Brake { .. }
        | MotorCommand::Hush { .. }
        | MotorCommand::Halt { .. }
        | MotorCommand::Look => None,
    }
}
