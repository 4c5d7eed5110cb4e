//! Facts that an agent tells its superiors without having been asked to bring them about.
//!
//! They are published, and a publication may be lost or come before anyone listens. So they are
//! numbered, the agent keeps what it has said last about each fact, and a superior that is new, or
//! sees that it has missed something, asks for all of it.

use std::collections::BTreeMap;

use agent_core::model::{Fact, FactChange, Symbol};

use crate::wire::Observed;

/// What an agent has told all its superiors.
#[derive(Debug)]
pub(crate) struct Board {
    epoch: u64,
    seq: u64,
    /// The last word about each fact, and about each value (`true`).
    last: BTreeMap<(bool, Fact), FactChange>,
    /// What was told each superior alone when that was done last.
    alone: BTreeMap<Symbol, Vec<FactChange>>,
}

impl Board {
    pub(crate) fn new(epoch: u64) -> Self {
        Self {
            epoch,
            seq: 0,
            last: BTreeMap::new(),
            alone: BTreeMap::new(),
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

    /// The same for all that can be told one superior alone now.
    pub(crate) fn tell_one(
        &mut self,
        to: &Symbol,
        facts: Vec<FactChange>,
        reported: bool,
    ) -> Observed {
        self.seq += 1;
        let message = Observed::new(self.epoch, self.seq, &[], reported.then_some(to));
        let message = message.with_alone(to, &facts);
        self.alone.insert(to.clone(), facts);
        message
    }

    /// All that has been told.
    pub(crate) fn all(&self) -> Observed {
        let facts: Vec<FactChange> = self.last.values().cloned().collect();
        let all = Observed::new(self.epoch, self.seq, &facts, None);
        let alone = self.alone.iter();
        alone.fold(all, |all, (to, facts)| all.with_alone(to, facts))
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
        take(message, own)
    }

    /// Takes the answer to the question for all, as `own`.
    pub(crate) fn all(&mut self, message: Observed, own: &str) -> Reading {
        let at = (message.epoch, message.seq);
        if message.seq == 0 || self.last.is_some_and(|last| at <= last) {
            return Reading::Ignore;
        }
        self.last = Some(at);
        take(message, own)
    }
}

fn take(message: Observed, own: &str) -> Reading {
    match message.into_facts(own) {
        // It was for somebody else.
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
        let Reading::Take(all) = reader.all(board.all(), "child") else {
            unreachable!("the answer is newer than what is known")
        };
        assert_eq!(all.len(), 3);
        assert!(all.contains(&not_at("n1")) && all.contains(&at("n2")));
        assert_eq!(reader.all(board.all(), "child"), Reading::Ignore);
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
    fn what_is_for_one_superior_alone_no_other_hears_and_none_misses() {
        let mut board = Board::new(7);
        let (mut k2, mut k3) = (Reader::default(), Reader::default());
        let of_k3 = board.tell_one(&"k3".into(), vec![at("n1")], false);
        assert_eq!(k2.published(of_k3.clone(), "k2"), Reading::Ignore);
        assert_eq!(k3.published(of_k3, "k3"), Reading::Take(vec![at("n1")]));
        let of_k2 = board.tell_one(&"k2".into(), vec![at("n2")], false);
        assert_eq!(k2.published(of_k2, "k2"), Reading::Take(vec![at("n2")]));
        let in_a_report = board.tell_one(&"k2".into(), vec![not_at("n2")], true);
        assert_eq!(k2.published(in_a_report, "k2"), Reading::Ignore);
        let _lost = board.tell_one(&"k2".into(), vec![at("n3")], false);
        let of_all = board.tell(&[at("n9")], None);
        assert_eq!(k2.published(of_all, "k2"), Reading::Missed);
        // What was seen before is not said again: it may be so no more.
        let all = Reading::Take(vec![at("n9"), at("n3")]);
        assert_eq!(k2.all(board.all(), "k2"), all);
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
        assert_eq!(
            Reader::default().all(Board::new(9).all(), "child"),
            Reading::Ignore
        );
    }
}
