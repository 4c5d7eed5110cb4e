//! Maps that go down with instructions, made once for what is done again and again.

use std::collections::BTreeMap;

use crate::model::{Fact, Map, Symbol};

/// So many are kept: more than a tour is long.
const KEPT: usize = 32;

/// The map of a place, as it goes down.
#[derive(Clone, Debug)]
pub(super) struct Excerpt {
    /// What does not change.
    pub map: Map,
    /// What does: whether it holds is said anew each time.
    pub changing: Vec<Fact>,
}

/// The maps that went down last.
#[derive(Clone, Debug, Default)]
pub(super) struct Excerpts {
    /// With the number of the use that was the last.
    known: BTreeMap<Symbol, (u64, Excerpt)>,
    uses: u64,
}

impl Excerpts {
    /// The map of a place, which is made if it is not known. Of many, the one that was not used for
    /// longest gives way.
    pub fn of(
        &mut self,
        place: &Symbol,
        make: impl FnOnce() -> Option<Excerpt>,
    ) -> Option<&Excerpt> {
        if !self.known.contains_key(place) {
            let excerpt = make()?;
            if self.known.len() >= KEPT {
                let oldest = self.known.iter().min_by_key(|(_, (used, _))| *used);
                if let Some(oldest) = oldest.map(|(place, _)| place.clone()) {
                    self.known.remove(&oldest);
                }
            }
            self.known.insert(place.clone(), (0, excerpt));
        }
        self.uses += 1;
        let (used, excerpt) = self.known.get_mut(place)?;
        *used = self.uses;
        Some(excerpt)
    }
}
