//! What an action costs in a state.

use std::collections::BTreeSet;

use super::matching::for_each_binding;
use super::state::{View, bind_arguments};
use crate::model::{Action, Cost};

/// By the first rule of the execution model that matches, else by the operator. What has no value
/// costs nothing.
pub(super) fn cost_of(view: View<'_>, action: &Action) -> Cost {
    let model = view.problem.model.actions.get(&action.name);
    for rule in model.into_iter().flat_map(|model| &model.costs) {
        let mut least: Option<Cost> = None;
        for_each_binding(
            view,
            &rule.parameters,
            &rule.given,
            bind_arguments(&action.args, &rule.parameters),
            &mut BTreeSet::new(),
            &mut |bindings| {
                let cost = view.number(&rule.cost, bindings).map(Cost::from_units);
                least = least.into_iter().chain(cost).min();
            },
        );
        if let Some(cost) = least {
            return cost;
        }
    }
    cost_by_operator(view, action)
}

/// What an action costs in any state, if that is known; nothing for a task.
pub(super) fn least_cost_of(view: View<'_>, action: &Action) -> Cost {
    let model = view.problem.model.actions.get(&action.name);
    match model.is_some_and(|model| !model.costs.is_empty()) {
        true => Cost::ZERO,
        false => cost_by_operator(view, action),
    }
}

fn cost_by_operator(view: View<'_>, action: &Action) -> Cost {
    let operator = view.problem.domain.operators.get(&action.name);
    operator
        .and_then(|operator| {
            view.number(
                &operator.cost,
                &bind_arguments(&action.args, &operator.parameters),
            )
        })
        .map_or(Cost::ZERO, Cost::from_units)
}
