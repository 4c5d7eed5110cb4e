//! A name with arguments: what facts, tasks and actions have in common.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::Symbol;

/// A name applied to objects: `(at n1)`.
///
/// Facts, tasks and actions are all of this shape; the aliases [`Fact`], [`Task`] and [`Action`]
/// say at each place which is meant.
#[derive(Clone, Eq, PartialEq, Ord, PartialOrd, Hash, Serialize, Deserialize)]
pub struct Atom {
    /// Predicate, task or action.
    pub name: Symbol,
    /// Objects, in the order of the declaration.
    pub args: Vec<Symbol>,
}

/// A statement about the world that a [`Belief`](super::Belief) holds or does not.
pub type Fact = Atom;
/// Something to be done, abstract or not, with its arguments.
pub type Task = Atom;
/// An operator with its arguments: what an executor is told to do.
pub type Action = Atom;

impl Atom {
    /// An atom from its parts.
    pub fn new<'a>(name: &str, args: impl IntoIterator<Item = &'a str>) -> Self {
        Self {
            name: Symbol::from(name),
            args: args.into_iter().map(Symbol::from).collect(),
        }
    }
}

impl fmt::Display for Atom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}", self.name)?;
        for arg in &self.args {
            write!(f, " {arg}")?;
        }
        f.write_str(")")
    }
}

impl fmt::Debug for Atom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
