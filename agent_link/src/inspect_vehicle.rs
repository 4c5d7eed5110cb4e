//! What a vehicle shows of itself: its agent, who does what, and what all know.

use agent_core::agent::Agent;
use agent_core::model::Symbol;
use agent_core::parallel::ParallelAgent;
use agent_core::planner::Planner;
use agent_core::service::{Outcome, Stage};
use agent_core::vehicle::Vehicle;
use serde_json::{Value, json};

use crate::inspect::Inspect;
use crate::inspect_agent::texts;

impl<P: Planner + Clone, Q: Planner> Inspect for Vehicle<ParallelAgent<P>, Q> {
    fn status(&self) -> Value {
        let mind = self.mind();
        let statuses: Vec<Value> = mind.agents().map(Inspect::status).collect();
        let branches: Vec<&Value> = statuses
            .iter()
            .filter(|status| !status["running"].is_null())
            .collect();
        let all = |of: &str| -> Value {
            let all = statuses.iter().filter_map(|status| status[of].as_array());
            all.flatten().cloned().collect()
        };
        let first = branches.first();
        let of_first = |of: &str| first.map_or(Value::Null, |status| status[of].clone());
        let absent = mind.foremost().absent().into_iter();
        json!({
            "phase": first.map_or(json!("idle"), |status| status["phase"].clone()),
            "running": of_first("running"),
            "action": of_first("action"),
            // All goals that are worked on; the first of them is the one above.
            "branches": branches.iter().map(|status| json!({
                "phase": status["phase"], "running": status["running"], "action": status["action"],
            })).collect::<Vec<_>>(),
            "suspended": all("suspended"),
            "waiting": all("waiting"),
            "aside": all("aside"),
            "stack_depth": mind.agents().map(|agent| agent.stack().depth()).sum::<usize>(),
            "holds": mind.agents().any(Agent::holds),
            "absent": absent.map(Symbol::as_str).collect::<Vec<_>>(),
            "together": mind.together(),
            "team": self.tasks().vehicles().map(Symbol::as_str).collect::<Vec<_>>(),
            "tasks": tasks(self),
            "needs": texts(self.states().needs()),
        })
    }

    fn belief(&self) -> Value {
        let mut shown = Inspect::belief(self.mind().list());
        let shared = self.states().table().iter().map(|(fact, known)| {
            json!({
                "fact": fact.to_string(),
                "holds": known.holds,
                "source": known.source.as_str(),
                "at_s": known.at.secs(),
            })
        });
        shown["shared"] = shared.collect();
        shown
    }

    fn plans(&self) -> Value {
        let running = self.mind().agents();
        let running = running.filter(|agent| agent.running().is_some());
        joined(running.map(Inspect::plans))
    }

    fn stack(&self) -> Value {
        joined(self.mind().agents().map(Inspect::stack))
    }

    fn alternatives(&self) -> Value {
        joined(self.mind().agents().map(Inspect::alternatives))
    }

    fn goals(&self) -> Value {
        let published = self.tasks().published().iter();
        let published = published.filter(|(id, _)| self.for_users().contains(*id));
        let published = published.map(|(id, task)| {
            json!({
                "id": id.as_str(),
                "tasks": [task.new.what.to_string()],
                "state": match &task.stage {
                    Stage::Open => "offered",
                    Stage::Given { .. } => "given",
                },
                "to": given_to(&task.stage),
            })
        });
        let ended = self.ended().rev().map(|ended| {
            let mut shown = json!({
                "id": ended.id.as_str(),
                "tasks": [ended.what.to_string()],
                "state": "ended",
                "at_s": ended.at.secs(),
            });
            let (outcome, reason) = match &ended.outcome {
                Outcome::Done { by } => {
                    if let Some(by) = by {
                        shown["by"] = json!(by.as_str());
                    }
                    ("succeeded", None)
                }
                Outcome::Failed { reason } => ("failed", Some(reason)),
                Outcome::Unknown { reason } => ("unknown", Some(reason)),
            };
            shown["outcome"] = json!(outcome);
            if let Some(reason) = reason {
                shown["reason"] = json!(reason);
            }
            shown
        });
        let own = joined(self.mind().agents().map(Inspect::goals));
        let published: Vec<Value> = published.chain(ended).collect();
        joined([Value::from(published), own].into_iter())
    }
}

/// Several lists as one.
fn joined(lists: impl Iterator<Item = Value>) -> Value {
    let lists = lists.filter_map(|list| match list {
        Value::Array(list) => Some(list),
        _ => None,
    });
    lists.flatten().collect()
}

fn given_to(stage: &Stage) -> Value {
    match stage {
        Stage::Open => Value::Null,
        Stage::Given { to, .. } => json!(to.as_str()),
    }
}

/// All tasks that are not over, as far as is known here: those that were published here, and those that
/// others have told of.
fn tasks<A, Q>(vehicle: &Vehicle<A, Q>) -> Value
where
    A: agent_core::vehicle::Mind,
    Q: Planner,
{
    let own = vehicle.tasks().published().iter().map(|(id, task)| {
        json!({
            "task": id.as_str(),
            "what": task.new.what.to_string(),
            "by": vehicle.name().as_str(),
            "to": given_to(&task.stage),
        })
    });
    let others = vehicle.tasks().heard_of().iter();
    let others = others.flat_map(|(by, heard)| {
        let shown = |task: &Symbol, what: String, to: Value| {
            json!({
                "task": task.as_str(),
                "what": what,
                "by": by.as_str(),
                "to": to,
                "heard_at_s": heard.at.secs(),
            })
        };
        let offers = heard.tasks.offers.iter();
        let offers = offers.map(move |it| shown(&it.task, it.what.to_string(), Value::Null));
        let awards = heard.tasks.awards.iter();
        let awards = awards.map(move |it| {
            let to = json!(it.to.as_str());
            shown(&it.task, it.what.to_string(), to)
        });
        offers.chain(awards)
    });
    own.chain(others).collect()
}
