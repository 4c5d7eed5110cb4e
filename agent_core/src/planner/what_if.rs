//! What it would take for a better plan.

use std::collections::BTreeSet;

use super::hangs_on::{hangs_on, with_changes};
use super::{Agenda, NaivePlanner, Outcome, Plan, Planner, Problem, Settings, simulate};
use crate::model::{Cost, Fact, FactChange};

/// A plan that would be followed if some facts were otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct WhatIf {
    /// What would have to be different.
    pub changes: Vec<FactChange>,
    /// The plan that there would be then.
    pub plan: Plan,
}

/// What came of looking at a problem without following anything.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Considered {
    /// Plans that there are, cheapest first.
    pub plans: Vec<Plan>,
    /// A cheaper plan that there is not, and what it wants. With no plan, any.
    pub what_if: Option<WhatIf>,
    /// Whether all was looked at that was to be, within the budget.
    pub complete: bool,
    /// Nodes that were expanded.
    pub expanded: u64,
}

/// Looks for plans, and for one that would cost less than `best` and all of those if facts that
/// can change without the agent were otherwise than they are, with at most `budget` expansions.
///
/// First everything that was asked for and was not so is taken for granted, and what the plan that
/// comes of it needs is then put to the test: with these changes and no others, planning finds it.
pub fn consider(
    problem: &Problem,
    agendas: &[Agenda],
    settings: Settings,
    best: Option<Cost>,
    budget: u64,
) -> Considered {
    let mut considered = Considered::default();
    let Some(now) = plan(problem, agendas, settings, budget) else {
        considered.expanded = budget;
        return considered;
    };
    considered.expanded = now.expanded;
    let best = now.plans.iter().map(|plan| plan.cost).chain(best).min();
    considered.plans = now.plans;
    // What the map says for good cannot be otherwise.
    let missing: BTreeSet<Fact> = (now.wanted.into_iter())
        .filter(|fact| !problem.map.facts.holds(fact))
        .collect();
    considered.complete = true;
    if missing.is_empty() {
        return considered;
    }
    let one = Settings {
        alternatives: 1,
        ..settings
    };
    let mut with = |wanted: &BTreeSet<Fact>| {
        let changes = wanted
            .iter()
            .map(|fact| (fact, !problem.belief.holds(fact)));
        let problem = with_changes(problem, changes);
        let left = budget.saturating_sub(considered.expanded);
        let outcome = plan(&problem, agendas, one, left);
        considered.complete &= outcome.is_some();
        considered.expanded += outcome.as_ref().map_or(left, |outcome| outcome.expanded);
        let plan = outcome.map(|outcome| outcome.plans.into_iter().next());
        (plan, problem)
    };
    let cheaper = |plan: &Plan| best.is_none_or(|best| plan.cost < best);
    let (found, otherwise) = with(&missing);
    let Some(plan) = found.flatten().filter(cheaper) else {
        return considered;
    };
    let needed: BTreeSet<Fact> = hangs_on(&otherwise, &plan.steps, false)
        .into_iter()
        .map(|reliance| reliance.fact)
        .filter(|fact| missing.contains(fact))
        .collect();
    let (needed, plan) = match with(&needed).0 {
        Some(Some(confirmed)) if cheaper(&confirmed) => (needed, confirmed),
        // What only methods ask for is not to be seen in the steps.
        Some(_) => (missing, plan),
        // Out of budget. That the plan can be carried out is known.
        None => (needed, plan),
    };
    let change = |fact: Fact| match problem.belief.holds(&fact) {
        true => FactChange::Remove(fact),
        false => FactChange::Add(fact),
    };
    considered.what_if = Some(WhatIf {
        changes: needed.into_iter().map(change).collect(),
        plan,
    });
    considered
}

/// A plan that does not hold and would be followed if facts that can change without the agent were
/// as it has them: without any planning, so there may be better ones.
pub fn if_mended(problem: &Problem, plan: &Plan, best: Option<Cost>) -> Option<WhatIf> {
    let missing = hangs_on(problem, &plan.steps, false).into_iter();
    let missing: Vec<_> = missing.filter(|reliance| !reliance.given).collect();
    if missing.is_empty() || !missing.iter().all(|reliance| reliance.changes_alone) {
        return None;
    }
    let changes = missing.iter().map(|it| (&it.fact, it.wanted));
    let cost = simulate(&with_changes(problem, changes), &plan.steps, false).ok()?;
    best.is_none_or(|best| cost < best).then(|| WhatIf {
        changes: (missing.into_iter())
            .map(|reliance| match reliance.wanted {
                true => FactChange::Add(reliance.fact),
                false => FactChange::Remove(reliance.fact),
            })
            .collect(),
        plan: Plan {
            cost,
            ..plan.clone()
        },
    })
}

/// What planning from scratch finds; `None` if so many expansions are not enough.
fn plan(problem: &Problem, agendas: &[Agenda], settings: Settings, budget: u64) -> Option<Outcome> {
    if budget == 0 {
        return None;
    }
    let mut planner = NaivePlanner::new(settings);
    planner.begin(problem.clone(), agendas);
    planner.think(budget)
}

#[cfg(test)]
mod tests;
