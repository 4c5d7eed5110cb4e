//! What an action makes true or false, and what it costs.

use std::collections::BTreeSet;

use super::error::Faults;
use super::expression::{NOT_YET, Scope, not_yet};
use super::fit::Sort;
use super::tree::Tree;
use super::typed_list::parameters;
use crate::model::{Change, Effect, Number, Parameter, Pattern, Term};

/// An effect as written: facts, and perhaps a cost.
#[derive(Default)]
pub(super) struct CostedEffect {
    pub(super) effect: Effect,
    pub(super) cost: Option<Number>,
}

impl CostedEffect {
    /// Adds one more effect, which may be a conjunction of several.
    pub(super) fn read(&mut self, tree: &Tree, scope: &Scope<'_>, faults: &mut Faults) {
        match (tree.head(), tree.list()) {
            (_, Some([])) => {}
            (Some("and"), Some(items)) => {
                for item in &items[1..] {
                    self.read(item, scope, faults);
                }
            }
            (Some("not"), _) => self
                .effect
                .remove
                .extend(removed(tree, scope, faults).map(Change::from)),
            (Some("forall"), _) => self.effect.remove.extend(quantified(tree, scope, faults)),
            (Some("increase"), Some(items)) => self.increase(tree, &items[1..], scope, faults),
            (Some(head), _) if head == "=" || NOT_YET.contains(&head) => {
                not_yet(tree, head, faults);
            }
            _ => {
                let added = scope.pattern(tree, Sort::Predicate, faults);
                self.effect.add.extend(added.map(Change::from));
            }
        }
    }

    fn increase(&mut self, tree: &Tree, items: &[Tree], scope: &Scope<'_>, faults: &mut Faults) {
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
        scope.pattern(function, Sort::Function, faults);
        let cost = scope.number(by, faults);
        if matches!(cost, Some(Number::Constant(number)) if number < 0.0) {
            faults.add(by.at, "a cost cannot be negative");
        }
        if self.cost.is_some() {
            faults.add(tree.at, "the cost is given twice; write one sum `(+ … …)`");
        }
        self.cost = cost;
    }
}

/// The pattern in `(not (at ?x))`.
fn removed(tree: &Tree, scope: &Scope<'_>, faults: &mut Faults) -> Option<Pattern> {
    match tree.list() {
        Some([_, inner]) => match inner.head() {
            Some(head) if matches!(head, "and" | "not" | "=") || NOT_YET.contains(&head) => {
                not_yet(tree, "not of anything but a fact", faults);
                None
            }
            _ => scope.pattern(inner, Sort::Predicate, faults),
        },
        _ => {
            faults.add(tree.at, "`not` takes one fact: `(not (at ?x))`");
            None
        }
    }
}

/// The pattern in `(forall (?x - node) (not (at ?x)))`, with `?x` beyond the scope's parameters.
fn quantified(tree: &Tree, scope: &Scope<'_>, faults: &mut Faults) -> Option<Change> {
    let Some([_, variables, body]) = tree.list() else {
        faults.add(
            tree.at,
            "write `(forall (?x - node) (not (at ?x)))`: variables, then one effect",
        );
        return None;
    };
    let Some(variables) = variables.list() else {
        faults.add(variables.at, "expected variables such as `(?x - node)`");
        return None;
    };
    if body.head() != Some("not") {
        not_yet(tree, "forall of anything but one `(not …)`", faults);
        return None;
    }
    let mut all = scope.parameters.to_vec();
    for quantified in parameters(variables, scope.domain, faults) {
        if all.iter().any(|known| known.name == quantified.name) {
            let name = &quantified.name;
            faults.add(
                tree.at,
                format!("`{name}` is already a parameter; give the quantified one another name"),
            );
        }
        all.push(quantified);
    }
    let inner = Scope {
        parameters: &all,
        domain: scope.domain,
    };
    let pattern = removed(body, &inner, faults)?;
    narrowed(tree, &pattern, &all, scope, faults);
    // Each place of a fact is matched by itself, so that `?x` twice would be any two objects.
    let mut seen = BTreeSet::new();
    for argument in &pattern.args {
        if let Term::Variable(index) = argument
            && *index >= scope.parameters.len()
            && !seen.insert(*index)
        {
            not_yet(tree, "forall with one variable in two places", faults);
        }
    }
    Some(Change {
        over: all.split_off(scope.parameters.len()),
        when: Vec::new(),
        fact: pattern,
    })
}

/// A quantified variable ranges over everything that can stand in its place. One of a narrower
/// type would remove less than that, which an [`Effect`] cannot say.
fn narrowed(
    tree: &Tree,
    pattern: &Pattern,
    all: &[Parameter],
    scope: &Scope<'_>,
    faults: &mut Faults,
) {
    let Some((domain, declared)) = scope
        .domain
        .and_then(|domain| Some((domain, domain.predicates.get(&pattern.name)?)))
    else {
        return;
    };
    for (argument, wanted) in pattern.args.iter().zip(declared) {
        let Term::Variable(index) = argument else {
            continue;
        };
        let Some(variable) = all.get(*index).filter(|_| *index >= scope.parameters.len()) else {
            continue;
        };
        // Types that exclude each other are a fault already.
        let narrower = !domain.is_a(&wanted.kind, &variable.kind);
        if narrower && domain.is_a(&variable.kind, &wanted.kind) {
            faults.add(
                tree.at,
                format!(
                    "`forall` over some objects only is not supported yet: let `{}` be of type \
                     {}, as `{}` declares it",
                    variable.name, wanted.kind, pattern.name
                ),
            );
        }
    }
}
