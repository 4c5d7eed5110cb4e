//! A lower bound of what a list of tasks costs, from the execution model's estimates.

use std::collections::BTreeSet;

use super::Problem;
use super::cost::{cost_of, least_cost_of};
use super::matching::for_each_binding;
use super::network::{Item, TaskList};
use super::state::{Delta, View, bind_arguments};
use crate::model::{Cost, Pattern, Symbol, Term};

/// Never more than the cheapest way to do `tasks` from the state `delta` costs, if no estimate of
/// the execution model is.
///
/// Each task is estimated in the state that the one before it leaves: an action by its effect, an
/// abstract task by what it establishes. After a task of which that is not known only those
/// actions count that cost the same everywhere.
pub(super) fn estimate(problem: &Problem, delta: &Delta, tasks: &TaskList) -> Cost {
    let mut state = Some(delta.clone());
    let mut total = Cost::ZERO;
    let mut left = tasks.len();
    for item in tasks.items() {
        left -= 1;
        let Some(delta) = &state else {
            let view = View { problem, delta };
            total = total + least_cost_of(view, item.atom());
            continue;
        };
        let view = View { problem, delta };
        let (cost, after) = estimate_one(view, item, left > 0);
        total = total + cost;
        state = after;
    }
    total
}

/// The estimate of one item, and if `go_on`, the state after it, if that is known.
fn estimate_one(view: View<'_>, item: &Item, go_on: bool) -> (Cost, Option<Delta>) {
    let task = item.atom();
    if let Some(operator) = view.problem.domain.operators.get(&task.name) {
        let bindings = bind_arguments(&task.args, &operator.parameters);
        let cost = cost_of(view, task);
        return (cost, go_on.then(|| view.after(&operator.effect, &bindings)));
    }
    let Some(model) = view.problem.model.tasks.get(&task.name) else {
        return (Cost::ZERO, None);
    };
    let mut best: Option<(Cost, Option<Delta>)> = None;
    for_each_binding(
        view,
        &model.parameters,
        &model.given,
        bind_arguments(&task.args, &model.parameters),
        &mut BTreeSet::new(),
        &mut |bindings| {
            let cost = view
                .number(&model.estimate, bindings)
                .map_or(Cost::ZERO, Cost::from_units);
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                let after = go_on.then(|| establish(view, &model.establishes, bindings));
                best = Some((cost, after));
            }
        },
    );
    best.unwrap_or((Cost::ZERO, None))
}

/// The state in which `facts` hold and no others of their predicates do.
fn establish(view: View<'_>, facts: &[Pattern], bindings: &[Option<Symbol>]) -> Delta {
    let mut delta = view.delta.clone();
    for pattern in facts {
        // Variables that are bound to nothing, so that everything matches.
        let any = Pattern {
            name: pattern.name.clone(),
            args: vec![Term::Variable(usize::MAX); pattern.args.len()],
        };
        for fact in view.matching(&any, bindings) {
            view.set(&mut delta, fact, false);
        }
    }
    for pattern in facts {
        if let Some(fact) = pattern.ground(bindings) {
            view.set(&mut delta, fact, true);
        }
    }
    delta
}
