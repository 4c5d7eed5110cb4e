//! Which groups become variables.

use std::collections::{BTreeMap, BTreeSet};

use super::group::{Group, Part};
use crate::model::{Fact, Symbol};

/// One choice of parameters of one group. Its value is the fact of it that holds, or none.
#[derive(Clone, Debug, Eq, PartialEq, Ord, PartialOrd, Hash)]
pub struct Variable {
    /// The place of the group in [`Variables::groups`].
    pub group: usize,
    /// The values of its parameters.
    pub parameters: Vec<Symbol>,
}

/// Groups that share no predicate, so that a fact belongs to one variable at most.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Variables {
    groups: Vec<Group>,
    /// The group that a predicate belongs to, and its part in it. Of a group whose other predicates
    /// belong to larger ones, what is left is still of at most one fact.
    of: BTreeMap<Symbol, (usize, Part)>,
}

impl Variables {
    /// Chooses from `groups`, the largest first, those that no facts of a belief break.
    pub fn choose<'f>(groups: &[Group], facts: impl IntoIterator<Item = &'f Fact>) -> Self {
        let facts: Vec<&Fact> = facts.into_iter().collect();
        let mut largest_first: Vec<&Group> = groups.iter().collect();
        largest_first.sort_by_key(|group| {
            let parts = std::cmp::Reverse(group.parts().len());
            (parts, group.parameters(), *group)
        });
        let mut chosen = Self::default();
        for group in largest_first {
            let free = |part: &&Part| !chosen.of.contains_key(&part.predicate);
            let parts: Vec<Part> = group.parts().iter().filter(free).cloned().collect();
            let says_something = match parts.as_slice() {
                [] => false,
                [part] => part.counted().is_some(),
                _ => true,
            };
            if !says_something || !broken(group, facts.iter().copied()).is_empty() {
                continue;
            }
            let index = chosen.groups.len();
            chosen.groups.push(group.clone());
            for part in parts {
                chosen.of.insert(part.predicate.clone(), (index, part));
            }
        }
        chosen
    }

    /// The groups chosen.
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// The variable that has `fact` among its values; `None` if the fact is a variable of its own.
    pub fn variable_of(&self, fact: &Fact) -> Option<Variable> {
        let (group, part) = self.of.get(&fact.name)?;
        Some(Variable {
            group: *group,
            parameters: part.parameters_in(&fact.args)?,
        })
    }

    /// The variables of which two facts or more hold. Each fact of these is a variable of its own until it is
    /// no longer so; see the [module](super).
    pub fn broken<'f>(&self, facts: impl IntoIterator<Item = &'f Fact>) -> BTreeSet<Variable> {
        let facts: Vec<&Fact> = facts.into_iter().collect();
        let mut found = BTreeSet::new();
        for (index, group) in self.groups.iter().enumerate() {
            let parameters = broken(group, facts.iter().copied());
            found.extend(parameters.into_iter().map(|parameters| Variable {
                group: index,
                parameters,
            }));
        }
        found
    }
}

/// For which values of its parameters more than one fact of a group is among `facts`, none of
/// which is there twice.
fn broken<'f>(group: &Group, facts: impl Iterator<Item = &'f Fact>) -> BTreeSet<Vec<Symbol>> {
    let mut once = BTreeSet::new();
    let mut more = BTreeSet::new();
    for fact in facts {
        if let Some(parameters) = group.variable_of(fact)
            && !once.insert(parameters.clone())
        {
            more.insert(parameters);
        }
    }
    more
}
