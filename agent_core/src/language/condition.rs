//! Conditions, brought into negation normal form as they are read.

use super::error::Faults;
use super::expression::{Scope, UNSUPPORTED, unsupported};
use super::fit::Sort;
use super::tree::Tree;
use super::typed_list::kind_named;
use crate::model::{Clause, Condition, Parameter, Symbol, Term};

impl Scope<'_> {
    /// All that must hold. `()` is nothing.
    pub(super) fn condition(&self, tree: &Tree, faults: &mut Faults) -> Condition {
        self.signed(tree, true, faults)
    }

    /// The condition (`holds`) or its opposite.
    fn signed(&self, tree: &Tree, holds: bool, faults: &mut Faults) -> Condition {
        let Some(items) = tree.list() else {
            return self.fact(tree, holds, faults); // which explains what is wrong
        };
        let Some((head, rest)) = items.split_first() else {
            return all_or_any(Vec::new(), holds);
        };
        match head.word() {
            Some("and") => all_or_any(self.each(rest, holds, faults), holds),
            Some("or") => all_or_any(self.each(rest, holds, faults), !holds),
            Some("not") => match rest {
                [inner] => self.signed(inner, !holds, faults),
                _ => {
                    faults.add(tree.at, "`not` takes one condition: `(not (at ?x))`");
                    Condition::new()
                }
            },
            Some("imply") => match rest {
                [given, then] => {
                    let given = self.signed(given, !holds, faults);
                    all_or_any(vec![given, self.signed(then, holds, faults)], !holds)
                }
                _ => {
                    faults.add(tree.at, "`imply` takes two conditions: `(imply (a) (b))`");
                    Condition::new()
                }
            },
            Some(word @ ("forall" | "exists")) => {
                let Some((variables, body)) = self.quantified(tree, faults) else {
                    return Condition::new();
                };
                let parameters = self.with(&variables);
                let inner = Scope {
                    parameters: &parameters,
                    domain: self.domain,
                };
                let body = inner.signed(body, holds, faults);
                quantify((word == "forall") == holds, variables, body)
            }
            Some("=") => self.equality(tree, rest, holds, faults),
            Some("typeof" | "sortof" | "sort") => self.kind(tree, rest, holds, faults),
            Some(word) if UNSUPPORTED.contains(&word) && !self.is_predicate(word) => {
                unsupported(tree, word, faults);
                Condition::new()
            }
            _ => self.fact(tree, holds, faults),
        }
    }

    fn is_predicate(&self, word: &str) -> bool {
        self.domain
            .is_some_and(|domain| domain.predicates.contains_key(word))
    }

    fn each(&self, trees: &[Tree], holds: bool, faults: &mut Faults) -> Vec<Condition> {
        let read = |tree| self.signed(tree, holds, faults);
        trees.iter().map(read).collect()
    }

    fn fact(&self, tree: &Tree, holds: bool, faults: &mut Faults) -> Condition {
        let pattern = self.pattern(tree, Sort::Predicate, faults);
        let fact = pattern.map(|pattern| Clause::Fact(holds, pattern));
        fact.into_iter().collect()
    }

    fn equality(&self, tree: &Tree, sides: &[Tree], holds: bool, faults: &mut Faults) -> Condition {
        let [left, right] = sides else {
            faults.add(tree.at, "`=` takes two arguments: `(= ?x ?y)`");
            return Condition::new();
        };
        if left.list().is_some() || right.list().is_some() {
            unsupported(tree, "= of numbers in a condition", faults);
            return Condition::new();
        }
        let left = self.known_term(left, faults);
        let right = self.known_term(right, faults);
        match (left, right) {
            (Some(left), Some(right)) => vec![Clause::Equal(holds, left, right)],
            _ => Condition::new(),
        }
    }

    /// `(sortof ?x - room)`: some room is `?x`.
    fn kind(&self, tree: &Tree, rest: &[Tree], holds: bool, faults: &mut Faults) -> Condition {
        let [term, dash, kind] = rest else {
            // It may well be a predicate of that name.
            return self.fact(tree, holds, faults);
        };
        if dash.word() != Some("-") {
            return self.fact(tree, holds, faults);
        }
        let term = self.known_term(term, faults);
        let (Some(term), Some(kind)) = (term, kind_named(kind, self.domain, faults)) else {
            return Condition::new();
        };
        let name = Symbol::from("?of-that-type");
        let same = Clause::Equal(holds, Term::Variable(self.parameters.len()), term);
        quantify(!holds, vec![Parameter { name, kind }], vec![same])
    }
}

/// All of these conditions (`all`), or at least one.
fn all_or_any(mut conditions: Vec<Condition>, all: bool) -> Condition {
    if all {
        return conditions.into_iter().flatten().collect();
    }
    // One that is always true decides.
    if let Some(always) = conditions.iter().position(Condition::is_empty) {
        return conditions.swap_remove(always);
    }
    match (conditions.pop(), conditions.is_empty()) {
        (Some(only), true) => only,
        (last, _) => {
            conditions.extend(last);
            vec![Clause::Any(conditions)]
        }
    }
}

fn quantify(every: bool, variables: Vec<Parameter>, body: Condition) -> Condition {
    if variables.is_empty() || (every && body.is_empty()) {
        return body;
    }
    vec![if every {
        Clause::Every(variables, body)
    } else {
        Clause::Exists(variables, body)
    }]
}
