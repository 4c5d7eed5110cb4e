//! Whether a name with arguments fits its declaration.

use std::collections::BTreeMap;
use std::fmt;

use super::near::hint;
use crate::model::{Domain, Parameter, Pattern, Symbol, Term};

/// What a name is to be.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Sort {
    /// Declared in `(:predicates …)`.
    Predicate,
    /// Declared in `(:functions …)`.
    Function,
    /// Declared by `(:task …)`.
    Task,
    /// Declared by `(:action …)`.
    Action,
    /// A task or an action.
    Step,
}

impl fmt::Display for Sort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Predicate => "a declared predicate",
            Self::Function => "a declared function",
            Self::Task => "a declared task",
            Self::Action => "a declared action",
            Self::Step => "a declared task or action",
        })
    }
}

/// Why a name with arguments does not fit its declaration.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum Misfit {
    /// Nothing of that name and sort is declared.
    #[error("`{name}` is not {sort}{hint}")]
    Undeclared {
        /// As written.
        name: Symbol,
        /// What it was to be.
        sort: Sort,
        /// What to do, or nothing.
        hint: String,
    },
    /// It is declared with another number of parameters.
    #[error("`{name}` takes {wanted} argument(s) and is given {given}")]
    Arity {
        /// As written.
        name: Symbol,
        /// As many as are declared.
        wanted: usize,
        /// As many as are written.
        given: usize,
    },
    /// No argument of this type can be one of the declared type.
    #[error("`{argument}` is of type {given}, but `{name}` takes {wanted} there")]
    Kind {
        /// As written.
        name: Symbol,
        /// The variable or constant.
        argument: Symbol,
        /// Its type.
        given: Symbol,
        /// The type declared.
        wanted: Symbol,
    },
    /// A name that is neither a variable nor a constant of the domain.
    #[error("`{name}` is not declared among the constants or objects{hint}")]
    NoConstant {
        /// As written.
        name: Symbol,
        /// What to do, or nothing.
        hint: String,
    },
}

/// How closely the type of an argument must fit.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Closeness {
    /// Some object may be of both types: a condition then selects these.
    Possible,
    /// Every object of the argument's type is of the declared type.
    Always,
}

/// The declared parameters of a name.
pub(super) fn declared<'a>(domain: &'a Domain, sort: Sort, name: &str) -> Option<&'a [Parameter]> {
    let list = |of: &'a BTreeMap<Symbol, Vec<Parameter>>| of.get(name).map(Vec::as_slice);
    let action = || Some(domain.operators.get(name)?.parameters.as_slice());
    match sort {
        Sort::Predicate => list(&domain.predicates),
        Sort::Function => list(&domain.functions),
        Sort::Task => list(&domain.tasks),
        Sort::Action => action(),
        Sort::Step => list(&domain.tasks).or_else(action),
    }
}

/// Whether `kind` stands in the domain; `object` always does.
pub(super) fn type_is_declared(domain: &Domain, kind: &Symbol) -> bool {
    *kind == "object" || domain.types.contains_key(kind) || domain.unions.contains_key(kind)
}

/// What to do about a name that is not of the sort wanted.
pub(super) fn undeclared_hint(domain: &Domain, sort: Sort, name: &str) -> String {
    let among: Vec<&Symbol> = match sort {
        Sort::Predicate => domain.predicates.keys().collect(),
        Sort::Function => domain.functions.keys().collect(),
        Sort::Task => domain.tasks.keys().collect(),
        Sort::Action => domain.operators.keys().collect(),
        Sort::Step => domain.tasks.keys().chain(domain.operators.keys()).collect(),
    };
    let other = [
        (Sort::Predicate, "; it is a predicate"),
        (Sort::Function, "; it is a function"),
        (Sort::Task, "; it is a task"),
        (Sort::Action, "; it is an action"),
    ]
    .into_iter()
    .find(|(other, _)| declared(domain, *other, name).is_some());
    match other {
        Some((_, what)) => what.to_owned(),
        None => hint(name, among.into_iter().map(Symbol::as_str), ""),
    }
}

/// Everything about `pattern` that does not fit its declaration, with the argument's index.
///
/// A variable beyond `parameters` is quantified, and of a type that whoever read it has checked.
pub(super) fn misfits(
    domain: &Domain,
    sort: Sort,
    pattern: &Pattern,
    parameters: &[Parameter],
    closeness: Closeness,
) -> Vec<(Option<usize>, Misfit)> {
    let Some(wanted) = declared(domain, sort, pattern.name.as_str()) else {
        return vec![(
            None,
            Misfit::Undeclared {
                name: pattern.name.clone(),
                sort,
                hint: undeclared_hint(domain, sort, pattern.name.as_str()),
            },
        )];
    };
    let mut found = Vec::new();
    if wanted.len() != pattern.args.len() {
        found.push((
            None,
            Misfit::Arity {
                name: pattern.name.clone(),
                wanted: wanted.len(),
                given: pattern.args.len(),
            },
        ));
    }
    for (index, argument) in pattern.args.iter().enumerate() {
        let (name, kind) = match argument {
            Term::Variable(variable) => match parameters.get(*variable) {
                Some(parameter) => (&parameter.name, &parameter.kind),
                None => continue,
            },
            Term::Constant(name) => match domain.constants.get(name) {
                Some(kind) => (name, kind),
                None => {
                    found.push((Some(index), no_constant(domain, name, parameters)));
                    continue;
                }
            },
        };
        let Some(wanted) = wanted.get(index) else {
            continue;
        };
        let always = domain.is_a(kind, &wanted.kind);
        let fits = match closeness {
            Closeness::Always => always,
            Closeness::Possible => always || domain.is_a(&wanted.kind, kind),
        };
        // A type that is not declared is a fault of its own.
        let known = type_is_declared(domain, kind) && type_is_declared(domain, &wanted.kind);
        if known && !fits {
            found.push((
                Some(index),
                Misfit::Kind {
                    name: pattern.name.clone(),
                    argument: name.clone(),
                    given: kind.clone(),
                    wanted: wanted.kind.clone(),
                },
            ));
        }
    }
    found
}

/// The fault of a name that is neither variable nor constant.
pub(super) fn no_constant(domain: &Domain, name: &Symbol, parameters: &[Parameter]) -> Misfit {
    let as_variable = format!("?{name}");
    let hint = if parameters
        .iter()
        .any(|known| known.name == as_variable.as_str())
    {
        format!("; did you mean `{as_variable}`?")
    } else {
        let constants = domain.constants.keys().map(Symbol::as_str);
        let otherwise = match parameters {
            [] => "",
            _ => "; a variable begins with `?`",
        };
        hint(name.as_str(), constants, otherwise)
    };
    let name = name.clone();
    Misfit::NoConstant { name, hint }
}
