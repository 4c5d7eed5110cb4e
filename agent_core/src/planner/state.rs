//! The world as it would be after some actions.

use std::collections::{BTreeMap, BTreeSet};

use super::Problem;
use super::matching::for_each_binding;
use crate::model::{
    Belief, Change, Clause, Effect, Fact, Number, Parameter, Pattern, Symbol, Term,
};

/// What is different from the belief.
///
/// Invariant: no entry says what the belief and the map say anyway, so two ways to the same state
/// have equal deltas. [`View::turn`] keeps it so.
pub(super) type Delta = BTreeMap<Fact, bool>;

/// A value for every parameter that has one.
pub(super) type Bindings = Vec<Option<Symbol>>;

/// The belief and the map, overlaid with what actions have changed since.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub problem: &'a Problem,
    pub delta: &'a Delta,
}

impl<'a> View<'a> {
    fn before(&self, fact: &Fact) -> bool {
        self.problem.belief.holds(fact) || self.problem.map.facts.holds(fact)
    }

    /// Whether the fact holds.
    pub fn holds(&self, fact: &Fact) -> bool {
        self.delta
            .get(fact)
            .copied()
            .unwrap_or_else(|| self.before(fact))
    }

    /// All facts that match `pattern` as far as its variables are bound, in order.
    pub fn matching(&self, pattern: &Pattern, bindings: &[Option<Symbol>]) -> Vec<Fact> {
        let bound: Vec<Option<Symbol>> = pattern
            .args
            .iter()
            .map(|term| term.bound(bindings))
            .collect();
        let prefix: Vec<Symbol> = bound.iter().map_while(Clone::clone).collect();
        let fits = |fact: &Fact| {
            fact.args.len() == bound.len()
                && fact
                    .args
                    .iter()
                    .zip(&bound)
                    .all(|(arg, bound)| bound.as_ref().is_none_or(|bound| bound == arg))
        };
        let layer = |belief: &'a Belief| {
            belief
                .with_prefix(&pattern.name, &prefix)
                .filter(|fact| fits(fact) && self.delta.get(*fact) != Some(&false))
        };
        let from = Fact {
            name: pattern.name.clone(),
            args: prefix.clone(),
        };
        let added = self
            .delta
            .range(from..)
            .take_while(|(fact, _)| fact.name == pattern.name && fact.args.starts_with(&prefix))
            .filter(|(fact, holds)| **holds && fits(fact))
            .map(|(fact, _)| fact);
        let mut found: Vec<Fact> = layer(&self.problem.belief)
            .chain(layer(&self.problem.map.facts))
            .chain(added)
            .cloned()
            .collect();
        found.sort();
        found.dedup();
        found
    }

    /// The value of an expression; `None` if a function in it has none.
    pub fn number(&self, number: &Number, bindings: &[Option<Symbol>]) -> Option<f64> {
        Some(match number {
            Number::Constant(value) => *value,
            Number::Function(pattern) => {
                let function = pattern.ground(bindings)?;
                let belief = self.problem.belief.value(&function);
                belief.or_else(|| self.problem.map.facts.value(&function))?
            }
            Number::Sum(terms) => {
                let terms = terms.iter().map(|term| self.number(term, bindings));
                terms.sum::<Option<f64>>()?
            }
            Number::Product(factors) => {
                let factors = factors.iter().map(|factor| self.number(factor, bindings));
                factors.product::<Option<f64>>()?
            }
            Number::Difference(a, b) => self.number(a, bindings)? - self.number(b, bindings)?,
            Number::Quotient(a, b) => self.number(a, bindings)? / self.number(b, bindings)?,
        })
    }

    /// The state after an effect, as a new delta.
    pub fn after(&self, effect: &Effect, bindings: &[Option<Symbol>]) -> Delta {
        let mut delta = self.delta.clone();
        for (fact, holds) in self.changes(effect, bindings) {
            Self::turn(self.problem, &mut delta, fact, holds);
        }
        delta
    }

    /// What an effect makes of this state, in the order in which it does.
    pub fn changes(&self, effect: &Effect, bindings: &[Option<Symbol>]) -> Vec<(Fact, bool)> {
        let mut found = Vec::with_capacity(effect.remove.len() + effect.add.len());
        for (changes, holds) in [(&effect.remove, false), (&effect.add, true)] {
            for change in changes {
                self.each_fact(change, holds, bindings, &mut |fact| {
                    found.push((fact, holds));
                });
            }
        }
        found
    }

    /// The facts that a change is about in this state.
    pub fn each_fact(
        &self,
        change: &Change,
        holds: bool,
        bindings: &[Option<Symbol>],
        found: &mut dyn FnMut(Fact),
    ) {
        if change.over.is_empty() && change.when.is_empty() {
            change.fact.ground(bindings).into_iter().for_each(found);
            return;
        }
        if !holds && change.when.is_empty() && self.each_of_all(change, bindings, found) {
            return;
        }
        // Only what holds needs to be removed, which binds the variables faster than their types.
        let mut when = change.when.clone();
        if !holds {
            when.insert(0, Clause::Fact(true, change.fact.clone()));
        }
        let mut parameters = of_any_type(bindings);
        parameters.extend(change.over.iter().cloned());
        let mut all = bindings.to_vec();
        all.resize(parameters.len(), None);
        for_each_binding(
            *self,
            &parameters,
            &when,
            all,
            &mut BTreeSet::new(),
            &mut |bindings| {
                change
                    .fact
                    .ground(bindings)
                    .into_iter()
                    .for_each(&mut *found)
            },
        );
    }

    /// The same where nothing is said but that all facts of a kind are removed, as most effects do that
    /// quantify: `(forall (?x - node) (not (at ?x)))`. Returns whether it is so.
    fn each_of_all(
        &self,
        change: &Change,
        bindings: &[Option<Symbol>],
        found: &mut dyn FnMut(Fact),
    ) -> bool {
        let stands_for = |term: &Term, variable: usize| match term {
            Term::Variable(index) => *index == bindings.len() + variable,
            Term::Constant(_) => false,
        };
        let args = &change.fact.args;
        let once = (0..change.over.len()).all(|variable| {
            args.iter()
                .filter(|term| stands_for(term, variable))
                .count()
                == 1
        });
        let bound = |term: &Term| match term {
            Term::Variable(index) if *index < bindings.len() => bindings[*index].is_some(),
            _ => true,
        };
        if !once || !args.iter().all(bound) {
            return false;
        }
        let mut all = bindings.to_vec();
        all.resize(bindings.len() + change.over.len(), None);
        for fact in self.matching(&change.fact, &all) {
            let of_its_type = |(term, arg): (&Term, &Symbol)| match term {
                Term::Variable(index) if *index >= bindings.len() => {
                    let declared = change.over.get(*index - bindings.len());
                    declared.is_none_or(|variable| self.problem.fits(arg, &variable.kind))
                }
                _ => true,
            };
            if args.iter().zip(&fact.args).all(of_its_type) {
                found(fact);
            }
        }
        true
    }

    /// Makes a fact hold or not in `delta`.
    pub fn set(&self, delta: &mut Delta, fact: Fact, holds: bool) {
        Self::turn(self.problem, delta, fact, holds);
    }

    /// The same, in a delta that nobody else looks at.
    pub fn turn(problem: &Problem, delta: &mut Delta, fact: Fact, holds: bool) {
        let before = problem.belief.holds(&fact) || problem.map.facts.holds(&fact);
        if before == holds {
            delta.remove(&fact);
        } else {
            delta.insert(fact, holds);
        }
    }

    /// Whether a condition with all its variables bound holds; else, in words, the first part that
    /// does not.
    pub fn check(&self, condition: &[Clause], bindings: &[Option<Symbol>]) -> Result<(), String> {
        for clause in condition {
            match clause {
                Clause::Fact(wanted, pattern) => {
                    let Some(fact) = pattern.ground(bindings) else {
                        continue;
                    };
                    if self.holds(&fact) != *wanted {
                        let not = if *wanted { " does not hold" } else { " holds" };
                        return Err(format!("{fact}{not}"));
                    }
                }
                Clause::Equal(wanted, a, b) => {
                    if (a.bound(bindings) == b.bound(bindings)) != *wanted {
                        return Err(String::from("its arguments do not differ as they must"));
                    }
                }
                Clause::Any(_) | Clause::Every(..) | Clause::Exists(..) => {
                    let mut holds = false;
                    for_each_binding(
                        *self,
                        &of_any_type(bindings),
                        std::slice::from_ref(clause),
                        bindings.to_vec(),
                        &mut BTreeSet::new(),
                        &mut |_| holds = true,
                    );
                    if !holds {
                        return Err(String::from("its condition does not hold"));
                    }
                }
            }
        }
        Ok(())
    }
}

/// Parameters in whose place stand `bindings`, so that variables of quantifiers are numbered on from
/// there. The types of what is bound already are not asked for.
fn of_any_type(bindings: &[Option<Symbol>]) -> Vec<Parameter> {
    let any = |_: &Option<Symbol>| Parameter {
        name: Symbol::from(""),
        kind: Symbol::from("object"),
    };
    bindings.iter().map(any).collect()
}

/// The arguments of an atom as bindings of the parameters of its declaration.
pub(super) fn bind_arguments(args: &[Symbol], parameters: &[Parameter]) -> Bindings {
    let mut bindings: Bindings = args.iter().cloned().map(Some).collect();
    bindings.resize(parameters.len().max(args.len()), None);
    bindings
}
