//! For programs: one JSON object a line.

use agent_core::model::{Symbol, Time};
use agent_core::protocol::Event;
use agent_link::wire;
use serde_json::{Value, json};

use super::Screen;
use crate::robot::{Robot, RoleKind};
use crate::scenario::{Told, What};

/// Writes the events as the agents publish them, and between them, as agent `intermezzo`, what
/// this command itself does.
#[derive(Debug, Default)]
pub(crate) struct JsonLines;

impl JsonLines {
    /// The robot takes goals from now on.
    pub(crate) fn ready(&self, robot: &Robot) {
        let processes = robot
            .processes()
            .map(|(role, pid)| (role.to_string(), json!(pid)));
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
            Some(What::Goal(goal)) => {
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

    fn said(&mut self, role: RoleKind, line: &str) {
        anstream::eprintln!("{role}: {line}");
    }
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
