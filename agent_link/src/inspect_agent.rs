//! What an agent shows of itself, at whatever level it is.

use agent_core::agent::{Agent, Ended, Goal, Intention, ResumedBy, WaitsFor};
use agent_core::model::{Atom, Domain, Symbol};
use agent_core::planner::{Plan, Planner};
use agent_core::protocol::{Report, Urgency};
use serde_json::{Value, json};

use crate::inspect::Inspect;
use crate::inspect_alternatives::alternatives;

impl<P: Planner> Inspect for Agent<P> {
    fn status(&self) -> Value {
        let action = self.executing().map(|(id, action, stopping)| {
            json!({ "id": id.to_string(), "action": action.to_string(), "stopping": stopping })
        });
        let phase = match (self.running(), self.executing()) {
            (None, _) => "idle",
            (Some(_), None) => "planning",
            (Some(_), Some((_, _, false))) => "executing",
            (Some(_), Some((_, _, true))) => "stopping",
        };
        let waiting = self.waiting().intentions().iter();
        let aside = self.aside().goals().iter().map(|(intention, waits_for)| {
            let mut goal = goal(&intention.goal);
            match waits_for {
                WaitsFor::User => goal["waits_for"] = json!("the user"),
                WaitsFor::Facts(facts) => goal["blocked_by"] = json!(texts(facts)),
            }
            goal
        });
        json!({
            "phase": phase,
            "running": self.running().map(|intention| goal(&intention.goal)),
            "action": action,
            "suspended": self.stack().entries().iter()
                .map(|entry| goal(&entry.intention.goal)).collect::<Vec<_>>(),
            "waiting": waiting.map(|intention| goal(&intention.goal)).collect::<Vec<_>>(),
            "aside": aside.collect::<Vec<_>>(),
            "stack_depth": self.stack().depth(),
            "counts": self.counts(),
            // Whether it stands still because the superior of one of its goals is not there.
            "holds": self.holds(),
            "absent": self.absent().into_iter().map(Symbol::as_str).collect::<Vec<_>>(),
        })
    }

    fn belief(&self) -> Value {
        let values = self.belief().values();
        json!({
            "facts": texts(self.belief().facts()),
            "values": values
                .map(|(function, value)| format!("(= {function} {value})"))
                .collect::<Vec<_>>(),
            // What facts and values can be about, with the number of their arguments.
            "words": words(self.domain()),
        })
    }

    fn plans(&self) -> Value {
        match self.running() {
            None => json!([]),
            Some(intention) => plans(intention),
        }
    }

    fn goals(&self) -> Value {
        let running = self.running().map(|running| &running.goal);
        let stack = self.stack().entries().iter();
        let suspended = stack.rev().map(|entry| &entry.intention.goal);
        let waiting = self.waiting().intentions().iter().map(|i| &i.goal);
        let aside = self.aside().goals().iter().map(|(i, _)| &i.goal);
        let live = std::iter::empty()
            .chain(running.map(|goal| (goal, "running")))
            .chain(suspended.map(|goal| (goal, "suspended")))
            .chain(waiting.map(|goal| (goal, "waiting")))
            .chain(aside.map(|goal| (goal, "aside")))
            .map(|(shown, state)| {
                let mut shown = goal(shown);
                shown["state"] = json!(state);
                shown
            });
        live.chain(self.ended().rev().map(ended)).collect()
    }

    fn alternatives(&self) -> Value {
        alternatives(self)
    }

    fn stack(&self) -> Value {
        let entries = self.stack().entries().iter().map(|entry| {
            let intention = &entry.intention;
            let records = intention.records.iter().map(|record| {
                json!({
                    "id": record.id.to_string(),
                    "executor": record.executor.as_str(),
                    "action": record.step.action().to_string(),
                })
            });
            let mut shown = goal(&intention.goal);
            shown["resumed_by"] = json!(match entry.resumed_by {
                ResumedBy::Agent => "agent",
                ResumedBy::Superior => "superior",
            });
            shown["holds"] = json!(intention.fits);
            shown["records"] = records.collect();
            shown["plans"] = plans(intention);
            shown
        });
        entries.collect()
    }
}

pub(crate) fn goal(goal: &Goal) -> Value {
    let mut shown = json!({
        "id": goal.id.as_str(),
        "tasks": texts(&goal.tasks),
        "urgency": match goal.urgency {
            Urgency::Normal => "normal",
            Urgency::Emergency => "emergency",
        },
        "priority": goal.priority,
    });
    if let Some(deadline) = goal.deadline {
        shown["deadline_s"] = json!(deadline.secs());
    }
    if let Some((superior, _)) = &goal.superior {
        shown["superior"] = json!(superior.as_str());
    }
    shown
}

fn ended(ended: &Ended) -> Value {
    let (outcome, reason) = match &ended.outcome {
        Report::Success { .. } => ("succeeded", None),
        Report::Failure { reason, .. } => ("failed", Some(reason)),
        Report::Unknown { reason, .. } => ("unknown", Some(reason)),
        Report::Started | Report::Progress { .. } | Report::Suspended { .. } => ("unknown", None),
    };
    let mut shown = json!({
        "id": ended.id.as_str(),
        "tasks": texts(&ended.tasks),
        "state": "ended",
        "outcome": outcome,
        "at_s": ended.at.secs(),
    });
    if let Some(reason) = reason {
        shown["reason"] = json!(reason);
    }
    if let Some((superior, _)) = &ended.superior {
        shown["superior"] = json!(superior.as_str());
    }
    shown
}

/// The one that is followed first.
fn plans(intention: &Intention) -> Value {
    let plans = intention.plans.iter().map(|plan: &Plan| {
        let rest = plan.rest.items().map(|item| item.atom());
        json!({
            "steps": texts(&plan.actions()),
            "rest": texts(rest),
            "cost": plan.cost.units(),
        })
    });
    plans.collect()
}

pub(crate) fn texts<'a>(atoms: impl IntoIterator<Item = &'a Atom>) -> Vec<String> {
    atoms.into_iter().map(ToString::to_string).collect()
}

fn words(domain: &Domain) -> Value {
    let words = domain.predicates.iter().chain(&domain.functions);
    let words = words.map(|(name, parameters)| (name.to_string(), json!(parameters.len())));
    Value::Object(words.collect())
}
