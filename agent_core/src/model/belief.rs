//! What an agent holds to be true.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use rpds::RedBlackTreeSetSync;
use serde::{Deserialize, Serialize};

use super::{Fact, Landmarks, Symbol};

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
///
/// A copy shares what is the same, so that copying costs next to nothing, however much is believed,
/// and a change of the copy costs as little as the change.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Belief {
    facts: RedBlackTreeSetSync<Fact>,
    #[serde(with = "values_as_list")]
    values: Arc<BTreeMap<Fact, f64>>,
    /// Functions whose values are too many to list.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    landmarks: Vec<Arc<Landmarks>>,
}

impl Belief {
    /// Applies one change and says whether anything is different now.
    pub fn apply(&mut self, change: &FactChange) -> bool {
        match change {
            FactChange::Add(fact) => {
                let is_new = !self.facts.contains(fact);
                if is_new {
                    self.facts.insert_mut(fact.clone());
                }
                is_new
            }
            FactChange::Remove(fact) => self.facts.remove_mut(fact),
            FactChange::Set(function, value) => {
                let is_new = self.values.get(function) != Some(value);
                if is_new {
                    Arc::make_mut(&mut self.values).insert(function.clone(), *value);
                }
                is_new
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
        let bound = || self.landmarks.iter().find_map(|all| all.value(function));
        self.values.get(function).copied().or_else(bound)
    }

    /// Adds a function whose values are not listed. A value that is set counts before it.
    pub fn add_landmarks(&mut self, landmarks: Landmarks) {
        self.landmarks.push(Arc::new(landmarks));
    }

    /// The functions whose values are not listed.
    pub fn landmarks(&self) -> impl Iterator<Item = &Landmarks> {
        self.landmarks.iter().map(AsRef::as_ref)
    }

    /// Takes out the facts of these predicates.
    pub fn take_facts_of(&mut self, predicates: &[Symbol]) -> Vec<Fact> {
        let taken: Vec<Fact> = predicates
            .iter()
            .flat_map(|predicate| self.with_prefix(predicate, &[]))
            .cloned()
            .collect();
        for fact in &taken {
            self.facts.remove_mut(fact);
        }
        taken
    }

    /// All facts, in order.
    pub fn facts(&self) -> impl Iterator<Item = &Fact> {
        self.facts.iter()
    }

    /// All functions that have been given a value, with their values, in order.
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
            ..Self::default()
        }
    }
}

impl FromIterator<FactChange> for Belief {
    /// What holds after all of the changes, in any number.
    fn from_iter<I: IntoIterator<Item = FactChange>>(changes: I) -> Self {
        let mut belief = Self::default();
        let mut values = Vec::new();
        for change in changes {
            match change {
                FactChange::Set(function, value) => values.push((function, value)),
                other => {
                    belief.apply(&other);
                }
            }
        }
        // Built at once, which takes less room than one after the other.
        belief.values = Arc::new(values.into_iter().collect());
        belief
    }
}

/// JSON has no maps with keys that are not text; values travel as pairs.
mod values_as_list {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use crate::model::Fact;

    pub(super) fn serialize<S: Serializer>(
        values: &Arc<BTreeMap<Fact, f64>>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        values.iter().collect::<Vec<_>>().serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Arc<BTreeMap<Fact, f64>>, D::Error> {
        let listed = Vec::<(Fact, f64)>::deserialize(deserializer)?;
        Ok(Arc::new(listed.into_iter().collect()))
    }
}
