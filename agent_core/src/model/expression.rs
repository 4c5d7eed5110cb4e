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

/// One part of a condition, in negation normal form: `imply`, and `not` of anything larger than a
/// fact, are written by the others.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Clause {
    /// The fact holds (`true`) or does not.
    Fact(bool, Pattern),
    /// Both are the same object (`true`) or are not.
    Equal(bool, Term, Term),
    /// `or`: at least one of these holds.
    Any(Vec<Condition>),
    /// `forall`: for all objects of their types in the place of the variables, this holds.
    Every(Vec<Parameter>, Condition),
    /// `exists`: for some objects of their types in the place of the variables, this holds.
    Exists(Vec<Parameter>, Condition),
}

impl Clause {
    /// Calls `found` with every pattern of a fact in it.
    pub fn each_pattern(&self, found: &mut dyn FnMut(&Pattern)) {
        match self {
            Self::Fact(_, pattern) => found(pattern),
            Self::Equal(..) => {}
            Self::Any(choices) => {
                for clause in choices.iter().flatten() {
                    clause.each_pattern(found);
                }
            }
            Self::Every(_, inner) | Self::Exists(_, inner) => {
                for clause in inner {
                    clause.each_pattern(found);
                }
            }
        }
    }

    /// Calls `found` with every variable that a quantifier in it introduces.
    pub fn each_quantified(&self, found: &mut dyn FnMut(&Parameter)) {
        match self {
            Self::Fact(..) | Self::Equal(..) => {}
            Self::Any(choices) => {
                for clause in choices.iter().flatten() {
                    clause.each_quantified(found);
                }
            }
            Self::Every(variables, inner) | Self::Exists(variables, inner) => {
                variables.iter().for_each(&mut *found);
                for clause in inner {
                    clause.each_quantified(found);
                }
            }
        }
    }
}

/// All of these hold. Empty: always true.
///
/// Variables that a clause introduces are numbered on from those that are in scope where it stands:
/// with three parameters, the first variable of a `forall` is number 3, and number 4 is the
/// second, or the first of another `forall` within it.
pub type Condition = Vec<Clause>;

/// What an action makes true or false.
///
/// Everything that is removed is removed before anything is added, as PDDL has it.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Effect {
    /// Facts that no longer hold.
    pub remove: Vec<Change>,
    /// Facts that hold from then on.
    pub add: Vec<Change>,
}

/// Facts that an action adds or removes: `(forall (?x - node) (when (near ?x) (seen ?x)))`.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Change {
    /// `forall`: variables that range over all objects of their types, numbered on from the
    /// action's parameters. Mostly there are none.
    pub over: Vec<Parameter>,
    /// `when`: what must hold in the state in which the action begins. Mostly nothing.
    pub when: Condition,
    /// The fact.
    pub fact: Pattern,
}

impl From<Pattern> for Change {
    /// One fact, in any case.
    fn from(fact: Pattern) -> Self {
        Self {
            over: Vec::new(),
            when: Condition::new(),
            fact,
        }
    }
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
