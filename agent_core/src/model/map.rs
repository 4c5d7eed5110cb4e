//! Objects and facts that do not change while a goal is pursued.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Belief, FactChange, Symbol};

/// What an agent knows of its surroundings beside its belief: objects with their types, and the
/// facts and values about them that no action changes.
///
/// A child agent holds the map of the area it works in and no more; it comes with the parent's
/// instruction (the paper, section 7), so it belongs to a goal and is suspended with it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Map {
    /// Object and its type.
    pub objects: BTreeMap<Symbol, Symbol>,
    /// Facts and values about them that do not change.
    pub facts: Belief,
    /// What is known at the time of things in it that do change: a door that is open or closed.
    /// Goes into the receiver's belief.
    #[serde(default)]
    pub news: Vec<FactChange>,
}

impl Map {
    /// Takes out what changes: facts of `observable` predicates, and the news. What stays is what
    /// does not change.
    pub fn take_changing(&mut self, observable: &[Symbol]) -> Vec<FactChange> {
        let changing = self.facts.take_facts_of(observable);
        let mut changing: Vec<_> = changing.into_iter().map(FactChange::Add).collect();
        changing.append(&mut self.news);
        changing
    }
}
