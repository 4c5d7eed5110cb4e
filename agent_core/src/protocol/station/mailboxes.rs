//! What was received and what is to be sent, by neighbour.

use std::collections::BTreeMap;

use crate::model::Symbol;
use crate::protocol::delivery::{Envelope, Inbox, Outbox};
use crate::protocol::{Answer, Instruction, ReportBody};

/// The mailboxes of a station. Those to elsewhere do not outlive the process: a robot that starts
/// again first halts, and what it was told before counts no more.
#[derive(Clone, Debug)]
pub(super) struct Mailboxes {
    pub(super) instructions_in: Inbox<Answer>,
    pub(super) reports_in: Inbox<Answer>,
    pub(super) local_in: Inbox<Answer>,
    pub(super) instructions_out: BTreeMap<Symbol, Sending<Instruction>>,
    pub(super) reports_out: BTreeMap<Symbol, Sending<ReportBody>>,
    next_local: u64,
}

/// An outbox, and what the receiver's answers may be forgotten up to.
#[derive(Clone, Debug)]
pub(super) struct Sending<B> {
    pub(super) outbox: Outbox<B>,
    /// Answers up to this number have been written down.
    settled: u64,
    /// In this state the last answer came.
    answered_in: u64,
}

impl<B> Sending<B> {
    pub(super) fn of(outbox: Outbox<B>) -> Self {
        Self {
            settled: outbox.acknowledged(),
            answered_in: 0,
            outbox,
        }
    }
}

impl<B> Default for Sending<B> {
    fn default() -> Self {
        Self::of(Outbox::default())
    }
}

impl Default for Mailboxes {
    fn default() -> Self {
        Self {
            instructions_in: Inbox::default(),
            reports_in: Inbox::default(),
            local_in: Inbox::default(),
            instructions_out: BTreeMap::new(),
            reports_out: BTreeMap::new(),
            next_local: 1,
        }
    }
}

impl Mailboxes {
    pub(super) fn push_instruction(&mut self, to: &Symbol, instruction: Instruction) -> u64 {
        let sending = self.instructions_out.entry(to.clone()).or_default();
        sending.outbox.push(instruction)
    }

    pub(super) fn push_report(&mut self, to: &Symbol, report: ReportBody) -> u64 {
        let sending = self.reports_out.entry(to.clone()).or_default();
        sending.outbox.push(report)
    }

    /// The next message to elsewhere: of a line that begins with this start.
    pub(super) fn local_message<O>(&mut self, from: &Symbol, epoch: u64, body: O) -> Envelope<O> {
        let seq = self.next_local;
        self.next_local += 1;
        Envelope {
            from: from.clone(),
            line: epoch,
            epoch,
            seq,
            settled: 0,
            to_line: 0,
            body,
        }
    }

    /// The instruction that was answered, if that is news.
    pub(super) fn instruction_answered(
        &mut self,
        by: &Symbol,
        seq: u64,
        state: u64,
    ) -> Option<Instruction> {
        let sending = self.instructions_out.get_mut(by)?;
        let instruction = sending.outbox.acknowledge(seq)?;
        sending.answered_in = state;
        Some(instruction)
    }

    pub(super) fn give_up_instructions(&mut self, to: &Symbol) {
        if let Some(sending) = self.instructions_out.get_mut(to) {
            sending.outbox.give_up();
        }
    }

    pub(super) fn report_delivered(&mut self, by: &Symbol, seq: u64, state: u64) {
        if let Some(sending) = self.reports_out.get_mut(by)
            && sending.outbox.acknowledge(seq).is_some()
        {
            sending.answered_in = state;
        }
    }

    /// That state has been written down.
    pub(super) fn settle(&mut self, state: u64) {
        for sending in self.instructions_out.values_mut() {
            sending.settle(state);
        }
        for sending in self.reports_out.values_mut() {
            sending.settle(state);
        }
    }

    /// By receiver, up to where answers have been written down, and whether the last one that came is
    /// `included` in a writing; instructions first.
    pub(super) fn settled(&self, included: impl Fn(u64) -> bool) -> Vec<(u64, bool, u64)> {
        let instructions = self.instructions_out.values();
        let reports = self.reports_out.values();
        let of = |settled, answered_in, next| (settled, included(answered_in), next);
        instructions
            .map(|s| of(s.settled, s.answered_in, s.outbox.next_seq()))
            .chain(reports.map(|s| of(s.settled, s.answered_in, s.outbox.next_seq())))
            .collect()
    }

    pub(super) fn instructions_settled(&self, to: &Symbol) -> u64 {
        self.instructions_out.get(to).map_or(0, |s| s.settled)
    }

    pub(super) fn reports_settled(&self, to: &Symbol) -> u64 {
        self.reports_out.get(to).map_or(0, |s| s.settled)
    }
}

impl<B> Sending<B> {
    fn settle(&mut self, state: u64) {
        if self.answered_in <= state {
            self.settled = self.outbox.acknowledged();
        }
    }
}
