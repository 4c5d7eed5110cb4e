//! What the robot's controller shows of itself.

use agent_core::model::Symbol;
use agent_link::Inspect;
use serde_json::{Value, json};

use super::Controller;
use crate::Place;
use crate::memory::Record;

impl Inspect for Controller {
    fn status(&self) -> Value {
        let action = self.active.as_ref().map(|active| {
            let mut shown = record(&active.begun.job);
            shown["stopping"] = json!(active.is_stopping());
            shown
        });
        json!({
            "phase": match &self.active {
                None => "idle",
                Some(active) if active.is_stopping() => "stopping",
                Some(_) => "executing",
            },
            "action": action,
            "stack_depth": self.memory.depth(),
            // Where it stood last: while it drives, only the world knows.
            "stood": self.surroundings.place().map(Place::to_string),
            "faults": self.faults.to_string(),
            "waiting": self.waiting.as_ref().map(|waiting| record(&waiting.job)),
            "halting": self.halt.is_some(),
            "gone": self.gone.iter().map(Symbol::as_str).collect::<Vec<_>>(),
        })
    }

    fn belief(&self) -> Value {
        let doors = self.surroundings.doors();
        json!({
            "stood": self.surroundings.place(),
            "doors": doors.iter().map(|(door, open)| (door.to_string(), *open))
                .collect::<std::collections::BTreeMap<_, _>>(),
        })
    }

    fn stack(&self) -> Value {
        self.memory.records().map(record).collect()
    }
}

fn record(record: &Record) -> Value {
    json!({
        "id": record.id.to_string(),
        "superior": record.superior.as_str(),
        "action": record.action.to_string(),
        "rest": record.rest.to_string(),
    })
}
