//! Once and in order, over a wire that loses, repeats and delays.

use std::collections::{BTreeMap, VecDeque};

use serde::{Deserialize, Serialize};

use crate::model::Symbol;

/// A message with what is needed to apply it once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Envelope<T> {
    /// Who sends.
    pub from: Symbol,
    /// New, and greater, at every start of the sender.
    pub epoch: u64,
    /// Counts from 1 within the epoch, for one receiver.
    pub seq: u64,
    /// What is sent.
    pub body: T,
}

/// What is to be sent to one receiver, oldest first. Only the oldest is on the wire at a time, and
/// stays there until it is acknowledged.
#[derive(Clone, Debug, PartialEq)]
pub struct Outbox<T> {
    from: Symbol,
    epoch: u64,
    next_seq: u64,
    waiting: VecDeque<Envelope<T>>,
}

impl<T: Clone> Outbox<T> {
    /// Empty, for a sender that has just started.
    pub fn new(from: Symbol, epoch: u64) -> Self {
        Self {
            from,
            epoch,
            next_seq: 1,
            waiting: VecDeque::new(),
        }
    }

    /// Adds a message behind the others.
    pub fn push(&mut self, body: T) {
        self.waiting.push_back(Envelope {
            from: self.from.clone(),
            epoch: self.epoch,
            seq: self.next_seq,
            body,
        });
        self.next_seq += 1;
    }

    /// What is to be sent now, and sent again until it is acknowledged.
    pub fn front(&self) -> Option<&Envelope<T>> {
        self.waiting.front()
    }

    /// The receiver has answered message `seq`. Returns it; `None` if that was known already.
    pub fn acknowledged(&mut self, seq: u64) -> Option<T> {
        if self.waiting.front()?.seq != seq {
            return None;
        }
        self.waiting.pop_front().map(|envelope| envelope.body)
    }
}

/// What a receiver makes of a message.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Receipt<A> {
    /// Apply it, then [`Inbox::applied`] with the answer.
    New,
    /// It was applied before; the same answer again.
    Again(A),
    /// From before the sender's last start, or from before what was answered last: refuse.
    Old,
    /// Something before it is missing: refuse, the sender will repeat in order.
    Gap {
        /// The number that is due.
        due: u64,
    },
}

/// What has been received, by sender.
#[derive(Clone, Debug, PartialEq)]
pub struct Inbox<A> {
    /// Last epoch, last number applied, and the answer to it.
    senders: BTreeMap<Symbol, (u64, u64, A)>,
}

impl<A> Default for Inbox<A> {
    fn default() -> Self {
        Self {
            senders: BTreeMap::new(),
        }
    }
}

impl<A: Clone> Inbox<A> {
    /// Whether to apply a message.
    pub fn receive<T>(&self, message: &Envelope<T>) -> Receipt<A> {
        let (epoch, seq) = (message.epoch, message.seq);
        match self.senders.get(&message.from) {
            Some((last_epoch, _, _)) if epoch < *last_epoch => Receipt::Old,
            Some((last_epoch, last_seq, answer)) if epoch == *last_epoch => {
                if seq == *last_seq {
                    Receipt::Again(answer.clone())
                } else if seq < *last_seq {
                    Receipt::Old
                } else if seq == last_seq + 1 {
                    Receipt::New
                } else {
                    Receipt::Gap { due: last_seq + 1 }
                }
            }
            // A new epoch, or a sender never heard of, counts from one.
            _ if seq == 1 => Receipt::New,
            // A receiver that has itself restarted cannot know what went before; it takes the
            // sender's word. Journals close this gap.
            None => Receipt::New,
            Some(_) => Receipt::Gap { due: 1 },
        }
    }

    /// A message that was [`Receipt::New`] has been applied, with this answer.
    pub fn applied<T>(&mut self, message: &Envelope<T>, answer: A) {
        self.senders
            .insert(message.from.clone(), (message.epoch, message.seq, answer));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(epoch: u64, seq: u64) -> Envelope<&'static str> {
        Envelope {
            from: "parent".into(),
            epoch,
            seq,
            body: "",
        }
    }

    #[test]
    fn a_repeated_message_gets_the_same_answer_and_is_not_applied() {
        let mut inbox = Inbox::default();
        assert_eq!(inbox.receive(&message(1, 1)), Receipt::New);
        inbox.applied(&message(1, 1), "first");
        assert_eq!(inbox.receive(&message(1, 1)), Receipt::Again("first"));
        assert_eq!(inbox.receive(&message(1, 3)), Receipt::Gap { due: 2 });
        inbox.applied(&message(1, 2), "second");
        assert_eq!(inbox.receive(&message(1, 1)), Receipt::Old);
    }

    #[test]
    fn a_message_of_an_old_epoch_is_refused_and_a_new_epoch_counts_from_one() {
        let mut inbox = Inbox::default();
        inbox.applied(&message(5, 7), "done");
        assert_eq!(inbox.receive(&message(4, 8)), Receipt::Old);
        assert_eq!(inbox.receive(&message(6, 2)), Receipt::Gap { due: 1 });
        assert_eq!(inbox.receive(&message(6, 1)), Receipt::New);
    }

    #[test]
    fn an_outbox_holds_back_what_follows_until_the_first_is_acknowledged() {
        let mut outbox = Outbox::new("parent".into(), 3);
        outbox.push("a");
        outbox.push("b");
        assert_eq!(outbox.front().map(|m| (m.seq, m.body)), Some((1, "a")));
        assert_eq!(outbox.acknowledged(2), None);
        assert_eq!(outbox.acknowledged(1), Some("a"));
        assert_eq!(outbox.acknowledged(1), None);
        assert_eq!(outbox.front().map(|m| (m.seq, m.body)), Some((2, "b")));
    }
}
