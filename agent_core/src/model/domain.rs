//! The domain as its author declared it in HDDL.

use std::collections::BTreeMap;

use super::{Condition, Effect, Number, Parameter, Pattern, Symbol};

/// A planning domain, total-order: what can be done, and how tasks are decomposed.
///
/// Whoever makes one has checked that every name used is declared, with the right number of
/// arguments of fitting types (`language`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Domain {
    /// `(define (domain NAME)`.
    pub name: Symbol,
    /// Type and its supertype; `object` stands above all and is not listed.
    pub types: BTreeMap<Symbol, Symbol>,
    /// `(either a b)`, written out as its name, and the types that are joined in it. Such a name
    /// stands where a type can; it has blanks, so that it is nobody else's.
    pub unions: BTreeMap<Symbol, Vec<Symbol>>,
    /// Objects that every problem has, and their types.
    pub constants: BTreeMap<Symbol, Symbol>,
    /// Predicate and its parameters.
    pub predicates: BTreeMap<Symbol, Vec<Parameter>>,
    /// Function and its parameters.
    pub functions: BTreeMap<Symbol, Vec<Parameter>>,
    /// Abstract task and its parameters.
    pub tasks: BTreeMap<Symbol, Vec<Parameter>>,
    /// In the order in which they are written.
    pub methods: Vec<Method>,
    /// Action and its declaration.
    pub operators: BTreeMap<Symbol, Operator>,
}

impl Default for Symbol {
    fn default() -> Self {
        Self::from("")
    }
}

/// One way to do an abstract task.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// Its name.
    pub name: Symbol,
    /// All variables that occur in it.
    pub parameters: Vec<Parameter>,
    /// The task that it does.
    pub task: Pattern,
    /// When it may be used.
    pub precondition: Condition,
    /// What is to be done instead, in this order.
    pub subtasks: Vec<Pattern>,
}

/// An action as declared, with variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Operator {
    /// Its name.
    pub name: Symbol,
    /// Its parameters: the arguments of every action made of it.
    pub parameters: Vec<Parameter>,
    /// When it may be executed.
    pub precondition: Condition,
    /// What it brings about.
    pub effect: Effect,
    /// `(increase (total-cost) …)`; nothing, if the author gave none.
    pub cost: Number,
}

impl Domain {
    /// Whether every object of type `kind` is one of type `wanted`.
    pub fn is_a(&self, kind: &Symbol, wanted: &Symbol) -> bool {
        if wanted == "object" {
            return true;
        }
        if let Some(members) = self.unions.get(wanted) {
            return match self.unions.get(kind) {
                // A union is within another if each of its members is.
                Some(given) => given.iter().all(|kind| self.is_a(kind, wanted)),
                None => members.iter().any(|member| self.is_a(kind, member)),
            };
        }
        if let Some(given) = self.unions.get(kind) {
            return given.iter().all(|kind| self.is_a(kind, wanted));
        }
        // Bounded by the number of types: a cycle of supertypes ends here too.
        let mut kind = kind;
        for _ in 0..=self.types.len() {
            if kind == wanted {
                return true;
            }
            match self.types.get(kind) {
                Some(above) => kind = above,
                None => return false,
            }
        }
        false
    }
}
