//! For programs: one JSON object a line.

use agent_core::model::{Symbol, Time};
use agent_core::protocol::Event;
use agent_link::wire;
use serde_json::{Value, json};

use super::Screen;
use crate::robot::{Robot, RoleKind, RoleNews};
use crate::scenario::{Told, What};

/// Writes the events as the agents publish them, and between them, as agent `intermezzo`, what
/// this command itself does.
#[derive(Debug, Default)]
pub(crate) struct JsonLines;

impl JsonLines {
    /// The robot takes goals from now on.
    pub(crate) fn ready(&self, robot: &Robot) {
        let processes = robot.processes.iter();
        let processes = processes.map(|(role, pid)| (role.to_string(), json!(pid)));
        line(
            robot.clock.now(),
            "ready",
            json!({
                "robot": robot.keys.robot(),
                "endpoint": robot.endpoint,
                "speed": robot.clock.speed(),
                "processes": processes.collect::<serde_json::Map<_, _>>(),
            }),
        );
    }

    /// There is nothing more to come.
    pub(crate) fn end(&self, at: Time, success: bool, failed: &[String]) {
        line(at, "end", json!({ "success": success, "failed": failed }));
    }
}

impl Screen for JsonLines {
    fn event(&mut self, agent: &Symbol, event: &Event) {
        match wire::event_to_line(agent.as_str(), event) {
            Ok(line) => anstream::println!("{line}"),
            Err(error) => tracing::warn!("an event cannot be written: {error}"),
        }
    }

    fn told(&mut self, at: Time, told: &Told) {
        let (name, event) = match told {
            Told::Said(event) => ("scenario", event),
            Told::Refused(event, _) => ("refused", event),
        };
        let mut body = json!({ "line": event.line });
        if let Some(say) = &event.say {
            body["say"] = json!(say);
        }
        match &event.what {
            None => {}
            Some(What::Goal { request: goal, .. }) => {
                body["goal"] = json!(goal.id.as_ref().map(Symbol::as_str));
                let tasks = goal.tasks.iter().map(ToString::to_string);
                body["tasks"] = tasks.collect::<Value>();
            }
            Some(What::Fact(fact)) => body["fact"] = json!(fact.to_string()),
            Some(What::Command(command)) => {
                if let Ok(command) = wire::command_to_wire(command) {
                    body["command"] = json!(command);
                }
            }
        }
        if let Told::Refused(_, reason) = told {
            body["reason"] = json!(reason);
        }
        line(at, name, body);
    }

    fn role(&mut self, at: Time, news: &RoleNews) {
        let (name, body) = match news {
            RoleNews::Said(role, line) => {
                anstream::eprintln!("{role}: {line}");
                return;
            }
            RoleNews::Ready {
                role,
                pid,
                restarts,
                after,
            } => {
                let missing_s = after.map(|after| after.as_secs_f64());
                let body = json!({ "process": pid, "restarts": restarts, "missing_s": missing_s });
                ("role_ready", of_role(role, body))
            }
            RoleNews::Ended {
                role,
                pid,
                how,
                next_in,
            } => {
                let next_s = next_in.as_secs_f64();
                let body = json!({ "process": pid, "how": how, "next_start_s": next_s });
                ("role_ended", of_role(role, body))
            }
            RoleNews::Silent { role, pid } => {
                ("role_silent", of_role(role, json!({ "process": pid })))
            }
            RoleNews::Answers { role, pid } => {
                ("role_answers", of_role(role, json!({ "process": pid })))
            }
            RoleNews::Killed { role, pid, after } => {
                let body = json!({ "process": pid, "silent_s": after.as_secs_f64() });
                ("role_killed", of_role(role, body))
            }
            RoleNews::GivenUp { role, how } => {
                ("role_given_up", of_role(role, json!({ "how": how })))
            }
        };
        line(at, name, body);
    }
}

fn of_role(role: &RoleKind, mut body: Value) -> Value {
    body["role"] = json!(role.name());
    body
}

/// A line of this command's own, of the same shape as an event.
fn line(at: Time, event: &str, mut body: Value) {
    let goal = body["goal"].take();
    body["goal"] = goal;
    body["stack_depth"] = json!(0);
    body["v"] = json!(wire::VERSION);
    body["t_s"] = json!(at.secs());
    body["agent"] = json!("intermezzo");
    body["event"] = json!(event);
    anstream::println!("{body}");
}
