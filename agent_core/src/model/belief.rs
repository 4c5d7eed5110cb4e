//! What an agent holds to be true.

use std::collections::BTreeMap;
use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};
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
#[serde(from = "Written")]
pub struct Belief {
    facts: RedBlackTreeSetSync<Fact>,
    #[serde(with = "values_as_list")]
    values: Arc<BTreeMap<Fact, f64>>,
    /// Functions whose values are too many to list.
    landmarks: Vec<Arc<Landmarks>>,
    /// The sum over all facts and values; see [`fingerprint`](Self::fingerprint).
    #[serde(skip_serializing)]
    fingerprint: u64,
}

/// A belief on the wire.
#[derive(Default, Deserialize)]
struct Written {
    facts: RedBlackTreeSetSync<Fact>,
    #[serde(with = "values_as_list")]
    values: Arc<BTreeMap<Fact, f64>>,
    #[serde(default)]
    landmarks: Vec<Arc<Landmarks>>,
}

impl From<Written> for Belief {
    fn from(written: Written) -> Self {
        let facts = written.facts.iter().map(Self::fingerprint_of);
        let values = written
            .values
            .iter()
            .map(|(function, value)| Self::fingerprint_of_value(function, *value));
        Self {
            fingerprint: facts.chain(values).fold(0, u64::wrapping_add),
            facts: written.facts,
            values: written.values,
            landmarks: written.landmarks,
        }
    }
}

impl Belief {
    /// Applies one change and says whether anything is different now.
    pub fn apply(&mut self, change: &FactChange) -> bool {
        let (before, after) = match change {
            FactChange::Add(fact) => {
                if self.facts.contains(fact) {
                    return false;
                }
                self.facts.insert_mut(fact.clone());
                (0, Self::fingerprint_of(fact))
            }
            FactChange::Remove(fact) => {
                if !self.facts.remove_mut(fact) {
                    return false;
                }
                (Self::fingerprint_of(fact), 0)
            }
            FactChange::Set(function, value) => {
                let before = self.values.get(function).copied();
                if before == Some(*value) {
                    return false;
                }
                Arc::make_mut(&mut self.values).insert(function.clone(), *value);
                let print = |value| Self::fingerprint_of_value(function, value);
                (before.map_or(0, print), print(*value))
            }
        };
        self.count(before, after);
        true
    }

    fn count(&mut self, before: u64, after: u64) {
        let without = self.fingerprint.wrapping_sub(before);
        self.fingerprint = without.wrapping_add(after);
    }

    /// A number that beliefs with equal facts and values share and others do not, but for a chance
    /// of one in 2^64. It does not depend on how the belief came about and is the same in every run.
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }

    /// What a fact adds to the fingerprint.
    pub(crate) fn fingerprint_of(fact: &Fact) -> u64 {
        let mut hasher = DefaultHasher::new();
        fact.hash(&mut hasher);
        hasher.finish()
    }

    /// What the value of a function adds to the fingerprint.
    pub(crate) fn fingerprint_of_value(function: &Fact, value: f64) -> u64 {
        let mut hasher = DefaultHasher::new();
        // Zero has two signs.
        (function, (value + 0.0).to_bits()).hash(&mut hasher);
        hasher.finish()
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
            self.apply(&FactChange::Remove(fact.clone()));
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
        Self::from(Written {
            facts: facts.into_iter().collect(),
            ..Written::default()
        })
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
        Self::from(Written {
            facts: belief.facts,
            values: Arc::new(values.into_iter().collect()),
            landmarks: Vec::new(),
        })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_belief_can_be_read_from_a_journal() {
        let facts = [
            FactChange::Add(Fact::new("at", ["n1"])),
            FactChange::Set(Fact::new("gap", ["arc1", "n1"]), 2.5),
        ];
        let belief: Belief = facts.into_iter().collect();
        let bytes = postcard::to_stdvec(&belief).expect("plain data");
        assert_eq!(postcard::from_bytes(&bytes), Ok(belief));
    }
}
