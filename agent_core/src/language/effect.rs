//! What an action makes true or false, and what it costs.

use std::collections::BTreeSet;

use super::error::Faults;
use super::expression::{Scope, UNSUPPORTED, unsupported};
use super::fit::Sort;
use super::tree::Tree;
use crate::model::{Change, Clause, Condition, Domain, Effect, Number, Parameter, Symbol, Term};

/// An effect as written: facts, and perhaps a cost.
#[derive(Default)]
pub(super) struct CostedEffect {
    pub(super) effect: Effect,
    pub(super) cost: Option<Number>,
}

/// Where an effect stands: within which quantifiers and conditions.
struct Place<'a> {
    /// The action's parameters and the quantified variables.
    scope: Scope<'a>,
    /// How many of these are the action's parameters.
    own: usize,
    /// The quantified variables again, each with a name of its own.
    over: Vec<Parameter>,
    when: Condition,
    /// How many clauses that are.
    size: usize,
}

impl CostedEffect {
    /// Adds one more effect, which may be a conjunction of several.
    pub(super) fn read(&mut self, tree: &Tree, scope: &Scope<'_>, faults: &mut Faults) {
        let place = Place {
            scope: *scope,
            own: scope.parameters.len(),
            over: Vec::new(),
            when: Condition::new(),
            size: 0,
        };
        self.read_in(tree, &place, faults);
    }

    fn read_in(&mut self, tree: &Tree, place: &Place<'_>, faults: &mut Faults) {
        match (tree.head(), tree.list()) {
            (_, Some([])) => {}
            (Some("and"), Some(items)) => {
                for item in &items[1..] {
                    self.read_in(item, place, faults);
                }
            }
            (Some("not"), Some(items)) => self.removed(tree, items, place, faults),
            (Some("forall"), _) => self.quantified(tree, place, faults),
            (Some("when"), Some(items)) => self.conditional(tree, items, place, faults),
            (Some("increase"), Some(items)) => self.increase(tree, &items[1..], place, faults),
            (Some(head @ ("or" | "imply" | "exists" | "=")), _) => {
                unsupported(tree, &format!("{head} in an effect"), faults);
            }
            (Some(head), _) if UNSUPPORTED.contains(&head) => unsupported(tree, head, faults),
            _ => {
                let added = self.change(tree, place, faults);
                self.effect.add.extend(added);
            }
        }
    }

    /// `(not (at ?x))`
    fn removed(&mut self, tree: &Tree, items: &[Tree], place: &Place<'_>, faults: &mut Faults) {
        let [_, inner] = items else {
            faults.add(tree.at, "`not` takes one fact: `(not (at ?x))`");
            return;
        };
        match inner.head() {
            Some("and" | "or" | "not" | "imply" | "forall" | "exists" | "when" | "=") => {
                unsupported(tree, "not of anything but a fact in an effect", faults);
            }
            _ => {
                let removed = self.change(inner, place, faults);
                self.effect.remove.extend(removed);
            }
        }
    }

    fn change(&self, tree: &Tree, place: &Place<'_>, faults: &mut Faults) -> Option<Change> {
        let parts = place.over.len() + place.size;
        if faults.copies_too_much(tree.at, parts) {
            return None;
        }
        Some(Change {
            fact: place.scope.pattern(tree, Sort::Predicate, faults)?,
            over: place.over.clone(),
            when: place.when.clone(),
        })
    }

    /// `(forall (?x - node) (not (at ?x)))`, with `?x` beyond the variables known so far.
    fn quantified(&mut self, tree: &Tree, place: &Place<'_>, faults: &mut Faults) {
        let Some((variables, body)) = place.scope.quantified(tree, faults) else {
            return;
        };
        let parameters = place.scope.with(&variables);
        if faults.copies_too_much(tree.at, place.size + parameters.len()) {
            return;
        }
        // Quantifiers in the conditions so far now stand behind these variables too.
        let mut when = place.when.clone();
        move_inner(&mut when, place.scope.parameters.len(), variables.len());
        let inner = Place {
            scope: Scope {
                parameters: &parameters,
                domain: place.scope.domain,
            },
            own: place.own,
            over: with_own_names(&parameters, place.own),
            when,
            size: place.size,
        };
        self.read_in(body, &inner, faults);
    }

    /// `(when (near ?x) (seen ?x))`
    fn conditional(&mut self, tree: &Tree, items: &[Tree], place: &Place<'_>, faults: &mut Faults) {
        let [_, given, body] = items else {
            faults.add(
                tree.at,
                "`when` takes a condition and an effect: `(when (near ?x) (seen ?x))`",
            );
            return;
        };
        if faults.copies_too_much(tree.at, place.size + place.over.len()) {
            return;
        }
        let mut when = place.when.clone();
        when.extend(place.scope.condition(given, faults));
        let inner = Place {
            scope: place.scope,
            own: place.own,
            over: place.over.clone(),
            size: size(&when),
            when,
        };
        self.read_in(body, &inner, faults);
    }

    fn increase(&mut self, tree: &Tree, items: &[Tree], place: &Place<'_>, faults: &mut Faults) {
        let [function, by] = items else {
            faults.add(tree.at, "write `(increase (total-cost) 3)`");
            return;
        };
        if function.head() != Some("total-cost") {
            faults.add(
                function.at,
                format!("only `(total-cost)` can be increased, not `{function}`"),
            );
            return;
        }
        if place.scope.parameters.len() > place.own || !place.when.is_empty() {
            faults.add(
                tree.at,
                "a cost within `when` or `forall` is not supported; write it beside them",
            );
            return;
        }
        let declared = |domain: &Domain| domain.functions.contains_key("total-cost");
        if place.scope.domain.is_none_or(declared) {
            place.scope.pattern(function, Sort::Function, faults);
        } else {
            let message = "`total-cost` is not declared; add `(:functions (total-cost) - number)`";
            faults.slip(function.at, message);
        }
        let cost = place.scope.number(by, faults);
        if matches!(cost, Some(Number::Constant(number)) if number < 0.0) {
            faults.add(by.at, "a cost cannot be negative");
        }
        if self.cost.is_some() {
            faults.add(tree.at, "the cost is given twice; write one sum `(+ … …)`");
        }
        self.cost = cost;
    }
}

/// The variables from number `own` on, none of them with the name of one before it: a fact may be
/// in several quantifiers, which a [`Change`] does not tell apart.
fn with_own_names(parameters: &[Parameter], own: usize) -> Vec<Parameter> {
    let (own, quantified) = parameters.split_at(own);
    let mut names: BTreeSet<Symbol> = own.iter().map(|own| own.name.clone()).collect();
    let mut out = Vec::new();
    for variable in quantified {
        let mut name = variable.name.clone();
        let mut number = 2;
        while names.contains(&name) {
            name = Symbol::from(format!("{}-{number}", variable.name));
            number += 1;
        }
        names.insert(name.clone());
        let kind = variable.kind.clone();
        out.push(Parameter { name, kind });
    }
    out
}

/// How many clauses a condition has, those within others included.
fn size(condition: &[Clause]) -> usize {
    let sizes = condition.iter().map(|clause| match clause {
        Clause::Fact(_, pattern) => 1 + pattern.args.len(),
        Clause::Equal(..) => 1,
        Clause::Any(choices) => 1 + choices.iter().map(|choice| size(choice) + 1).sum::<usize>(),
        Clause::Every(variables, inner) | Clause::Exists(variables, inner) => {
            1 + variables.len() + size(inner)
        }
    });
    sizes.sum()
}

/// Moves all variables from number `from` on by `by`: those that quantifiers in the condition
/// introduce, when variables are put in before them.
fn move_inner(condition: &mut Condition, from: usize, by: usize) {
    let term = |term: &mut Term| {
        if let Term::Variable(index) = term
            && *index >= from
        {
            *index += by;
        }
    };
    for clause in condition {
        match clause {
            Clause::Fact(_, pattern) => pattern.args.iter_mut().for_each(term),
            Clause::Equal(_, left, right) => [left, right].into_iter().for_each(term),
            Clause::Any(choices) => {
                for choice in choices {
                    move_inner(choice, from, by);
                }
            }
            Clause::Every(_, inner) | Clause::Exists(_, inner) => move_inner(inner, from, by),
        }
    }
}
