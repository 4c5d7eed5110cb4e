//! A machine with its mailboxes and its memory: what makes a crash a pause.
//!
//! State, what was received and what is still to be sent are written down together, and nothing that
//! depends on them leaves before that. So a process that is started again from what it has written
//! down is to its neighbours as one that was slow. Only stopping goes ahead (decision 10): it is
//! harmless to repeat and harmless to forget.

mod effect;
mod mailboxes;
mod memory;
mod outgoing;
mod sameness;
#[cfg(test)]
mod tests;

pub use effect::{Arrival, Effect, Response};
pub use memory::last_epoch;

use std::collections::{BTreeMap, VecDeque};

use super::delivery::{Envelope, Receipt};
use super::durable::{Durable, Ledger, Row};
use super::{ActionId, Answer, Event, Input, Instruction, Reply, ReportBody};
use crate::model::{Symbol, Time};
use mailboxes::Mailboxes;
use memory::Noted;
use outgoing::starts;

/// A machine as its neighbours know it. `T` leads back to whoever waits for a response.
///
/// After every [`handle`](Self::handle): give what [`write_down`](Self::write_down) returns to the
/// journal, call [`written`](Self::written) when it is on the disk, and take effects until there is
/// none. One writing at a time; inputs may be handled meanwhile.
#[derive(Clone, Debug)]
pub struct Station<M: Durable, T> {
    name: Symbol,
    line: u64,
    epoch: u64,
    machine: M,
    mailboxes: Mailboxes,
    /// The line of each neighbour, as far as it was heard of.
    neighbours: BTreeMap<Symbol, u64>,
    /// What was stopped ahead of the numbered instruction to stop it, by superior.
    ahead: BTreeMap<Symbol, Ahead>,
    next_event: u64,
    last_ends: VecDeque<(u64, Event)>,
    /// Counts what was handled.
    state: u64,
    /// The state that is being written down.
    writing: Option<u64>,
    /// Whether something may be different from what was written down last.
    dirty: bool,
    /// What waits for a state to be written down.
    held: VecDeque<(u64, Effect<M::Out, T>)>,
    ready: VecDeque<Effect<M::Out, T>>,
    ledger: Ledger,
    noted: Noted,
}

/// Something was to be stopped before its turn.
#[derive(Clone, Debug, Eq, PartialEq)]
struct Ahead {
    /// Of the superior's start.
    epoch: u64,
    /// The number of the instruction that follows.
    seq: u64,
    id: ActionId,
    /// Whether the machine has said that it stops.
    stopping: bool,
}

impl<M: Durable, T> Station<M, T>
where
    M::Out: Clone,
{
    /// For a machine without a past, whose memory begins in this epoch.
    pub fn new(name: Symbol, epoch: u64, machine: M) -> Self {
        let mut station = Self {
            name,
            line: epoch,
            epoch,
            machine,
            mailboxes: Mailboxes::default(),
            neighbours: BTreeMap::new(),
            ahead: BTreeMap::new(),
            next_event: 1,
            last_ends: VecDeque::new(),
            state: 1,
            writing: None,
            dirty: true,
            held: VecDeque::new(),
            ready: VecDeque::new(),
            ledger: Ledger::default(),
            noted: Noted::default(),
        };
        station.collect();
        station
    }

    /// The machine inside.
    pub fn machine(&self) -> &M {
        &self.machine
    }

    /// Gives the machine back; what it had not yet said is lost.
    pub fn into_machine(self) -> M {
        self.machine
    }

    /// The epoch in which its memory begins.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// When the machine is to be woken ([`Machine::wake_at`](super::Machine::wake_at)).
    pub fn wake_at(&self) -> Option<Time> {
        self.machine.wake_at()
    }

    /// How many effects wait for the disk.
    pub fn held(&self) -> usize {
        self.held.len()
    }

    /// Whether [`write_down`](Self::write_down) is worth calling: something may be different, and
    /// nothing is being written.
    pub fn wants_writing(&self) -> bool {
        self.writing.is_none() && (self.dirty || !self.held.is_empty())
    }

    /// What is different from what was written down last; call [`written`](Self::written) once all
    /// of it is on the disk. `None` while the last is still being written, and if nothing is
    /// different: then nothing waits either.
    pub fn write_down(&mut self) -> Option<Vec<Row>> {
        if self.writing.is_some() {
            return None;
        }
        self.dirty = false;
        let mut rows = self.machine.write_down();
        rows.append(&mut self.own_rows());
        self.writing = Some(self.state);
        if rows.is_empty() {
            self.written();
            return None;
        }
        Some(rows)
    }

    /// Takes one arrival at time `now`, which never goes back. `sender` waits for a response, which
    /// comes as an [`Effect::Respond`].
    pub fn handle(&mut self, now: Time, arrival: Arrival<M::In>, sender: Option<T>) {
        self.state += 1;
        self.dirty |= !matches!(arrival, Arrival::Input(Input::Wake));
        match arrival {
            Arrival::Instruction(message) => self.instruction(now, message, sender),
            Arrival::Unreadable(message) => {
                let receipt = self.mailboxes.instructions_in.receive(&message);
                if let Some(opened) = self.open(receipt, message.seq, sender) {
                    self.know(now, &message.from, message.line);
                    let reason = message.body.clone();
                    self.answered(&message, Answer::Rejected { reason }, opened.sender);
                }
            }
            Arrival::StopAhead(message) => self.stop_ahead(now, &message),
            Arrival::Report(message) => {
                let receipt = self.mailboxes.reports_in.receive(&message);
                if let Some(opened) = self.open(receipt, message.seq, sender) {
                    self.know(now, &message.from, message.line);
                    self.mailboxes.reports_in.applied(&message, None);
                    let seq = message.seq;
                    let ReportBody { id, report } = message.body;
                    if self.machine.believes(&message.from, &id) {
                        self.tell(now, Input::Report { id, report });
                    }
                    self.respond(opened.sender, Response::Applied { seq, answer: None });
                }
            }
            Arrival::Local(message) => {
                let receipt = self.mailboxes.local_in.receive(&message);
                if let Some(opened) = self.open(receipt, message.seq, sender) {
                    if opened.reborn {
                        let name = message.from.clone();
                        self.tell(now, Input::Reborn { name });
                    }
                    self.mailboxes.local_in.applied(&message, None);
                    let seq = message.seq;
                    self.tell(now, Input::Local(message.body));
                    self.respond(opened.sender, Response::Applied { seq, answer: None });
                }
            }
            Arrival::Answered {
                by,
                line,
                seq,
                answer,
            } => {
                // First, so that nothing is made of what somebody says who was not meant.
                self.know(now, &by, line);
                if let Some(to) = self.mailboxes.instruction_answered(&by, seq, self.state) {
                    self.tell(now, Input::Answer { to, answer });
                }
            }
            Arrival::Delivered { by, line, seq } => {
                self.mailboxes.report_delivered(&by, seq, self.state);
                self.know(now, &by, line);
            }
            Arrival::Appeared { name, line } => {
                self.know(now, &name, line);
                self.tell(now, Input::Neighbour { name, there: true });
            }
            Arrival::Input(input) => {
                let reply = self.tell(now, input);
                match reply {
                    Some(Reply::Goal(result)) => self.respond(sender, Response::Goal(result)),
                    Some(Reply::Command(result)) => self.respond(sender, Response::Command(result)),
                    Some(Reply::Instruction(_)) | None => {
                        self.respond(sender, Response::Noted);
                    }
                }
            }
        }
    }

    /// Its process is about to end ([`Machine::wind_down`](super::Machine::wind_down)).
    pub fn wind_down(&mut self, now: Time) {
        self.state += 1;
        self.dirty = true;
        self.machine.wind_down(now);
        self.collect();
    }

    /// A numbered instruction.
    fn instruction(&mut self, now: Time, message: Envelope<Instruction>, sender: Option<T>) {
        let receipt = self.mailboxes.instructions_in.receive(&message);
        let Some(opened) = self.open(receipt, message.seq, sender) else {
            return;
        };
        self.know(now, &message.from, message.line);
        if message.to_line != 0 && message.to_line != self.line {
            // Its number counts for nothing: the sender gives up all that it has not had answered.
            let reason = "it was meant for one who has lost its memory since".to_owned();
            let answer = Some(Answer::Rejected { reason });
            let seq = message.seq;
            return self.respond(opened.sender, Response::Applied { seq, answer });
        }
        let instruction = message.body.clone();
        let ahead = self.ahead.get(&message.from).cloned();
        // A superior that has started again may have decided otherwise: what ran ahead had not been
        // written down.
        let ahead = ahead.filter(|ahead| ahead.epoch == message.epoch);
        let answer = match &ahead {
            // It was followed when it ran ahead; how it ends is reported.
            Some(ahead) if ahead.stopping && ahead.seq == message.seq => Answer::Suspending,
            _ => self.instruct_machine(now, &message.from, instruction),
        };
        if let Some(ahead) = ahead {
            if ahead.seq <= message.seq {
                self.ahead.remove(&message.from);
            } else if starts(&message.body, &ahead.id) {
                // What starts it was overtaken by what stops it: no motion comes of it.
                self.try_to_stop(now, &message.from, ahead);
            }
        }
        self.answered(&message, answer, opened.sender);
    }

    /// A numbered instruction has been seen to.
    fn answered<B>(&mut self, message: &Envelope<B>, answer: Answer, sender: Option<T>) {
        let inbox = &mut self.mailboxes.instructions_in;
        inbox.applied(message, Some(answer.clone()));
        let (seq, answer) = (message.seq, Some(answer));
        self.respond(sender, Response::Applied { seq, answer });
    }

    /// A copy of an instruction to suspend, ahead of its turn. It is not answered.
    fn stop_ahead(&mut self, now: Time, message: &Envelope<Instruction>) {
        if self.mailboxes.instructions_in.is_past(message) {
            return;
        }
        if let Instruction::Suspend { id } = &message.body {
            let ahead = Ahead {
                epoch: message.epoch,
                seq: message.seq,
                id: id.clone(),
                stopping: false,
            };
            if self.machine.is_suspended(&message.from, &ahead.id) {
                // What resumes it is still on its way. A report that it is suspended would be
                // taken for the end of what has not begun.
                self.ahead.insert(message.from.clone(), ahead);
            } else {
                self.try_to_stop(now, &message.from, ahead);
            }
        }
    }

    fn try_to_stop(&mut self, now: Time, superior: &Symbol, mut ahead: Ahead) {
        let id = ahead.id.clone();
        let answer = self.instruct_machine(now, superior, Instruction::Suspend { id });
        ahead.stopping = answer == Answer::Suspending;
        self.ahead.insert(superior.clone(), ahead);
    }

    fn instruct_machine(&mut self, now: Time, from: &Symbol, instruction: Instruction) -> Answer {
        let from = from.clone();
        match self.tell(now, Input::Instruction { from, instruction }) {
            Some(Reply::Instruction(answer)) => answer,
            // Whoever waits is told so rather than left waiting.
            _ => Answer::Rejected {
                reason: "the machine gave no answer, which is a fault in it".to_owned(),
            },
        }
    }

    /// Sees to what is not to be applied.
    fn open(&mut self, receipt: Receipt<Answer>, seq: u64, sender: Option<T>) -> Option<Opened<T>> {
        let response = match receipt {
            Receipt::New { reborn } => return Some(Opened { reborn, sender }),
            Receipt::Again(answer) => Response::Applied { seq, answer },
            Receipt::Old => Response::Superseded { seq },
            Receipt::Gap { due } => Response::Gap { seq, due },
        };
        self.respond(sender, response);
        None
    }

    /// A neighbour's memory begins in that epoch.
    fn know(&mut self, now: Time, name: &Symbol, line: u64) {
        match self.neighbours.insert(name.clone(), line) {
            Some(before) if before < line => {
                self.ahead.remove(name);
                self.give_up_instructions(name);
                let name = name.clone();
                self.tell(now, Input::Reborn { name });
            }
            Some(before) if before > line => {
                self.neighbours.insert(name.clone(), before);
            }
            _ => {}
        }
    }

    /// What an executor was told that has lost its memory is not for it any more: nobody knows
    /// whether it was done, and the machine decides anew.
    fn give_up_instructions(&mut self, executor: &Symbol) {
        self.mailboxes.give_up_instructions(executor);
        let stays = |effect: &Effect<M::Out, T>| !matches!(effect, Effect::Instruct { to, .. } | Effect::StopAhead { to, .. } if to == executor);
        self.held.retain(|(_, effect)| stays(effect));
        self.ready.retain(stays);
    }

    fn tell(&mut self, now: Time, input: Input<M::In>) -> Option<Reply> {
        let reply = self.machine.handle(now, input);
        self.collect();
        reply
    }
}

/// A message that is to be applied.
struct Opened<T> {
    reborn: bool,
    sender: Option<T>,
}
