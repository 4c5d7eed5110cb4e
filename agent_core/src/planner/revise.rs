//! Whether a plan still holds, and fitting plans to what was executed.

use std::collections::BTreeSet;

use super::Problem;
use super::cost::cost_of;
use super::matching::for_each_binding;
use super::network::Item;
use super::plan::{Plan, Step};
use super::state::{Delta, View, bind_arguments};
use crate::model::{
    Action, Belief, Change, Clause, Cost, Effect, FactChange, Number, Parameter, Pattern,
};

/// Carries a plan out in mind, from the present belief (Algorithm 1, step 3c).
///
/// Returns what its steps cost now or, in words, why it breaks. If the first step is `running`, its
/// precondition was true when it began and need not be now.
pub fn simulate(problem: &Problem, steps: &[Step], running: bool) -> Result<Cost, String> {
    let mut delta = Delta::new();
    let mut total = Cost::ZERO;
    for (index, step) in steps.iter().enumerate() {
        let view = View {
            problem,
            delta: &delta,
        };
        let action = step.action();
        let Some(operator) = problem.domain.operators.get(&action.name) else {
            return Err(format!("{action} is not an action of this domain"));
        };
        let bindings = bind_arguments(&action.args, &operator.parameters);
        if problem.forbidden.contains(step.purpose()) {
            return Err(format!("{} has failed too often", step.purpose()));
        }
        if !(running && index == 0) {
            view.check(&operator.precondition, &bindings)
                .map_err(|why| format!("{why}, which {action} needs"))?;
        }
        total = total + cost_of(view, action);
        let changes = view.changes(&operator.effect, &bindings);
        for (fact, holds) in changes {
            View::turn(problem, &mut delta, fact, holds);
        }
    }
    Ok(total)
}

/// What an action changes in the present belief, as its operator says.
pub fn effect_of(problem: &Problem, action: &Action) -> Vec<FactChange> {
    let operator = problem.domain.operators.get(&action.name);
    operator.map_or_else(Vec::new, |operator| {
        changes(problem, &operator.effect, action, &operator.parameters)
    })
}

/// What suspending an action changes in the present belief (Algorithm 1, step 1).
pub fn effect_of_suspension(problem: &Problem, action: &Action) -> Vec<FactChange> {
    let model = problem.model.actions.get(&action.name);
    let suspension = model.and_then(|model| model.suspension.as_ref());
    let operator = problem.domain.operators.get(&action.name);
    suspension
        .zip(operator)
        .map_or_else(Vec::new, |(suspension, operator)| {
            changes(problem, &suspension.effect, action, &operator.parameters)
        })
}

fn changes(
    problem: &Problem,
    effect: &Effect,
    action: &Action,
    parameters: &[Parameter],
) -> Vec<FactChange> {
    let delta = Delta::new();
    let view = View {
        problem,
        delta: &delta,
    };
    view.after(effect, &bind_arguments(&action.args, parameters))
        .into_iter()
        .map(|(fact, holds)| match holds {
            true => FactChange::Add(fact),
            false => FactChange::Remove(fact),
        })
        .collect()
}

/// What must hold as long as a step runs. A resumed action protects what it did before, but for what its
/// suspension has taken away: a bottle that was set down at the edge no longer stands in its place.
pub fn protected_by<'p>(
    problem: &'p Problem,
    step: &Step,
) -> impl Iterator<Item = &'p Clause> + use<'p> {
    let model = problem.model.actions.get(&step.purpose().name);
    let resumed = matches!(step.item, Item::Resume { .. });
    let suspension = model.and_then(|model| model.suspension.as_ref());
    let suspension = suspension.filter(|_| resumed);
    let taken_away = move |clause: &Clause| {
        let (Some(suspension), Clause::Fact(wanted, pattern)) = (suspension, clause) else {
            return false;
        };
        let change = Change::from(pattern.clone());
        match wanted {
            true => suspension.effect.remove.contains(&change),
            false => suspension.effect.add.contains(&change),
        }
    };
    let clauses = model.into_iter().flat_map(|model| &model.protected);
    clauses.filter(move |clause| !taken_away(clause))
}

/// In words, the first of a step's protected states that does not hold.
pub fn broken_protection(problem: &Problem, step: &Step) -> Option<String> {
    let delta = Delta::new();
    let view = View {
        problem,
        delta: &delta,
    };
    let bindings = bind_arguments(&step.purpose().args, &[]);
    let check = |clause| view.check(std::slice::from_ref(clause), &bindings);
    protected_by(problem, step).find_map(|clause| check(clause).err())
}

/// In words, the first of an action's goal states that does not hold.
pub fn missing_goal_state(problem: &Problem, action: &Action) -> Option<String> {
    let delta = Delta::new();
    let view = View {
        problem,
        delta: &delta,
    };
    let model = problem.model.actions.get(&action.name)?;
    view.check(&model.goal_states, &bind_arguments(&action.args, &[]))
        .err()
}

/// A number of the execution model, for an action.
pub fn number_of(problem: &Problem, number: &Number, action: &Action) -> Option<f64> {
    let delta = Delta::new();
    let view = View {
        problem,
        delta: &delta,
    };
    view.number(number, &bind_arguments(&action.args, &[]))
}

/// What a pattern of the execution model is, for an action.
pub fn instance(pattern: &Pattern, action: &Action) -> Option<Action> {
    pattern.ground(&bind_arguments(&action.args, &[]))
}

/// Deletes an executed action from the head of a plan, if it stands there.
pub fn advance(plan: &mut Plan, executed: &Action) -> bool {
    let stands_there = plan
        .steps
        .first()
        .is_some_and(|step| step.purpose() == executed);
    if stands_there {
        let step = plan.steps.remove(0);
        plan.cost = Cost(plan.cost.0.saturating_sub(step.cost.0));
    }
    stands_there
}

/// How the present belief looks one level up (the paper, section 6: to a parent, its child is an
/// executor, and facts are about the parent's world).
pub fn project(problem: &Problem) -> Belief {
    let delta = Delta::new();
    let view = View {
        problem,
        delta: &delta,
    };
    let mut above = Vec::new();
    for rule in &problem.model.projections {
        for_each_binding(
            view,
            &rule.parameters,
            &rule.when,
            vec![None; rule.parameters.len()],
            &mut BTreeSet::new(),
            &mut |bindings| above.extend(rule.then.ground(bindings)),
        );
    }
    above.into_iter().collect()
}
