//! What an agent writes down, and how it comes back from that (invariant S10).
//!
//! A row for each goal that is not over, for each that is, for each map that came with an
//! instruction, and for each fact and value that is believed otherwise than at the start. The planner
//! is not written down: what it knows can be found out again.

mod network;
mod recall;
mod rows;
mod same;
#[cfg(test)]
mod tests;
mod write;

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use super::{Agent, ResumedBy};
use crate::model::{Belief, Fact, FactChange, Map, Symbol};
use crate::planner::Planner;
use crate::protocol::{ActionId, Durable, Ledger, Row, Rows, Unreadable};
use same::Written;

const AGENT: &str = "m/agent";
const TOLD: &str = "m/told";
const FACT: &str = "m/fact/";
const VALUE: &str = "m/value/";
const MAP: &str = "m/map/";
const GOAL: &str = "m/goal/";
const ENDED: &str = "m/ended/";

/// What an agent has written down, so that what is still so need not be written again.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    ledger: Ledger,
    /// What was believed at the start.
    configured: Belief,
    /// What may be believed otherwise since the last writing.
    touched: BTreeSet<Fact>,
    goals: BTreeMap<u64, Written>,
    maps: Vec<(u64, Arc<Map>)>,
    next_map: u64,
    /// Goals that are over.
    ended: Range<u64>,
    told: Option<(Belief, Vec<FactChange>)>,
}

impl Memory {
    /// Nothing is written yet of an agent that begins with this belief.
    pub fn new(configured: Belief) -> Self {
        Self {
            configured,
            ..Self::default()
        }
    }

    /// The belief has changed.
    pub fn touch(&mut self, changes: &[FactChange]) {
        for change in changes {
            let (FactChange::Add(fact) | FactChange::Remove(fact) | FactChange::Set(fact, _)) =
                change;
            if !self.touched.contains(fact) {
                self.touched.insert(fact.clone());
            }
        }
    }
}

impl<P: Planner> Durable for Agent<P> {
    fn write_down(&mut self) -> Vec<Row> {
        let mut memory = std::mem::take(&mut self.memory);
        memory.note(self);
        let rows = memory.ledger.take();
        self.memory = memory;
        rows
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.remember_all(rows)
    }

    fn is_suspended(&self, superior: &Symbol, id: &ActionId) -> bool {
        let place = self.stack.place_of(superior, id);
        place.is_some_and(|place| self.stack.entries()[place].resumed_by == ResumedBy::Superior)
    }
}

/// A key for a fact: its words with blanks between them, where no word has a blank.
fn key_of(prefix: &str, fact: &Fact) -> String {
    let mut key = String::from(prefix);
    for (place, word) in std::iter::once(&fact.name).chain(&fact.args).enumerate() {
        if place > 0 {
            key.push(' ');
        }
        for letter in word.as_str().chars() {
            match letter {
                '%' => key.push_str("%25"),
                ' ' => key.push_str("%20"),
                letter => key.push(letter),
            }
        }
    }
    key
}

fn numbered(prefix: &str, number: u64) -> String {
    format!("{prefix}{number:020}")
}
