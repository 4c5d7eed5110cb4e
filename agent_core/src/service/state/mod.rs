//! The state service: what the others see.
//!
//! Facts that are shared are known with their source and their age, and of two words about the same
//! fact the newer one counts, by whomever it was said. As all vehicles go by that, they come to know
//! the same, in whatever order they hear of it. A sum over what each knows is said with its tasks:
//! whoever hears another sum says all that it knows. So what was lost on the way is made up for, and
//! one that comes late hears everything.

mod memory;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use serde::{Deserialize, Serialize};

use super::message::{Body, Message, Told};
use crate::model::{Fact, FactChange, Symbol, Time};
use crate::protocol::Ledger;

/// So many facts are told at once.
const FACTS_IN_A_MESSAGE: usize = 64;

/// So many facts are kept: more than a restaurant has, and few enough to go through.
const MOST_FACTS: usize = 20_000;

/// What is known of a fact.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct Known {
    /// Whether it holds.
    pub holds: bool,
    /// Who has seen it.
    pub source: Symbol,
    /// When, on the world's clock.
    pub at: Time,
}

impl Known {
    /// Of two words about one fact the newer one counts, and of two at the same moment always the same
    /// one, whoever compares them.
    fn rank(&self) -> (Time, &Symbol, bool) {
        (self.at, &self.source, self.holds)
    }
}

/// What the service wants done.
#[derive(Clone, Debug, PartialEq)]
pub enum StateOutput {
    /// Say it to all.
    Say(Message),
    /// These are so, others say; whoever is meant by `by` has seen them.
    Learn {
        /// Who has seen them.
        by: Symbol,
        /// What is so.
        changes: Vec<FactChange>,
    },
    /// Somebody wants to know whether these hold, and it is not known here either.
    Asked {
        /// Who.
        by: Symbol,
        /// What.
        facts: Vec<Fact>,
    },
}

/// What is shared, as one vehicle knows it.
#[derive(Clone, Debug)]
pub struct StateService {
    name: Symbol,
    beat: Time,
    /// Predicates that are told to others.
    shared: BTreeSet<Symbol>,
    /// Predicates of which nothing is known unless somebody has said it.
    asked: BTreeSet<Symbol>,
    table: BTreeMap<Fact, Known>,
    needs: BTreeSet<Fact>,
    now: Time,
    /// When needs were said last.
    said: Option<Time>,
    /// When the table has changed last, and when it was told as a whole.
    changed: Time,
    told_all: Option<Time>,
    touched: BTreeSet<Fact>,
    digest: u64,
    outputs: VecDeque<StateOutput>,
    ledger: Ledger,
}

impl StateService {
    /// The service of the vehicle of that name. `beat`: how often what is needed is said.
    pub fn new(
        name: Symbol,
        beat: Time,
        shared: impl IntoIterator<Item = Symbol>,
        asked: impl IntoIterator<Item = Symbol>,
    ) -> Self {
        Self {
            name,
            beat,
            shared: shared.into_iter().collect(),
            asked: asked.into_iter().collect(),
            table: BTreeMap::new(),
            needs: BTreeSet::new(),
            now: Time::ZERO,
            said: None,
            changed: Time::ZERO,
            told_all: None,
            touched: BTreeSet::new(),
            digest: 0,
            outputs: VecDeque::new(),
            ledger: Ledger::default(),
        }
    }

    /// All that is shared, with its source and its age.
    pub fn table(&self) -> &BTreeMap<Fact, Known> {
        &self.table
    }

    /// What is asked for at present.
    pub fn needs(&self) -> &BTreeSet<Fact> {
        &self.needs
    }

    /// Whether nobody has said as yet if this holds, where that is not the same as that it does not.
    pub fn is_unknown(&self, fact: &Fact) -> bool {
        self.asked.contains(&fact.name) && !self.table.contains_key(fact)
    }

    /// A sum over what is known: another one knows something else.
    pub fn digest(&self) -> u64 {
        self.digest
    }

    /// The facts that hold and are about `name`: what a vehicle has with it.
    pub fn about(&self, name: &Symbol) -> Vec<Fact> {
        self.table
            .iter()
            .filter(|(fact, known)| known.holds && fact.args.contains(name))
            .map(|(fact, _)| fact.clone())
            .collect()
    }

    /// What the service wants done next.
    pub fn poll_output(&mut self) -> Option<StateOutput> {
        self.outputs.pop_front()
    }

    /// It is `now`. Does what is due.
    pub fn settle(&mut self, now: Time) {
        self.now = self.now.max(now);
        if self.needs.is_empty() {
            self.said = None;
            return;
        }
        if self.said.is_none_or(|said| said + self.beat <= self.now) {
            self.said = Some(self.now);
            let needs = self.needs.iter().take(FACTS_IN_A_MESSAGE).cloned();
            let body = Body::Need(needs.collect());
            self.say(body);
        }
    }

    /// When [`settle`](Self::settle) is due.
    pub fn wake_at(&self) -> Option<Time> {
        if self.needs.is_empty() {
            return None;
        }
        Some(self.said.map_or(Time::ZERO, |said| said + self.beat))
    }

    /// The vehicle itself has seen these, now.
    pub fn sensed(&mut self, now: Time, changes: &[FactChange]) {
        self.now = self.now.max(now);
        let mut told = Vec::new();
        for change in changes {
            let (fact, holds) = match change {
                FactChange::Add(fact) => (fact, true),
                FactChange::Remove(fact) => (fact, false),
                FactChange::Set(..) => continue,
            };
            if !self.is_shared(fact) {
                continue;
            }
            // What is seen now is newer than anything that was said, also at the same moment.
            let at = match self.table.get(fact) {
                Some(known) if known.holds != holds && known.at >= self.now => {
                    Time(known.at.0.saturating_add(1))
                }
                _ => self.now,
            };
            let source = self.name.clone();
            self.note(fact, Known { holds, source, at });
            told.extend(self.told(fact));
        }
        self.tell(told);
    }

    /// These have to be known to go on. Those that were needed before and are not among them are
    /// needed no more.
    pub fn need(&mut self, facts: BTreeSet<Fact>) {
        let unknown = facts.into_iter().filter(|fact| self.is_unknown(fact));
        let needs: BTreeSet<Fact> = unknown.collect();
        if !needs.is_subset(&self.needs) {
            // Said at once.
            self.said = None;
        }
        self.needs = needs;
    }

    /// Another vehicle has said something about facts.
    pub fn heard(&mut self, message: &Message) {
        let Message { by, body, .. } = message;
        if *by == self.name {
            return;
        }
        match body {
            Body::Tasks(tasks) => self.compare(tasks.digest),
            Body::Told(told) => self.heard_told(told),
            Body::Need(facts) => self.heard_need(by, facts),
            Body::Bid(_) | Body::Goal(_) => {}
        }
    }

    fn is_shared(&self, fact: &Fact) -> bool {
        self.shared.contains(&fact.name) || self.asked.contains(&fact.name)
    }

    /// Whether that is news.
    fn note(&mut self, fact: &Fact, known: Known) -> bool {
        let before = self.table.get(fact);
        if before.is_some_and(|before| before.rank() >= known.rank())
            || before.is_none() && self.table.len() >= MOST_FACTS
        {
            return false;
        }
        if let Some(before) = before {
            self.digest = self.digest.wrapping_sub(sum(fact, before));
        }
        self.digest = self.digest.wrapping_add(sum(fact, &known));
        self.table.insert(fact.clone(), known);
        self.needs.remove(fact);
        self.touched.insert(fact.clone());
        self.changed = self.now;
        true
    }

    fn heard_told(&mut self, told: &[Told]) {
        let mut learnt: BTreeMap<Symbol, Vec<FactChange>> = BTreeMap::new();
        for told in told {
            let known = Known {
                holds: told.holds,
                source: told.source.clone(),
                // Nobody has seen anything in the future, as far as clocks agree.
                at: told.at.min(self.now + self.beat),
            };
            if self.is_shared(&told.fact) && self.note(&told.fact, known) {
                let fact = told.fact.clone();
                let change = match told.holds {
                    true => FactChange::Add(fact),
                    false => FactChange::Remove(fact),
                };
                let by = learnt.entry(told.source.clone()).or_default();
                by.push(change);
            }
        }
        for (by, changes) in learnt {
            self.outputs.push_back(StateOutput::Learn { by, changes });
        }
    }

    fn heard_need(&mut self, by: &Symbol, facts: &[Fact]) {
        let facts = facts.iter().take(FACTS_IN_A_MESSAGE);
        let (known, unknown): (Vec<&Fact>, Vec<&Fact>) =
            facts.partition(|fact| self.table.contains_key(*fact));
        let told = known.into_iter().filter_map(|fact| self.told(fact));
        let told = told.collect();
        self.tell(told);
        let unknown: Vec<Fact> = unknown.into_iter().cloned().collect();
        if !unknown.is_empty() {
            let (by, facts) = (by.clone(), unknown);
            self.outputs.push_back(StateOutput::Asked { by, facts });
        }
    }

    /// Somebody knows other facts than we do: that one is told all, unless the two of us may only not
    /// have heard the latest yet.
    fn compare(&mut self, digest: u64) {
        let lately = |at: Time| at + self.beat > self.now;
        if digest == self.digest || lately(self.changed) || self.told_all.is_some_and(lately) {
            return;
        }
        self.told_all = Some(self.now);
        let all = self.table.keys().filter_map(|fact| self.told(fact));
        let all = all.collect();
        self.tell(all);
    }

    fn told(&self, fact: &Fact) -> Option<Told> {
        let known = self.table.get(fact)?;
        Some(Told {
            fact: fact.clone(),
            holds: known.holds,
            source: known.source.clone(),
            at: known.at,
        })
    }

    fn tell(&mut self, told: Vec<Told>) {
        for chunk in told.chunks(FACTS_IN_A_MESSAGE) {
            self.say(Body::Told(chunk.to_vec()));
        }
    }

    fn say(&mut self, body: Body) {
        self.outputs.push_back(StateOutput::Say(Message {
            by: self.name.clone(),
            at: self.now,
            body,
        }));
    }
}

/// A number for what is known of a fact (FNV-1a, after Fowler, Noll and Vo), so that two who know the
/// same have the same sum.
fn sum(fact: &Fact, known: &Known) -> u64 {
    const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0100_0000_01b3;
    let eat = |sum: u64, bytes: &[u8]| {
        bytes.iter().fold(sum, |sum, byte| {
            (sum ^ u64::from(*byte)).wrapping_mul(PRIME)
        })
    };
    let words = std::iter::once(&fact.name).chain(&fact.args);
    let sum = words.chain([&known.source]).fold(BASIS, |sum, word| {
        // Words of no length are told apart from none.
        eat(eat(sum, word.as_str().as_bytes()), &[0xff])
    });
    let sum = eat(sum, &known.at.0.to_le_bytes());
    eat(sum, &[u8::from(known.holds)])
}
