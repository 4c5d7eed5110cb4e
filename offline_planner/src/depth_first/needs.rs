//! What is still to be done needs facts that can be lost and never be had again.

use rustc_hash::FxHashMap;

use super::table::FactPlace;
use crate::compile::PredicateId;

/// A fact, and whether it must hold.
pub type Wanted = (PredicateId, FactPlace, bool);

/// How many actions and tasks of the list need each fact. Only facts are counted of which no action
/// can bring about that they are as they must be.
#[derive(Debug, Default)]
pub struct Needs {
    counts: FxHashMap<Wanted, u32>,
    /// Where a count went up (`true`) and down, to be taken back.
    trail: Vec<(Wanted, bool)>,
}

impl Needs {
    /// One more needs it (`up`), or one less.
    pub fn change(&mut self, wanted: Wanted, up: bool) {
        self.count(wanted, up);
        self.trail.push((wanted, up));
    }

    /// Whether something needs the fact to be so.
    pub fn contains(&self, wanted: Wanted) -> bool {
        !self.counts.is_empty() && self.counts.get(&wanted).is_some_and(|count| *count > 0)
    }

    /// Nothing is needed.
    pub fn clear(&mut self) {
        self.counts.clear();
        self.trail.clear();
    }

    /// How far it is back, to come back to here.
    pub fn mark(&self) -> u32 {
        self.trail.len() as u32
    }

    /// Takes back every change since the mark.
    pub fn undo_to(&mut self, mark: u32) {
        while self.trail.len() > mark as usize {
            if let Some((wanted, up)) = self.trail.pop() {
                self.count(wanted, !up);
            }
        }
    }

    /// Memory taken by what grows.
    pub fn bytes(&self) -> usize {
        self.trail.capacity() * size_of::<(Wanted, bool)>()
    }

    fn count(&mut self, wanted: Wanted, up: bool) {
        let count = self.counts.entry(wanted).or_insert(0);
        *count = if up {
            *count + 1
        } else {
            count.saturating_sub(1)
        };
    }
}
