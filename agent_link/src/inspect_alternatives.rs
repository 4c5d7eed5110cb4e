//! An agent's alternatives as JSON.

use agent_core::agent::{Against, Agent, Alternative, Alternatives, Choice, GoalPlace};
use agent_core::model::Cost;
use agent_core::planner::{Planner, Reliance, WhatIf};
use serde_json::{Value, json};

use crate::inspect_agent::{goal, texts};

/// One entry for each goal, in the order of [`Agent::alternatives`].
pub(crate) fn alternatives<P: Planner>(agent: &Agent<P>) -> Value {
    agent.alternatives().iter().map(of_goal).collect()
}

fn of_goal(of: &Alternatives<'_>) -> Value {
    let mut shown = goal(&of.intention.goal);
    shown["place"] = json!(match of.place {
        GoalPlace::Running => "running",
        GoalPlace::Suspended => "suspended",
        GoalPlace::Waiting => "waiting",
        GoalPlace::Aside => "aside",
    });
    shown["plans"] = of.plans.iter().map(plan).collect();
    shown["choice"] = of.choice.as_ref().map_or(Value::Null, choice);
    shown["what_if"] = of.what_if.as_ref().map_or(Value::Null, what_if);
    shown["complete"] = json!(of.complete);
    shown
}

fn plan(alternative: &Alternative) -> Value {
    let plan = &alternative.plan;
    json!({
        "steps": texts(&plan.actions()),
        "rest": texts(plan.rest.items().map(|item| item.atom())),
        "cost": alternative.cost.units(),
        "kept": alternative.kept,
        "holds": alternative.broken.is_none(),
        "why_not": alternative.broken,
        "hangs_on": alternative.hangs_on.iter().map(reliance).collect::<Vec<_>>(),
    })
}

/// The condition as the domain would write it.
fn reliance(reliance: &Reliance) -> Value {
    let condition = match reliance.wanted {
        true => reliance.fact.to_string(),
        false => format!("(not {})", reliance.fact),
    };
    json!({
        "condition": condition,
        "holds": reliance.given,
        "changes_alone": reliance.changes_alone,
        "step": reliance.step,
    })
}

fn choice(choice: &Choice) -> Value {
    let (against, by) = match choice.against_others {
        Against::None => ("no_other", Cost::ZERO),
        Against::Less(by) => ("less", by),
        Against::Same => ("same", Cost::ZERO),
        Against::More(by) => ("more", by),
    };
    json!({
        "against_others": against,
        "by": by.units(),
        "resumes": choice.resumes.as_ref().map(ToString::to_string),
        "undoes": choice.undoes.as_ref().map(ToString::to_string),
    })
}

fn what_if(what_if: &WhatIf) -> Value {
    let changes = what_if.changes.iter().map(ToString::to_string);
    json!({
        "changes": changes.collect::<Vec<_>>(),
        "steps": texts(&what_if.plan.actions()),
        "cost": what_if.plan.cost.units(),
    })
}
