//! Conditions and effects with numbers for names.

use super::{KindId, ObjectId, PredicateId};

/// A variable, by its place among those in scope, or an object.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Hash)]
pub enum Term {
    /// Parameters come first; variables of quantifiers are numbered on from what is in scope.
    Variable(usize),
    /// An object.
    Object(ObjectId),
}

impl Term {
    /// The variable, if it is one.
    pub fn variable(self) -> Option<usize> {
        match self {
            Self::Variable(variable) => Some(variable),
            Self::Object(_) => None,
        }
    }

    /// The object that it stands for.
    pub fn value(self, bindings: &[ObjectId]) -> ObjectId {
        match self {
            Self::Variable(variable) => bindings[variable],
            Self::Object(object) => object,
        }
    }
}

/// A predicate with terms.
#[derive(Clone, Debug, Eq, PartialEq, Hash)]
pub struct FactPattern {
    /// The predicate.
    pub predicate: PredicateId,
    /// As many as it has parameters.
    pub args: Vec<Term>,
}

/// A part of a condition, in negation normal form.
#[derive(Clone, Debug, Eq, PartialEq, Hash)]
pub enum Clause {
    /// The fact holds (`true`) or does not.
    Fact(bool, FactPattern),
    /// Both are the same object (`true`) or are not.
    Equal(bool, Term, Term),
    /// At least one of these conditions holds. Empty: never true.
    Any(Vec<Vec<Clause>>),
    /// For all objects of these kinds in the place of the variables from the given number on, the
    /// condition holds.
    Every(Quantified),
    /// For some objects.
    Exists(Quantified),
}

/// What a quantifier ranges over, and what it says.
#[derive(Clone, Debug, Eq, PartialEq, Hash)]
pub struct Quantified {
    /// Number of the first variable; the others follow.
    pub first: usize,
    /// One for each variable.
    pub kinds: Vec<KindId>,
    /// What is said of them.
    pub inner: Vec<Clause>,
}

/// All of these hold.
pub type Condition = Vec<Clause>;

/// One thing that an action makes true or false.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Change {
    /// Added (`true`) or removed. Of one action all removals come before all additions.
    pub adds: bool,
    /// Kinds of the variables of `forall`, numbered on from the action's parameters.
    pub over: Vec<KindId>,
    /// What must hold in the state in which the action begins.
    pub when: Condition,
    /// The fact.
    pub fact: FactPattern,
}

/// Calls `found` with each fact in a condition, at any depth, and whether it is asked to hold.
pub fn each_fact<'a>(condition: &'a [Clause], found: &mut dyn FnMut(bool, &'a FactPattern)) {
    // A list instead of recursion: conditions come from text and may be deeply nested.
    let mut open: Vec<&'a Clause> = condition.iter().collect();
    while let Some(clause) = open.pop() {
        match clause {
            Clause::Fact(positive, fact) => found(*positive, fact),
            Clause::Equal(..) => {}
            Clause::Any(choices) => open.extend(choices.iter().flatten()),
            Clause::Every(quantified) | Clause::Exists(quantified) => {
                open.extend(&quantified.inner);
            }
        }
    }
}

/// How many variables a condition needs, those in scope included.
pub fn width(condition: &[Clause], in_scope: usize) -> usize {
    let mut most = in_scope;
    let mut open: Vec<&Clause> = condition.iter().collect();
    while let Some(clause) = open.pop() {
        match clause {
            Clause::Fact(..) | Clause::Equal(..) => {}
            Clause::Any(choices) => open.extend(choices.iter().flatten()),
            Clause::Every(quantified) | Clause::Exists(quantified) => {
                most = most.max(quantified.first + quantified.kinds.len());
                open.extend(&quantified.inner);
            }
        }
    }
    most
}
