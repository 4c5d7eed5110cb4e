//! What can be wrong with a plan.

use std::fmt;

/// How many faults are told of one plan; more of them teach nobody anything.
const MOST: usize = 50;

/// The kinds of faults.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum Kind {
    /// The domain or the problem cannot be read, so that nothing can be said of the plan.
    Unjudgeable,
    /// The text is no plan: a marker, a number or a line is missing or makes no sense.
    Malformed,
    /// Two lines have the same id.
    DuplicateId,
    /// A task, a method or an object that neither domain nor problem declares.
    UnknownName,
    /// An action or a task with too few or too many arguments, or with one of the wrong type.
    WrongArguments,
    /// A child or root that no line describes.
    UnknownChild,
    /// A node with two parents.
    ChildUsedTwice,
    /// A node that does not hang from the root.
    Unreachable,
    /// A node that is its own ancestor.
    Cycle,
    /// The roots are not the tasks of the problem.
    WrongRoots,
    /// A decomposition that is no instance of its method.
    NotAnInstance,
    /// The actions stand in an order that the methods forbid.
    WrongOrder,
    /// A method is used where its precondition or its constraints do not hold.
    MethodPrecondition,
    /// An action is done where its precondition does not hold.
    Precondition,
    /// The plan ends, but not with what the problem wants to be true.
    Goal,
    /// No decomposition of the problem's tasks has these actions.
    NotARefinement,
}

/// One thing that is wrong with a plan.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Fault {
    /// Which kind of thing.
    pub kind: Kind,
    /// The id of the node in the plan, where there is one.
    pub id: Option<u64>,
    /// What is wrong and why, for people.
    pub what: String,
}

impl Fault {
    pub(crate) fn new(kind: Kind, what: impl Into<String>) -> Self {
        Self {
            kind,
            id: None,
            what: what.into(),
        }
    }

    pub(crate) fn at(kind: Kind, id: u64, what: impl Into<String>) -> Self {
        Self {
            kind,
            id: Some(id),
            what: what.into(),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.id {
            Some(id) => write!(f, "{id}: {}", self.what),
            None => f.write_str(&self.what),
        }
    }
}

/// Faults as they are found, up to as many as anybody reads.
#[derive(Debug, Default)]
pub(crate) struct Faults(Vec<Fault>);

impl Faults {
    pub(crate) fn push(&mut self, fault: Fault) {
        if self.0.len() < MOST {
            self.0.push(fault);
        }
    }

    /// Goes on only if nothing has been found.
    pub(crate) fn check(self) -> Result<Self, Vec<Fault>> {
        if self.0.is_empty() {
            Ok(self)
        } else {
            Err(self.0)
        }
    }
}
