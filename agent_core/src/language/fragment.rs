//! Pieces of the language outside a domain: goals, reports, and the texts of an execution model.

use super::effect::CostedEffect;
use super::error::{Faults, LanguageError};
use super::expression::{Scope, object};
use super::fit::Sort;
use super::number::decimal;
use super::tree::{self, Tree};
use super::typed_list::{name, parameters};
use crate::model::{Atom, Clause, Domain, Effect, FactChange, Number, Parameter, Pattern, Task};

/// Reads one atom without variables: `(at n1)`.
///
/// Whether it is declared is for whoever has the domain to say.
pub fn parse_atom(text: &str) -> Result<Atom, LanguageError> {
    one(text, atom)
}

/// Reads one task `(go n40)`, or several that are to be done in turn:
/// `(and (show n2) (show n12))`.
pub fn parse_tasks(text: &str) -> Result<Vec<Task>, LanguageError> {
    one(text, |tree, faults| match (tree.head(), tree.list()) {
        (Some("and"), Some([_])) => {
            faults.add(tree.at, "there is no task in this `(and)`");
            None
        }
        (Some("and"), Some(items)) => items[1..].iter().map(|item| atom(item, faults)).collect(),
        _ => Some(vec![atom(tree, faults)?]),
    })
}

/// Reads what is different now: `(open d)`, `(not (open d))` or `(= (gap arc5 n6) 3.2)`.
pub fn parse_fact_change(text: &str) -> Result<FactChange, LanguageError> {
    one(text, |tree, faults| match (tree.head(), tree.list()) {
        (Some("not"), Some([_, fact])) => Some(FactChange::Remove(atom(fact, faults)?)),
        (Some("="), Some([_, function, value])) => {
            let function = atom(function, faults)?;
            match value.word().and_then(decimal) {
                Some(value) => Some(FactChange::Set(function, value)),
                None => {
                    faults.add(value.at, format!("expected a number, found `{value}`"));
                    None
                }
            }
        }
        (Some("not"), _) => {
            faults.add(tree.at, "`not` takes one fact: `(not (open d))`");
            None
        }
        (Some("="), _) => {
            faults.add(tree.at, "write `(= (gap arc5 n6) 3.2)`");
            None
        }
        _ => Some(FactChange::Add(atom(tree, faults)?)),
    })
}

/// Reads one variable with its type: `?a - area`. Without a type it is an `object`.
pub fn parse_parameter(text: &str) -> Result<Parameter, LanguageError> {
    let mut faults = Faults::default();
    let trees = tree::read(text, &mut faults);
    let found = parameters(&trees, None, &mut faults);
    let mut found = found.into_iter();
    if let (Some(parameter), None) = (found.next(), found.next()) {
        return finish(text, faults, Some(parameter));
    }
    faults.add(0, "expected one variable such as `?a - area`");
    finish(text, faults, None)
}

/// Reads an atom with variables: `(resume-enter ?from ?to ?d)`. A name without a question mark
/// is an object.
pub fn parse_pattern(text: &str, parameters: &[Parameter]) -> Result<Pattern, LanguageError> {
    let scope = undeclared(parameters);
    one(text, |tree, faults| scope.pattern(tree, Sort::Step, faults))
}

/// Reads one condition: `(open ?d)`, `(not (at ?n))`, `(or (open ?d) (= ?x ?y))`.
pub fn parse_literal(text: &str, parameters: &[Parameter]) -> Result<Clause, LanguageError> {
    let scope = undeclared(parameters);
    one(text, |tree, faults| {
        let mut clauses = scope.condition(tree, faults);
        match (clauses.pop(), clauses.is_empty()) {
            (Some(clause), true) => Some(clause),
            (Some(_), false) => {
                faults.add(tree.at, "write the conditions of this one by one");
                None
            }
            (None, _) => {
                if faults.is_empty() {
                    faults.add(tree.at, "this is always true; remove it");
                }
                None
            }
        }
    })
}

/// Reads effects one by one: `(on ?arc)`, `(not (at ?from))`,
/// `(forall (?x - node) (not (at ?x)))`.
///
/// Unlike a [`Pattern`], an [`Effect`] no longer tells the type of a quantified variable; that is
/// why these are checked against their declarations here.
pub fn parse_effects<S: AsRef<str>>(
    texts: &[S],
    parameters: &[Parameter],
    domain: &Domain,
) -> Result<Effect, LanguageError> {
    let scope = Scope {
        parameters,
        domain: Some(domain),
    };
    let mut costed = CostedEffect::default();
    for text in texts {
        one(text.as_ref(), |tree, faults| {
            costed.read(tree, &scope, faults);
            if costed.cost.is_some() {
                faults.add(tree.at, "a cost belongs to the action, in the domain");
            }
            Some(())
        })?;
    }
    Ok(costed.effect)
}

/// Reads a number: `30`, `(length ?arc)`, `(+ 60 (* 4 (crossing ?from ?to ?d)))`.
pub fn parse_number(text: &str, parameters: &[Parameter]) -> Result<Number, LanguageError> {
    let scope = undeclared(parameters);
    one(text, |tree, faults| scope.number(tree, faults))
}

fn undeclared(parameters: &[Parameter]) -> Scope<'_> {
    Scope {
        parameters,
        domain: None,
    }
}

fn atom(tree: &Tree, faults: &mut Faults) -> Option<Atom> {
    let Some((head, rest)) = tree.list().and_then(|items| items.split_first()) else {
        faults.add(
            tree.at,
            format!("expected something like `(at n1)`, found `{tree}`"),
        );
        return None;
    };
    let name = name(head, "a name", faults)?;
    let args = rest
        .iter()
        .map(|item| object(item, faults))
        .collect::<Option<_>>()?;
    Some(Atom { name, args })
}

/// Reads a text that must hold exactly one tree.
fn one<T>(
    text: &str,
    read: impl FnOnce(&Tree, &mut Faults) -> Option<T>,
) -> Result<T, LanguageError> {
    let mut faults = Faults::default();
    let trees = tree::read(text, &mut faults);
    let value = match trees.as_slice() {
        [tree] => read(tree, &mut faults),
        [] => None,
        [_, second, ..] => {
            let message = format!("nothing may follow, but `{second}` does");
            faults.add(second.at, message);
            None
        }
    };
    finish(text, faults, value)
}

/// The value if there is no fault, or else the first fault.
fn finish<T>(text: &str, mut faults: Faults, value: Option<T>) -> Result<T, LanguageError> {
    faults.be_strict();
    match (faults.into_errors(text).into_iter().next(), value) {
        (None, Some(value)) => Ok(value),
        (Some(fault), _) => Err(fault),
        (None, None) => Err(LanguageError {
            line: 1,
            column: 1,
            message: "this is empty".to_owned(),
        }),
    }
}
