//! Once and in order, over a wire that loses, repeats and delays, between processes that die.

use std::collections::{BTreeMap, VecDeque};

use serde::{Deserialize, Serialize};

use crate::model::Symbol;

/// A message with what is needed to apply it once.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct Envelope<T> {
    /// Who sends.
    pub from: Symbol,
    /// The epoch in which the sender's memory begins. A greater one than before means that the
    /// sender has lost its memory, and counts from 1.
    pub line: u64,
    /// Of the sender's start: greater at every start. A lower one than before is that of a process
    /// that has been replaced.
    pub epoch: u64,
    /// Counts from 1 within the line, for one receiver; goes on where it was after a restart.
    pub seq: u64,
    /// The sender has written down the answers up to this number: nobody will ask for them again.
    pub settled: u64,
    /// The receiver's line as the sender knows it, 0 if it does not: what was meant for somebody who
    /// has lost its memory since is not for whoever has come in its place.
    pub to_line: u64,
    /// What is sent.
    pub body: T,
}

impl<T> Envelope<T> {
    /// The same message in other words.
    pub fn map<U>(self, words: impl FnOnce(T) -> U) -> Envelope<U> {
        let Self {
            from,
            line,
            epoch,
            seq,
            settled,
            to_line,
            body,
        } = self;
        Envelope {
            from,
            line,
            epoch,
            seq,
            settled,
            to_line,
            body: words(body),
        }
    }
}

/// What is to be sent to one receiver and is not acknowledged yet, oldest first.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Outbox<T> {
    next_seq: u64,
    waiting: VecDeque<(u64, T)>,
}

impl<T> Default for Outbox<T> {
    fn default() -> Self {
        Self {
            next_seq: 1,
            waiting: VecDeque::new(),
        }
    }
}

impl<T> Outbox<T> {
    /// With these messages, in order, and all before `next_seq` that are not among them
    /// acknowledged. `None` if that cannot be.
    pub fn with(next_seq: u64, waiting: impl IntoIterator<Item = (u64, T)>) -> Option<Self> {
        let waiting: VecDeque<_> = waiting.into_iter().collect();
        let count = u64::try_from(waiting.len()).ok()?;
        let first = next_seq.checked_sub(count).filter(|first| *first > 0)?;
        let numbers = waiting.iter().map(|(seq, _)| *seq);
        numbers
            .eq(first..next_seq)
            .then_some(Self { next_seq, waiting })
    }

    /// Adds a message behind the others. Returns its number.
    pub fn push(&mut self, body: T) -> u64 {
        let seq = self.next_seq;
        self.next_seq += 1;
        self.waiting.push_back((seq, body));
        seq
    }

    /// The number of the next message.
    pub fn next_seq(&self) -> u64 {
        self.next_seq
    }

    /// Messages up to this number are acknowledged.
    pub fn acknowledged(&self) -> u64 {
        let waiting = self.waiting.front().map(|(seq, _)| *seq);
        waiting.unwrap_or(self.next_seq) - 1
    }

    /// The number of the oldest message that waits, or of the next if none does, and that of the
    /// next: as long as they are the same, the same messages wait.
    pub fn extent(&self) -> (u64, u64) {
        (self.acknowledged() + 1, self.next_seq)
    }

    /// What is not acknowledged.
    pub fn waiting(&self) -> impl Iterator<Item = (u64, &T)> {
        self.waiting.iter().map(|(seq, body)| (*seq, body))
    }

    /// The receiver has lost its memory: what was meant for it is not sent any more.
    pub fn give_up(&mut self) {
        self.waiting.clear();
    }

    /// The receiver has answered message `seq`. Returns it; `None` if that was known already.
    pub fn acknowledge(&mut self, seq: u64) -> Option<T> {
        if self.waiting.front()?.0 != seq {
            return None;
        }
        self.waiting.pop_front().map(|(_, body)| body)
    }
}

/// What a receiver makes of a message.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Receipt<A> {
    /// Apply it, then [`Inbox::applied`] with the answer.
    New {
        /// Whether the sender has lost its memory since it was heard last.
        reborn: bool,
    },
    /// It was applied before; the same answer again. `None`: the sender has written it down long
    /// since, or there was none.
    Again(Option<A>),
    /// From a process that has been replaced: refuse, it has to end.
    Old,
    /// Something before it is missing: refuse, the sender will repeat in order.
    Gap {
        /// The number that is due.
        due: u64,
    },
}

/// What has been received, by sender.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Inbox<A> {
    senders: BTreeMap<Symbol, Heard<A>>,
}

/// What has been received from one sender.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct Heard<A> {
    line: u64,
    epoch: u64,
    /// The last number that was applied.
    seq: u64,
    /// Those that the sender may ask for again.
    answers: BTreeMap<u64, A>,
}

impl<A> Heard<A> {
    /// Different after every message that was applied.
    pub fn mark(&self) -> (u64, u64, u64) {
        (self.line, self.epoch, self.seq)
    }

    /// The epoch and the number of the last message that was applied.
    pub fn last(&self) -> (u64, u64) {
        (self.epoch, self.seq)
    }
}

impl<A> Default for Inbox<A> {
    fn default() -> Self {
        Self {
            senders: BTreeMap::new(),
        }
    }
}

impl<A: Clone> Inbox<A> {
    /// With what was heard from each sender.
    pub fn with(senders: impl IntoIterator<Item = (Symbol, Heard<A>)>) -> Self {
        Self {
            senders: senders.into_iter().collect(),
        }
    }

    /// What was heard, by sender.
    pub fn senders(&self) -> impl Iterator<Item = (&Symbol, &Heard<A>)> {
        self.senders.iter()
    }

    /// Whether to apply a message.
    pub fn receive<T>(&self, message: &Envelope<T>) -> Receipt<A> {
        let Some(last) = self.senders.get(&message.from) else {
            // Never heard of: a receiver that has lost its memory cannot know what went before,
            // and takes the sender's word.
            return Receipt::New { reborn: false };
        };
        if message.line < last.line || message.epoch < last.epoch {
            return Receipt::Old;
        }
        if message.line > last.line {
            return match message.seq {
                1 => Receipt::New { reborn: true },
                _ => Receipt::Gap { due: 1 },
            };
        }
        if message.seq <= last.seq {
            Receipt::Again(last.answers.get(&message.seq).cloned())
        } else if message.seq == last.seq + 1 {
            Receipt::New { reborn: false }
        } else {
            Receipt::Gap { due: last.seq + 1 }
        }
    }

    /// Whether a message of that number or a later one of its sender was applied, or the sender
    /// has been replaced.
    pub fn is_past<T>(&self, message: &Envelope<T>) -> bool {
        match self.receive(message) {
            Receipt::New { .. } | Receipt::Gap { .. } => false,
            Receipt::Again(_) | Receipt::Old => true,
        }
    }

    /// A message that was [`Receipt::New`] has been applied, with this answer.
    pub fn applied<T>(&mut self, message: &Envelope<T>, answer: Option<A>) {
        let known = self.senders.remove(&message.from);
        let known = known.filter(|known| known.line == message.line);
        let mut answers = known.map_or_else(BTreeMap::new, |known| known.answers);
        answers.retain(|seq, _| *seq > message.settled);
        answers.extend(answer.map(|answer| (message.seq, answer)));
        let heard = Heard {
            line: message.line,
            epoch: message.epoch,
            seq: message.seq,
            answers,
        };
        self.senders.insert(message.from.clone(), heard);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEW: Receipt<&str> = Receipt::New { reborn: false };

    fn message(line: u64, epoch: u64, seq: u64) -> Envelope<()> {
        Envelope {
            from: "parent".into(),
            line,
            epoch,
            seq,
            settled: 0,
            to_line: 0,
            body: (),
        }
    }

    #[test]
    fn a_repeated_message_gets_the_same_answer_and_is_not_applied() {
        let mut inbox = Inbox::default();
        assert_eq!(inbox.receive(&message(1, 1, 1)), NEW);
        inbox.applied(&message(1, 1, 1), Some("first"));
        assert_eq!(
            inbox.receive(&message(1, 1, 1)),
            Receipt::Again(Some("first"))
        );
        assert_eq!(inbox.receive(&message(1, 1, 3)), Receipt::Gap { due: 2 });
        inbox.applied(&message(1, 1, 2), Some("second"));
        assert_eq!(
            inbox.receive(&message(1, 1, 1)),
            Receipt::Again(Some("first"))
        );
    }

    #[test]
    fn answers_are_kept_until_the_sender_has_written_them_down() {
        let mut inbox = Inbox::default();
        inbox.applied(&message(1, 1, 1), Some("first"));
        let next = Envelope {
            settled: 1,
            ..message(1, 1, 2)
        };
        inbox.applied(&next, Some("second"));
        assert_eq!(inbox.receive(&message(1, 1, 1)), Receipt::Again(None));
        assert_eq!(
            inbox.receive(&message(1, 1, 2)),
            Receipt::Again(Some("second"))
        );
    }

    #[test]
    fn a_restarted_sender_goes_on_counting_and_the_process_before_it_is_refused() {
        let mut inbox = Inbox::default();
        inbox.applied(&message(5, 5, 7), Some("done"));
        assert_eq!(inbox.receive(&message(5, 6, 8)), NEW);
        inbox.applied(&message(5, 6, 8), Some("done"));
        assert_eq!(inbox.receive(&message(5, 5, 9)), Receipt::Old);
    }

    #[test]
    fn a_sender_that_has_lost_its_memory_counts_from_one() {
        let mut inbox = Inbox::default();
        inbox.applied(&message(5, 5, 7), Some("done"));
        assert_eq!(inbox.receive(&message(6, 6, 2)), Receipt::Gap { due: 1 });
        assert_eq!(
            inbox.receive(&message(6, 6, 1)),
            Receipt::New { reborn: true }
        );
        inbox.applied(&message(6, 6, 1), Some("again"));
        assert_eq!(inbox.receive(&message(5, 5, 8)), Receipt::Old);
    }

    #[test]
    fn an_outbox_forgets_a_message_when_it_is_acknowledged_in_order() {
        let mut outbox = Outbox::default();
        assert_eq!((outbox.push("a"), outbox.push("b")), (1, 2));
        assert_eq!(outbox.acknowledge(2), None);
        assert_eq!(outbox.acknowledge(1), Some("a"));
        assert_eq!(outbox.acknowledge(1), None);
        assert_eq!(outbox.waiting().collect::<Vec<_>>(), [(2, &"b")]);
        assert_eq!((outbox.acknowledged(), outbox.next_seq()), (1, 3));
    }

    #[test]
    fn an_outbox_with_a_hole_is_none() {
        assert_eq!(
            Outbox::with(4, [(2, "b"), (3, "c")]).map(|o| o.acknowledged()),
            Some(1)
        );
        assert_eq!(Outbox::with(4, [(1, "a"), (3, "c")]), None);
        assert_eq!(Outbox::with(1, [(0, "a")]), None);
        assert_eq!(Outbox::<()>::with(0, []), None);
    }
}
