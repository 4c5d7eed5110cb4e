//! Facts that an agent tells its superiors without having been asked to bring them about.
//!
//! They are published, and a publication may be lost or come before anyone listens. So they are
//! numbered, the agent keeps what it has said last about each fact, and a superior that is new, or
//! sees that it has missed something, asks for all of it.

use std::collections::BTreeMap;

use agent_core::model::{Fact, FactChange, Symbol};

use crate::wire::Observed;

/// What an agent has told all its superiors, or one of them.
#[derive(Debug)]
pub(crate) struct Board {
    epoch: u64,
    seq: u64,
    /// The last word about each fact, and about each value (`true`).
    last: BTreeMap<(bool, Fact), FactChange>,
}

impl Board {
    pub(crate) fn new(epoch: u64) -> Self {
        Self {
            epoch,
            seq: 0,
            last: BTreeMap::new(),
        }
    }

    /// Notes facts, and gives the message that tells them.
    pub(crate) fn tell(&mut self, facts: &[FactChange], reported_to: Option<&Symbol>) -> Observed {
        for change in facts {
            let key = match change {
                FactChange::Add(fact) | FactChange::Remove(fact) => (false, fact.clone()),
                FactChange::Set(function, _) => (true, function.clone()),
            };
            self.last.insert(key, change.clone());
        }
        self.seq += 1;
        Observed::new(self.epoch, self.seq, facts, reported_to)
    }

    /// The same for all that can be told now: what was told before may be so no more.
    pub(crate) fn tell_anew(
        &mut self,
        facts: &[FactChange],
        reported_to: Option<&Symbol>,
    ) -> Observed {
        self.last.clear();
        self.tell(facts, reported_to)
    }

    /// All that has been told.
    pub(crate) fn all(&self) -> Observed {
        let facts: Vec<FactChange> = self.last.values().cloned().collect();
        Observed::new(self.epoch, self.seq, &facts, None)
    }
}

/// How much of a [`Board`] a superior knows.
#[derive(Debug, Default)]
pub(crate) struct Reader {
    /// Epoch and number of the last message.
    last: Option<(u64, u64)>,
}

/// What to do about a published message.
#[derive(Debug, PartialEq)]
pub(crate) enum Reading {
    /// New facts.
    Take(Vec<FactChange>),
    /// Nothing new.
    Ignore,
    /// Something before it is missing: ask for all.
    Missed,
}

impl Reader {
    /// Takes a published message, as `own`.
    pub(crate) fn published(&mut self, message: Observed, own: &str) -> Reading {
        let at = (message.epoch, message.seq);
        let due = match self.last {
            Some(last) if at <= last => return Reading::Ignore,
            Some((epoch, seq)) if epoch == message.epoch => seq + 1,
            _ => 1,
        };
        if message.seq != due {
            return Reading::Missed;
        }
        self.last = Some(at);
        if message.reported_to.as_deref() == Some(own) {
            // The report comes by itself, and in order with what follows it.
            return Reading::Ignore;
        }
        take(message)
    }

    /// Takes the answer to the question for all.
    pub(crate) fn all(&mut self, message: Observed) -> Reading {
        let at = (message.epoch, message.seq);
        if message.seq == 0 || self.last.is_some_and(|last| at <= last) {
            return Reading::Ignore;
        }
        self.last = Some(at);
        take(message)
    }
}

fn take(message: Observed) -> Reading {
    match message.into_facts() {
        facts if facts.is_empty() => Reading::Ignore,
        facts => Reading::Take(facts),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use agent_core::model::Atom;

    fn at(node: &str) -> FactChange {
        FactChange::Add(Atom::new("at", [node]))
    }

    fn not_at(node: &str) -> FactChange {
        FactChange::Remove(Atom::new("at", [node]))
    }

    #[test]
    fn a_superior_that_missed_something_asks_for_all_and_goes_on_from_there() {
        let mut board = Board::new(7);
        let mut reader = Reader::default();
        let first = board.tell(&[at("n1")], None);
        assert_eq!(
            reader.published(first.clone(), "child"),
            Reading::Take(vec![at("n1")])
        );
        assert_eq!(reader.published(first, "child"), Reading::Ignore);
        let _lost = board.tell(&[not_at("n1"), at("n2")], None);
        let third = board.tell(&[FactChange::Set(Atom::new("charge", []), 0.5)], None);
        assert_eq!(reader.published(third, "child"), Reading::Missed);
        let Reading::Take(all) = reader.all(board.all()) else {
            unreachable!("the answer is newer than what is known")
        };
        assert_eq!(all.len(), 3);
        assert!(all.contains(&not_at("n1")) && all.contains(&at("n2")));
        assert_eq!(reader.all(board.all()), Reading::Ignore);
        let fourth = board.tell(&[at("n3")], None);
        assert_eq!(
            reader.published(fourth, "child"),
            Reading::Take(vec![at("n3")])
        );
    }

    #[test]
    fn facts_that_are_in_a_report_already_are_taken_from_there() {
        let mut board = Board::new(7);
        let mut reader = Reader::default();
        let told = board.tell(&[at("n1")], Some(&"child".into()));
        assert_eq!(reader.published(told, "child"), Reading::Ignore);
        let told = board.tell(&[at("n2")], Some(&"other".into()));
        assert_eq!(
            reader.published(told, "child"),
            Reading::Take(vec![at("n2")])
        );
    }

    #[test]
    fn what_is_told_anew_takes_the_place_of_what_was_told() {
        let mut board = Board::new(7);
        let mut k3 = Reader::default();
        let seen = |facts: &[FactChange]| Reading::Take(facts.to_vec());
        let first = board.tell_anew(&[at("n1"), not_at("n2")], None);
        assert_eq!(k3.published(first, "k3"), seen(&[at("n1"), not_at("n2")]));
        let in_a_report = board.tell_anew(&[not_at("n1")], Some(&"k3".into()));
        assert_eq!(k3.published(in_a_report, "k3"), Reading::Ignore);
        let _lost = board.tell_anew(&[at("n3")], None);
        let last = board.tell_anew(&[at("n4")], None);
        assert_eq!(k3.published(last, "k3"), Reading::Missed);
        // What was seen before is not said again: it may be so no more.
        assert_eq!(k3.all(board.all()), seen(&[at("n4")]));
    }

    #[test]
    fn an_agent_that_starts_anew_is_followed_and_its_former_self_is_not() {
        let mut reader = Reader::default();
        let mut before = Board::new(7);
        let mut after = Board::new(8);
        reader.published(before.tell(&[at("n1")], None), "child");
        let reading = reader.published(after.tell(&[at("n2")], None), "child");
        assert_eq!(reading, Reading::Take(vec![at("n2")]));
        let reading = reader.published(before.tell(&[at("n3")], None), "child");
        assert_eq!(reading, Reading::Ignore);
        // A board that has nothing on it says nothing.
        assert_eq!(Reader::default().all(Board::new(9).all()), Reading::Ignore);
    }
}
