//! Conditions, effects and numbers with variables in them.

use super::{Atom, Symbol};

/// A variable, by its place among the parameters in scope, or an object.
#[derive(Clone, Debug, Eq, PartialEq, Hash)]
pub enum Term {
    /// Index into the parameters of the action, method or rule.
    Variable(usize),
    /// An object that the domain names.
    Constant(Symbol),
}

/// An atom that may have variables: `(at ?n)`.
#[derive(Clone, Debug, Eq, PartialEq, Hash)]
pub struct Pattern {
    /// Predicate, function, task or action.
    pub name: Symbol,
    /// Variables and objects.
    pub args: Vec<Term>,
}

impl Pattern {
    /// The atom that this is once every variable is bound.
    ///
    /// `None` if one is not.
    pub fn ground(&self, bindings: &[Option<Symbol>]) -> Option<Atom> {
        let args = self
            .args
            .iter()
            .map(|term| term.bound(bindings))
            .collect::<Option<_>>()?;
        Some(Atom {
            name: self.name.clone(),
            args,
        })
    }
}

impl Term {
    /// The object that this stands for, if it is bound.
    pub fn bound(&self, bindings: &[Option<Symbol>]) -> Option<Symbol> {
        match self {
            Self::Variable(index) => bindings.get(*index).cloned().flatten(),
            Self::Constant(object) => Some(object.clone()),
        }
    }
}

/// A variable with its type: `?n - node`.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Parameter {
    /// With its question mark.
    pub name: Symbol,
    /// `object` if the domain gives none.
    pub kind: Symbol,
}

/// One condition.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Literal {
    /// The fact holds (`true`) or does not.
    Fact(bool, Pattern),
    /// Both are the same object (`true`) or are not.
    Equal(bool, Term, Term),
}

/// All of these hold. Empty: always true.
pub type Condition = Vec<Literal>;

/// What an action makes true or false.
///
/// Everything that is removed is removed before anything is added, as PDDL has it.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Effect {
    /// Facts that no longer hold. A variable whose index is not among the action's parameters
    /// ranges over all objects: `(forall (?x - node) (not (at ?x)))`.
    pub remove: Vec<Pattern>,
    /// Facts that hold from then on.
    pub add: Vec<Pattern>,
}

/// A number that may depend on functions: `(/ (length ?arc) 0.8)`.
#[derive(Clone, Debug, PartialEq)]
pub enum Number {
    /// As written.
    Constant(f64),
    /// The value of a function.
    Function(Pattern),
    /// `+`
    Sum(Vec<Number>),
    /// `*`
    Product(Vec<Number>),
    /// `-` of two
    Difference(Box<Number>, Box<Number>),
    /// `/`
    Quotient(Box<Number>, Box<Number>),
}
