//! Which arguments of an action may be one and the same object.

use super::super::fit::type_is_declared;
use crate::model::{Domain, Parameter, Symbol, Term};

/// Beyond this many variables and constants only pairs of equal ones are looked at: the number of
/// ways to group ten is already above a hundred thousand.
const MAX_FOR_ALL_GROUPINGS: usize = 8;

/// What an action's variables and the domain's constants stand for, up to names.
pub(super) struct Things<'a> {
    parameters: &'a [Parameter],
    constants: Vec<Symbol>,
}

/// Things that stand for the same object have the same number.
pub(super) type Grouping = Vec<usize>;

impl<'a> Things<'a> {
    /// The parameters of an action, and the constants that occur in what is to be proved of it.
    pub(super) fn new(parameters: &'a [Parameter], constants: Vec<Symbol>) -> Self {
        Self {
            parameters,
            constants,
        }
    }

    fn len(&self) -> usize {
        self.parameters.len() + self.constants.len()
    }

    fn kind<'d>(&'d self, domain: &'d Domain, thing: usize) -> Option<&'d Symbol> {
        match self.parameters.get(thing) {
            Some(parameter) => Some(&parameter.kind),
            None => {
                let constant = self.constants.get(thing - self.parameters.len())?;
                domain.constants.get(constant)
            }
        }
    }

    /// How the author calls it; what is none of these things is some other object.
    pub(super) fn name(&self, thing: usize) -> &str {
        match self.parameters.get(thing) {
            Some(parameter) => parameter.name.as_str(),
            None => self
                .constants
                .get(thing - self.parameters.len())
                .map_or("?other", Symbol::as_str),
        }
    }

    /// The thing that a term is. `None` for a quantified variable.
    pub(super) fn index(&self, term: &Term) -> Option<usize> {
        match term {
            Term::Variable(index) => (*index < self.parameters.len()).then_some(*index),
            Term::Constant(name) => {
                let index = self.constants.iter().position(|known| known == name)?;
                Some(self.parameters.len() + index)
            }
        }
    }

    /// Whether two things can be the same object.
    fn may_be_equal(&self, domain: &Domain, one: usize, other: usize) -> bool {
        if one.min(other) >= self.parameters.len() {
            return false; // two constants
        }
        match (self.kind(domain, one), self.kind(domain, other)) {
            (Some(one), Some(other)) => {
                domain.is_a(one, other)
                    || domain.is_a(other, one)
                    || !type_is_declared(domain, one)
                    || !type_is_declared(domain, other)
            }
            _ => false,
        }
    }

    /// All groupings to be looked at, the one in which all things differ first.
    pub(super) fn groupings(&self, domain: &Domain) -> Vec<Grouping> {
        let all_differ: Grouping = (0..self.len()).collect();
        let mut out = if self.len() <= MAX_FOR_ALL_GROUPINGS {
            let mut found = vec![Vec::new()];
            for thing in 0..self.len() {
                found = found
                    .into_iter()
                    .flat_map(|grouping| self.with_next(domain, thing, grouping))
                    .collect();
            }
            found
        } else {
            let mut found = vec![all_differ.clone()];
            for other in 0..self.len() {
                for one in 0..other {
                    if self.may_be_equal(domain, one, other) {
                        let mut grouping = all_differ.clone();
                        grouping[other] = one;
                        found.push(grouping);
                    }
                }
            }
            found
        };
        // A group is called by its first thing: these are the things that have joined another.
        out.sort_by_key(|grouping| {
            grouping
                .iter()
                .zip(0..)
                .filter(|(group, thing)| **group != *thing)
                .count()
        });
        out
    }

    /// `grouping` with one more thing: on its own, or in each group where it fits in.
    fn with_next(&self, domain: &Domain, thing: usize, grouping: Grouping) -> Vec<Grouping> {
        let groups = (0..thing).filter(|other| {
            grouping[*other] == *other
                && (0..thing)
                    .filter(|member| grouping[*member] == *other)
                    .all(|member| self.may_be_equal(domain, member, thing))
        });
        groups
            .chain([thing])
            .map(|group| {
                let mut longer = grouping.clone();
                longer.push(group);
                longer
            })
            .collect()
    }

    /// " when `?from` and `?to` are the same", or nothing if all differ.
    pub(super) fn describe(&self, grouping: &Grouping) -> String {
        let same: Vec<String> = grouping
            .iter()
            .enumerate()
            .filter(|(thing, group)| thing != *group)
            .map(|(thing, group)| {
                format!(
                    "`{}` and `{}` are the same",
                    self.name(*group),
                    self.name(thing)
                )
            })
            .collect();
        match same.as_slice() {
            [] => String::new(),
            same => format!(" when {}", same.join(", ")),
        }
    }
}
