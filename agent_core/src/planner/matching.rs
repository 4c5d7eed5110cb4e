//! All ways to bind the variables of a condition so that it holds.

use std::collections::BTreeSet;

use super::state::{Bindings, View};
use crate::model::{Clause, Condition, Fact, Parameter, Pattern, Symbol, Term};

/// Calls `found` with every binding of `parameters` that makes `condition` hold, beginning with
/// `bindings`. Of what is bound from the beginning the type is not asked; there may be more of it
/// than parameters.
///
/// Facts of observable predicates that were asked for and did not hold are added to `wanted`: if
/// nothing else helps, a plan waits for them.
pub(super) fn for_each_binding(
    view: View<'_>,
    parameters: &[Parameter],
    condition: &[Clause],
    bindings: Bindings,
    wanted: &mut BTreeSet<Fact>,
    found: &mut dyn FnMut(&Bindings),
) {
    let mut query = Query {
        view,
        parameters,
        wanted,
        found,
    };
    let open: Vec<&Clause> = condition.iter().collect();
    query.solve(&open, bindings);
}

struct Query<'a, 'b> {
    view: View<'a>,
    parameters: &'b [Parameter],
    wanted: &'b mut BTreeSet<Fact>,
    found: &'b mut dyn FnMut(&Bindings),
}

impl Query<'_, '_> {
    fn solve(&mut self, open: &[&Clause], mut bindings: Bindings) {
        // First whatever can be decided now, as it costs least and prunes most.
        let mut undecided = Vec::with_capacity(open.len());
        for literal in open {
            match self.decide(literal, &bindings) {
                Some(true) => {}
                Some(false) => return,
                None => undecided.push(*literal),
            }
        }
        // Then bind by a fact that must hold, …
        let binder = undecided
            .iter()
            .position(|literal| matches!(literal, Clause::Fact(true, _)));
        if let Some(binder) = binder
            && let Clause::Fact(_, pattern) = undecided.remove(binder)
        {
            for fact in self.view.matching(pattern, &bindings) {
                if let Some(bindings) = self.unify(pattern, &fact, &bindings) {
                    self.solve(&undecided, bindings);
                }
            }
            return;
        }
        // … and what no fact binds, by all objects of its type.
        let Some(free) = bindings.iter().position(Option::is_none) else {
            (self.found)(&bindings);
            return;
        };
        for object in self.view.problem.objects_of(&self.parameters[free].kind) {
            bindings[free] = Some(object);
            self.solve(&undecided, bindings.clone());
        }
    }

    /// Whether a literal holds, if its variables are bound.
    fn decide(&mut self, literal: &Clause, bindings: &Bindings) -> Option<bool> {
        match literal {
            Clause::Equal(wanted, a, b) => {
                Some((a.bound(bindings)? == b.bound(bindings)?) == *wanted)
            }
            Clause::Fact(wanted, pattern) => {
                let fact = pattern.ground(bindings)?;
                let holds = self.view.holds(&fact) == *wanted;
                if !holds && self.view.problem.model.observable.contains(&fact.name) {
                    self.wanted.insert(fact);
                }
                Some(holds)
            }
            _ if !is_bound(literal, bindings) => None,
            Clause::Any(choices) => Some(
                choices
                    .iter()
                    .any(|choice| self.some(&[], choice, bindings)),
            ),
            Clause::Exists(variables, inner) => Some(self.some(variables, inner, bindings)),
            Clause::Every(variables, inner) => Some(self.every(variables, inner, bindings)),
        }
    }

    /// Whether `condition` holds for some objects in the place of `variables`.
    fn some(&mut self, variables: &[Parameter], condition: &Condition, outer: &Bindings) -> bool {
        let (parameters, bindings) = self.with(variables, outer);
        let mut holds = false;
        for_each_binding(
            self.view,
            &parameters,
            condition,
            bindings,
            self.wanted,
            &mut |_| holds = true,
        );
        holds
    }

    /// Whether `condition` holds for all objects in the place of `variables`.
    fn every(&mut self, variables: &[Parameter], condition: &Condition, outer: &Bindings) -> bool {
        let (parameters, bindings) = self.with(variables, outer);
        let mut all = Vec::new();
        for_each_binding(
            self.view,
            &parameters,
            &[],
            bindings,
            self.wanted,
            &mut |bindings| all.push(bindings.clone()),
        );
        let mut inner = Query {
            view: self.view,
            parameters: &parameters,
            wanted: &mut *self.wanted,
            found: &mut |_| {},
        };
        all.iter()
            .all(|bindings| inner.some(&[], condition, bindings))
    }

    /// The variables in scope and then those of a quantifier, which nothing binds as yet.
    ///
    /// A quantifier is only decided when all that it speaks of is bound, so that variables which
    /// are still free are of no interest within it.
    fn with(&self, variables: &[Parameter], outer: &Bindings) -> (Vec<Parameter>, Bindings) {
        let free = Symbol::from("object");
        let outside = Parameter {
            name: Symbol::from(""),
            kind: free.clone(),
        };
        let mut parameters = vec![outside; outer.len()];
        parameters.extend(variables.iter().cloned());
        let some = |object: &Option<Symbol>| Some(object.clone().unwrap_or_else(|| free.clone()));
        let mut bindings: Bindings = outer.iter().map(some).collect();
        bindings.resize(parameters.len(), None);
        (parameters, bindings)
    }

    /// `bindings` with those that make `pattern` the `fact`, if types allow.
    fn unify(&self, pattern: &Pattern, fact: &Fact, bindings: &Bindings) -> Option<Bindings> {
        let mut bindings = bindings.clone();
        for (term, arg) in pattern.args.iter().zip(&fact.args) {
            if let Term::Variable(index) = term {
                match &bindings[*index] {
                    Some(bound) if bound != arg => return None,
                    Some(_) => {}
                    None => {
                        if !self.view.problem.fits(arg, &self.parameters[*index].kind) {
                            return None;
                        }
                        bindings[*index] = Some(arg.clone());
                    }
                }
            }
        }
        Some(bindings)
    }
}

/// Whether everything is bound that a clause speaks of, apart from variables of its own.
fn is_bound(clause: &Clause, bindings: &Bindings) -> bool {
    let bound = |term: &Term| match term {
        Term::Variable(index) => bindings.get(*index).is_none_or(Option::is_some),
        Term::Constant(_) => true,
    };
    match clause {
        Clause::Fact(_, pattern) => pattern.args.iter().all(bound),
        Clause::Equal(_, left, right) => bound(left) && bound(right),
        Clause::Any(choices) => choices
            .iter()
            .flatten()
            .all(|inner| is_bound(inner, bindings)),
        Clause::Every(_, inner) | Clause::Exists(_, inner) => {
            inner.iter().all(|inner| is_bound(inner, bindings))
        }
    }
}
