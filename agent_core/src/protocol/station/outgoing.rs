//! What leaves: not before what it depends on is written down, save what stops.

use super::{Effect, Response, Station};
use crate::model::Symbol;
use crate::protocol::{
    ActionId, Durable, Envelope, Event, Happening, Instruction, Output, ReportBody,
};

/// How many of the latest events about goals that were accepted or have ended are told again after
/// a restart: what was written down may have died with the process before it was told.
const TOLD_AGAIN: usize = 32;

impl<M: Durable, T> Station<M, T>
where
    M::Out: Clone,
{
    /// What [`write_down`](Self::write_down) has returned is on the disk.
    pub fn written(&mut self) {
        let Some(state) = self.writing.take() else {
            return;
        };
        self.mailboxes.settle(state);
        let written = self
            .held
            .partition_point(|(waits_for, _)| *waits_for <= state);
        let released: Vec<_> = self
            .held
            .drain(..written)
            .map(|(_, effect)| effect)
            .collect();
        // What is told to start only now is stopped at once if that was decided meanwhile: neither the
        // next writing nor the answer to the start is waited for.
        let still_held = self.held.iter().map(|(_, effect)| effect);
        let ahead: Vec<_> = released
            .iter()
            .chain(still_held)
            .filter_map(|effect| {
                let Effect::Instruct { to, message } = effect else {
                    return None;
                };
                let Instruction::Suspend { id } = &message.body else {
                    return None;
                };
                let starts_now = released.iter().any(|effect| starts_at(effect, to, id));
                let (to, message) = (to.clone(), message.clone());
                starts_now.then_some(Effect::StopAhead { to, message })
            })
            .collect();
        self.ready.extend(released);
        self.ready.extend(ahead);
    }

    /// Everything that waits may go out, written down or not: for a station without a journal, and
    /// for the world, which waits for nobody's disk.
    pub fn release(&mut self) {
        self.mailboxes.settle(self.state);
        let released = self.held.drain(..).map(|(_, effect)| effect);
        self.ready.extend(released);
    }

    /// Those who wait for a response that waits for the disk, when that cannot be written: they are
    /// to be told so. What they have asked for has happened all the same, and a message that is
    /// repeated is answered once it is written down.
    pub fn refuse_waiting(&mut self) -> Vec<T> {
        let mut waiting = Vec::new();
        let held = std::mem::take(&mut self.held).into_iter();
        self.held = held
            .filter_map(|(state, effect)| match effect {
                Effect::Respond { to, .. } => {
                    waiting.push(to);
                    None
                }
                effect => Some((state, effect)),
            })
            .collect();
        waiting
    }

    /// The next thing that may go out now.
    pub fn poll_effect(&mut self) -> Option<Effect<M::Out, T>> {
        let mut effect = self.ready.pop_front()?;
        // Stamped as late as possible, so that neighbours can forget as much as possible.
        match &mut effect {
            Effect::Instruct { to, message } => {
                message.settled = self.mailboxes.instructions_settled(to);
                message.to_line = self.neighbours.get(to).copied().unwrap_or(0);
            }
            Effect::Report { to, message } => message.settled = self.mailboxes.reports_settled(to),
            _ => {}
        }
        Some(effect)
    }

    pub(super) fn respond(&mut self, to: Option<T>, response: Response) {
        if let Some(to) = to {
            self.hold(Effect::Respond {
                to,
                response,
                line: self.line,
            });
        }
    }

    pub(super) fn hold(&mut self, effect: Effect<M::Out, T>) {
        self.held.push_back((self.state, effect));
    }

    /// Takes all that the machine has decided.
    pub(super) fn collect(&mut self) {
        while let Some(output) = self.machine.poll_output() {
            // What has something to say has found something new, even if it was only woken.
            self.dirty = true;
            match output {
                Output::Instruct { to, instruction } => self.send_instruction(to, instruction),
                Output::Report { to, id, report } => {
                    let body = ReportBody { id, report };
                    let seq = self.mailboxes.push_report(&to, body.clone());
                    let message = self.envelope(seq, body);
                    self.hold(Effect::Report { to, message });
                }
                Output::Observed { facts, reported_to } => {
                    self.hold(Effect::Observed { facts, reported_to });
                }
                Output::Seen {
                    to,
                    facts,
                    reported,
                } => self.hold(Effect::Seen {
                    to,
                    facts,
                    reported,
                }),
                Output::Event(event) => self.tell_event(event),
                Output::Local(local) => {
                    let message = self.mailboxes.local_message(&self.name, self.epoch, local);
                    let waits = self.held.iter();
                    let mut waits = waits.filter(|(_, e)| matches!(e, Effect::Local(_)));
                    let at_once = M::is_stop(&message.body) && waits.next().is_none();
                    let effect = Effect::Local(message);
                    if at_once {
                        self.ready.push_back(effect);
                    } else {
                        self.hold(effect);
                    }
                }
            }
        }
    }

    pub(super) fn send_instruction(&mut self, to: Symbol, instruction: Instruction) {
        let seq = self.mailboxes.push_instruction(&to, instruction.clone());
        let message = self.envelope(seq, instruction);
        if let Instruction::Suspend { id } = &message.body {
            // What has not been told to start yet need not be stopped ahead.
            let mut held = self.held.iter().map(|(_, effect)| effect);
            let starting = held.any(|effect| starts_at(effect, &to, id));
            if !starting {
                let (to, message) = (to.clone(), message.clone());
                self.ready.push_back(Effect::StopAhead { to, message });
            }
        }
        self.hold(Effect::Instruct { to, message });
    }

    pub(super) fn tell_event(&mut self, event: Event) {
        let number = self.next_event;
        self.next_event += 1;
        let lasting = matches!(
            event.what,
            Happening::GoalAccepted { .. }
                | Happening::GoalSucceeded
                | Happening::GoalFailed { .. }
                | Happening::GoalUnknown { .. }
        );
        if lasting {
            self.last_ends.push_back((number, event.clone()));
            if self.last_ends.len() > TOLD_AGAIN {
                self.last_ends.pop_front();
            }
        }
        self.hold(Effect::Event { number, event });
    }

    pub(super) fn envelope<B>(&self, seq: u64, body: B) -> Envelope<B> {
        Envelope {
            from: self.name.clone(),
            line: self.line,
            epoch: self.epoch,
            seq,
            settled: 0,
            to_line: 0,
            body,
        }
    }
}

/// Whether something tells an executor to start an execution.
fn starts_at<O, T>(effect: &Effect<O, T>, executor: &Symbol, id: &ActionId) -> bool {
    match effect {
        Effect::Instruct { to, message } => to == executor && starts(&message.body, id),
        _ => false,
    }
}

pub(super) fn starts(instruction: &Instruction, id: &ActionId) -> bool {
    match instruction {
        Instruction::Execute { .. } | Instruction::Resume { .. } => instruction.id() == id,
        Instruction::Suspend { .. } | Instruction::Clear { .. } => false,
    }
}
