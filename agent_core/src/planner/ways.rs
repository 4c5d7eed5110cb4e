//! What an action makes of the world, and which actions would make a fact so.

use std::collections::BTreeSet;

use super::Problem;
use super::matching::for_each_binding;
use super::state::{Bindings, Delta, View, bind_arguments};
use crate::model::{Action, Change, Fact, Operator, Term};

/// The facts that an action adds, and those that it removes and does not add, as its operator says:
/// also those that are so already, which [`effect_of`](super::effect_of) leaves out. What a `forall`
/// removes is what holds of it now.
pub fn adds_and_removes(problem: &Problem, action: &Action) -> (BTreeSet<Fact>, BTreeSet<Fact>) {
    let (mut adds, mut removes) = (BTreeSet::new(), BTreeSet::new());
    let Some(operator) = problem.domain.operators.get(&action.name) else {
        return (adds, removes);
    };
    let delta = Delta::new();
    let view = View {
        problem,
        delta: &delta,
    };
    let bindings = bind_arguments(&action.args, &operator.parameters);
    for (fact, holds) in view.changes(&operator.effect, &bindings) {
        match holds {
            true => adds.insert(fact),
            false => removes.insert(fact),
        };
    }
    removes.retain(|fact| !adds.contains(fact));
    (adds, removes)
}

/// Every action that can be executed in the present belief and makes the fact hold, or not hold, as
/// `wanted`.
pub fn ways_to(problem: &Problem, fact: &Fact, wanted: bool) -> Vec<Action> {
    let delta = Delta::new();
    let view = View {
        problem,
        delta: &delta,
    };
    let mut found = Vec::new();
    for (name, operator) in &problem.domain.operators {
        let effect = &operator.effect;
        let changes = match wanted {
            true => &effect.add,
            false => &effect.remove,
        };
        for bindings in changes
            .iter()
            .filter_map(|change| unify(problem, operator, change, fact))
        {
            for_each_binding(
                view,
                &operator.parameters,
                &operator.precondition,
                bindings,
                &mut BTreeSet::new(),
                &mut |bindings| {
                    let args = bindings.iter().take(operator.parameters.len());
                    let args: Option<Vec<_>> = args.cloned().collect();
                    found.extend(args.map(|args| Action {
                        name: name.clone(),
                        args,
                    }));
                },
            );
        }
    }
    found.sort();
    found.dedup();
    found.retain(|action| {
        let (adds, removes) = adds_and_removes(problem, action);
        match wanted {
            true => adds.contains(fact),
            false => removes.contains(fact),
        }
    });
    found
}

/// What the operator's parameters must be for this change to be about that fact.
fn unify(problem: &Problem, operator: &Operator, change: &Change, fact: &Fact) -> Option<Bindings> {
    let pattern = &change.fact;
    if pattern.name != fact.name || pattern.args.len() != fact.args.len() {
        return None;
    }
    let mut bindings: Bindings = vec![None; operator.parameters.len()];
    for (term, arg) in pattern.args.iter().zip(&fact.args) {
        match term {
            Term::Constant(constant) if constant != arg => return None,
            Term::Constant(_) => {}
            Term::Variable(index) => {
                // Others are those of a `forall`, and stand for anything of their type.
                let Some(parameter) = operator.parameters.get(*index) else {
                    continue;
                };
                if !problem.fits(arg, &parameter.kind) {
                    return None;
                }
                match &bindings[*index] {
                    Some(bound) if bound != arg => return None,
                    _ => bindings[*index] = Some(arg.clone()),
                }
            }
        }
    }
    Some(bindings)
}
