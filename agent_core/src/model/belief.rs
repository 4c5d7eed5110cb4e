//! What an agent holds to be true.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use serde::{Deserialize, Serialize};

use super::{Fact, Symbol};

/// One change of a belief: what facts, reports and observations are made of.
#[derive(Clone, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
pub enum FactChange {
    /// The fact holds.
    Add(Fact),
    /// The fact does not hold.
    Remove(Fact),
    /// The function has this value, in the domain's unit: `(= (gap arc5 n6) 3.2)`.
    Set(Fact, f64),
}

impl fmt::Display for FactChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Add(fact) => write!(f, "{fact}"),
            Self::Remove(fact) => write!(f, "(not {fact})"),
            Self::Set(function, value) => write!(f, "(= {function} {value})"),
        }
    }
}

/// Facts that hold and functions that have a value; everything else is false or undefined.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Belief {
    facts: BTreeSet<Fact>,
    #[serde(with = "values_as_list")]
    values: BTreeMap<Fact, f64>,
}

impl Belief {
    /// Applies one change and says whether anything is different now.
    pub fn apply(&mut self, change: &FactChange) -> bool {
        match change {
            FactChange::Add(fact) => self.facts.insert(fact.clone()),
            FactChange::Remove(fact) => self.facts.remove(fact),
            FactChange::Set(function, value) => {
                self.values.insert(function.clone(), *value) != Some(*value)
            }
        }
    }

    /// Applies all changes in order and returns those that made a difference.
    pub fn apply_all(&mut self, changes: &[FactChange]) -> Vec<FactChange> {
        changes
            .iter()
            .filter(|change| self.apply(change))
            .cloned()
            .collect()
    }

    /// Whether the fact holds.
    pub fn holds(&self, fact: &Fact) -> bool {
        self.facts.contains(fact)
    }

    /// The function's value, if it has one.
    pub fn value(&self, function: &Fact) -> Option<f64> {
        self.values.get(function).copied()
    }

    /// All facts, in order.
    pub fn facts(&self) -> impl Iterator<Item = &Fact> {
        self.facts.iter()
    }

    /// All functions with their values, in order.
    pub fn values(&self) -> impl Iterator<Item = (&Fact, f64)> {
        self.values
            .iter()
            .map(|(function, value)| (function, *value))
    }

    /// The facts of a predicate whose first arguments are `prefix`, in order.
    pub fn with_prefix<'a>(
        &'a self,
        predicate: &Symbol,
        prefix: &[Symbol],
    ) -> impl Iterator<Item = &'a Fact> + use<'a> {
        let from = Fact {
            name: predicate.clone(),
            args: prefix.to_vec(),
        };
        let (name, args) = (predicate.clone(), prefix.to_vec());
        self.facts
            .range(from..)
            .take_while(move |fact| fact.name == name && fact.args.starts_with(&args))
    }
}

impl FromIterator<Fact> for Belief {
    fn from_iter<I: IntoIterator<Item = Fact>>(facts: I) -> Self {
        Self {
            facts: facts.into_iter().collect(),
            values: BTreeMap::new(),
        }
    }
}

/// JSON has no maps with keys that are not text; values travel as pairs.
mod values_as_list {
    use std::collections::BTreeMap;

    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use crate::model::Fact;

    pub(super) fn serialize<S: Serializer>(
        values: &BTreeMap<Fact, f64>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        values.iter().collect::<Vec<_>>().serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<BTreeMap<Fact, f64>, D::Error> {
        Ok(Vec::<(Fact, f64)>::deserialize(deserializer)?
            .into_iter()
            .collect())
    }
}
