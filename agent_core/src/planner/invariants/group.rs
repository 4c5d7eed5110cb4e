//! What a mutex group is.

use std::fmt;

use crate::model::{Fact, Symbol};

/// What an argument of a fact is to a group.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Ord, PartialOrd, Hash)]
pub enum Role {
    /// The parameter of the group that has this number.
    Parameter(usize),
    /// Of the facts that differ here at most one holds.
    Counted,
}

/// The facts of one predicate in a group.
#[derive(Clone, Debug, Eq, PartialEq, Ord, PartialOrd, Hash)]
pub struct Part {
    /// The predicate.
    pub predicate: Symbol,
    /// For each argument; every parameter of the group once, and [`Role::Counted`] at most once.
    pub args: Vec<Role>,
}

impl Part {
    /// The arguments in the places of the parameters, in order of the parameters; `None` if `args`
    /// are not as many as the predicate's.
    pub(super) fn parameters_in<T: Clone>(&self, args: &[T]) -> Option<Vec<T>> {
        if args.len() != self.args.len() {
            return None;
        }
        let mut found: Vec<(usize, T)> = Vec::new();
        for (role, arg) in self.args.iter().zip(args) {
            if let Role::Parameter(index) = role {
                found.push((*index, arg.clone()));
            }
        }
        found.sort_by_key(|(index, _)| *index);
        Some(found.into_iter().map(|(_, arg)| arg).collect())
    }

    /// Where the counted argument stands.
    pub(super) fn counted(&self) -> Option<usize> {
        self.args.iter().position(|role| *role == Role::Counted)
    }
}

/// Facts of which at most one holds, for any values of the parameters, once that is so: at
/// most one of `(at ?n)` and `(on ?arc)` over all nodes and arcs.
#[derive(Clone, Debug, Eq, PartialEq, Ord, PartialOrd, Hash)]
pub struct Group {
    /// In the order of their predicates, each of which has one part at most.
    parts: Vec<Part>,
}

impl Group {
    /// Sorts the parts and numbers the parameters in the order in which they are met, so that equal
    /// groups compare as equal.
    pub(super) fn new(mut parts: Vec<Part>) -> Self {
        parts.sort();
        let mut met: Vec<usize> = Vec::new();
        for part in &mut parts {
            for role in &mut part.args {
                if let Role::Parameter(index) = role {
                    let place = met.iter().position(|known| known == index);
                    *index = place.unwrap_or_else(|| {
                        met.push(*index);
                        met.len() - 1
                    });
                }
            }
        }
        Self { parts }
    }

    /// In the order of their predicates.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// How many parameters it has.
    pub fn parameters(&self) -> usize {
        let roles = self.parts.first().map_or(&[][..], |part| &part.args);
        let is_parameter = |role: &&Role| matches!(role, Role::Parameter(_));
        roles.iter().filter(is_parameter).count()
    }

    /// The part that a predicate has in it.
    pub fn part(&self, predicate: &Symbol) -> Option<&Part> {
        self.parts.iter().find(|part| part.predicate == *predicate)
    }

    /// The values of the parameters for which `fact` is in the group; `None` if it is in it for
    /// none.
    ///
    /// Facts with the same values are one variable: its value is the one of them that holds, or
    /// none.
    pub fn variable_of(&self, fact: &Fact) -> Option<Vec<Symbol>> {
        self.part(&fact.name)?.parameters_in(&fact.args)
    }

    /// Whether it has one fact only for each choice of parameters, and so says nothing.
    pub(super) fn is_trivial(&self) -> bool {
        matches!(self.parts.as_slice(), [part] if part.counted().is_none())
    }
}

impl fmt::Display for Group {
    /// `{(at ?1 *), (carried ?1 *)}`: parameters are numbered from one, `*` is counted over.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("{")?;
        for (index, part) in self.parts.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}({}", part.predicate)?;
            for role in &part.args {
                match role {
                    Role::Parameter(index) => write!(f, " ?{}", index + 1)?,
                    Role::Counted => f.write_str(" *")?,
                }
            }
            f.write_str(")")?;
        }
        f.write_str("}")
    }
}
