//! What comes in from the network.

use agent_core::model::{FactChange, Time};
use agent_core::protocol::{Arrival, Envelope, Input, Response};

use crate::law::BOUND;
use crate::mutant::Mutant;
use crate::process::{Kind, Role, Way, name};
use crate::scenario::Who;
use crate::wire::Message;

use super::{BACK_OFF, Due, Simulation, TIMEOUT};

impl Simulation<'_> {
    pub(super) fn deliver(&mut self, from: Who, to: Who, message: Message) {
        match to {
            Who::User => {
                if let Message::Verdict(request) = message {
                    self.requests[request as usize].answered = true;
                }
                return;
            }
            Who::World => return self.deliver_to_world(message),
            _ => {}
        }
        let node = &mut self.nodes[to.index()];
        if node.role.is_none() {
            return;
        }
        if node.frozen.is_some() {
            node.backlog.push_back((from, message));
            return;
        }
        if self.tells && !matches!(message, Message::Response { .. }) {
            let text = in_words(&message);
            self.tell(|| format!("{from:<9} -> {to}: {text}"));
        }
        let neighbour = |line, epoch, kind| Way::Neighbour {
            who: from,
            line,
            epoch,
            kind,
        };
        match message {
            Message::Instruction(envelope) => {
                let way = neighbour(envelope.line, envelope.epoch, Kind::Instruction);
                let starts = matches!(
                    envelope.body,
                    agent_core::protocol::Instruction::Execute { .. }
                        | agent_core::protocol::Instruction::Resume { .. }
                );
                self.nodes[to.index()].instructed |= starts;
                if self.mutant == Some(Mutant::ApplyTwice) {
                    let from = envelope.from.clone();
                    let instruction = envelope.body.clone();
                    let twice = Input::Instruction { from, instruction };
                    self.give(to, Arrival::Instruction(envelope), Some(way));
                    self.give(to, Arrival::Input(twice), None);
                } else {
                    self.give(to, Arrival::Instruction(envelope), Some(way));
                }
            }
            Message::StopAhead(envelope) => self.give(to, Arrival::StopAhead(envelope), None),
            Message::Report(envelope) => self.deliver_report(from, to, envelope),
            Message::Sensor(envelope) => {
                // The world has one epoch.
                let way = neighbour(0, 0, Kind::Local);
                self.give(to, Arrival::Local(envelope), Some(way));
            }
            Message::Response {
                epoch,
                kind,
                response,
                line,
            } => self.answered(from, to, epoch, kind, response, line),
            Message::Facts {
                epoch,
                seq,
                facts,
                reported,
                all,
            } => self.read_facts(from, to, (epoch, seq), facts, reported, all),
            Message::WhatHolds => {
                let node = &self.nodes[to.index()];
                let message = Message::Facts {
                    epoch: node.epoch,
                    seq: node.board.seq,
                    facts: node.board.all(),
                    reported: false,
                    all: true,
                };
                self.send(to, from, message);
            }
            Message::Request(request) => self.requested(to, request),
            Message::Door(change) => {
                let observed = Input::Observation(vec![change]);
                self.give(to, Arrival::Input(observed), None);
            }
            Message::Command(_) | Message::Verdict(_) => {}
        }
    }

    pub(super) fn deliver_report(
        &mut self,
        from: Who,
        to: Who,
        envelope: Envelope<agent_core::protocol::ReportBody>,
    ) {
        let way = Way::Neighbour {
            who: from,
            line: envelope.line,
            epoch: envelope.epoch,
            kind: Kind::Report,
        };
        if self.mutant == Some(Mutant::DropTheLastReport) && envelope.body.report.is_end() {
            let node = &mut self.nodes[to.index()];
            node.ends_dropped += 1;
            if node.ends_dropped % 4 == 3 {
                let line = node.role.as_ref().map_or(0, Role::line);
                let response = Response::Applied {
                    seq: envelope.seq,
                    answer: None,
                };
                return self.respond(to, way, response, line);
            }
        }
        let (id, report) = (envelope.body.id.clone(), envelope.body.report.clone());
        self.law.learned(self.now, to, from, &envelope);
        self.give(to, Arrival::Report(envelope), Some(way));
        if self.mutant == Some(Mutant::ApplyTwice) {
            self.give(to, Arrival::Input(Input::Report { id, report }), None);
        }
    }

    /// A message of ours was answered.
    pub(super) fn answered(
        &mut self,
        by: Who,
        who: Who,
        epoch: u64,
        kind: Kind,
        response: Response,
        line: u64,
    ) {
        let node = &mut self.nodes[who.index()];
        if node.epoch != epoch {
            return;
        }
        let channel = node
            .channels
            .iter_mut()
            .find(|channel| channel.kind == kind && channel.to == by);
        let Some(channel) = channel else {
            return;
        };
        let Some((first, message)) = channel.queue.front() else {
            return;
        };
        let attempts = channel.attempts;
        match response {
            Response::Applied { seq, answer } if seq == *first => {
                let instruction = match message {
                    Message::Instruction(envelope) => Some(envelope.body.clone()),
                    _ => None,
                };
                channel.queue.pop_front();
                channel.attempts = 0;
                match (kind, instruction) {
                    (Kind::Instruction, Some(instruction)) => {
                        // Without one it was answered before the sender had written it down, and
                        // the receiver was told since that it has.
                        let answer = answer.unwrap_or(agent_core::protocol::Answer::Accepted);
                        self.tell(|| format!("{by:<9} answers {who}: {answer:?} to {}", seq));
                        if self.law.answered(self.now, &instruction, &answer) {
                            let id = instruction.id().clone();
                            let promised = self.now;
                            self.after(BOUND, Due::Promised { id, promised });
                        }
                        let by = name(by);
                        let arrival = Arrival::Answered {
                            by,
                            line,
                            seq,
                            answer: answer.clone(),
                        };
                        self.give(who, arrival, None);
                        if let Some(role) = &self.nodes[who.index()].role {
                            self.law.heeds(self.now, who, role, &instruction, &answer);
                        }
                    }
                    (Kind::Report, _) => {
                        let by = name(by);
                        self.give(who, Arrival::Delivered { by, line, seq }, None);
                    }
                    _ => {}
                }
                self.attempt(who, kind, by);
            }
            Response::Gap { seq, .. } if seq == *first => {
                let wait = BACK_OFF[(attempts as usize).min(BACK_OFF.len() - 1)];
                let (to, attempt) = (by, attempts);
                self.after(
                    Time(wait),
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
            Response::Superseded { seq }
                if seq == *first && who != Who::World && kind != Kind::Local =>
            {
                self.broken(|| format!("{by} takes {who} for one that was replaced"));
            }
            _ => {}
        }
    }

    pub(super) fn read_facts(
        &mut self,
        from: Who,
        to: Who,
        at: (u64, u64),
        facts: Vec<FactChange>,
        reported: bool,
        all: bool,
    ) {
        let node = &mut self.nodes[to.index()];
        let last = &mut node.read[from.index()];
        if at.1 == 0 || last.is_some_and(|last| at <= last) {
            return;
        }
        let due = match *last {
            Some((epoch, seq)) if epoch == at.0 => seq + 1,
            _ => 1,
        };
        if !all && at.1 != due {
            let epoch = node.epoch;
            return self.ask_what_holds(to, epoch, from, 0);
        }
        *last = Some(at);
        if !reported {
            self.give(to, Arrival::Input(Input::Observation(facts)), None);
        }
    }

    pub(super) fn ask_what_holds(&mut self, who: Who, epoch: u64, executor: Who, attempts: u32) {
        let node = &self.nodes[who.index()];
        if node.epoch != epoch || node.role.is_none() || attempts >= 10 {
            return;
        }
        // Asked for once, it is asked for until something comes.
        let known = node.read[executor.index()];
        let its = self.nodes[executor.index()].epoch;
        if attempts > 0
            && (known.is_some_and(|(epoch, _)| epoch == its)
                || !self.nodes[executor.index()].board.is_used())
        {
            return;
        }
        self.send(who, executor, Message::WhatHolds);
        let attempts = attempts + 1;
        self.after(
            TIMEOUT,
            Due::AskAgain {
                who,
                epoch,
                executor,
                attempts,
            },
        );
    }
}

pub(super) fn in_words(message: &Message) -> String {
    match message {
        Message::Instruction(e) => match &e.body {
            agent_core::protocol::Instruction::Execute { id, action, .. } => {
                format!("#{} execute {id} {action}", e.seq)
            }
            agent_core::protocol::Instruction::Resume { id, .. } => {
                format!("#{} resume {id}", e.seq)
            }
            other => format!("#{} {other:?}", e.seq),
        },
        Message::StopAhead(e) => format!("ahead of #{}: suspend {}", e.seq, e.body.id()),
        Message::Report(e) => format!("#{} {} {:?}", e.seq, e.body.id, e.body.report),
        other => format!("{other:?}"),
    }
}
