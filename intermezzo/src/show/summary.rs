//! What became of every goal.

use agent_core::model::{Task, Time};
use agent_core::protocol::{Event, GoalId, Happening};
use comfy_table::Table;

use super::words::resumption;

/// The life of each goal, in the order in which they came.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    goals: Vec<Life>,
}

#[derive(Debug)]
struct Life {
    goal: GoalId,
    tasks: Vec<Task>,
    accepted: String,
    started: String,
    suspended: Vec<String>,
    resumed: Vec<String>,
    ended: String,
}

impl Ledger {
    /// Takes note of an event of the agent that takes the goals.
    pub(super) fn note(&mut self, zero: Time, event: &Event) {
        let Some(goal) = &event.goal else { return };
        let at = format!("{:.1}", event.at.since(zero).secs());
        if let Happening::GoalAccepted { tasks, .. } = &event.what {
            self.goals.push(Life {
                goal: goal.clone(),
                tasks: tasks.clone(),
                accepted: at,
                started: String::new(),
                suspended: Vec::new(),
                resumed: Vec::new(),
                ended: String::new(),
            });
            return;
        }
        let Some(life) = self.goals.iter_mut().find(|life| life.goal == *goal) else {
            return;
        };
        match &event.what {
            Happening::GoalStarted => life.started = at,
            Happening::GoalSuspended { .. } => life.suspended.push(at),
            Happening::GoalBlocked { .. } => life.suspended.push(format!("{at} blocked")),
            Happening::GoalResumed { how, .. } => {
                life.resumed.push(format!("{at} {}", resumption(*how)));
            }
            Happening::GoalSucceeded => life.ended = format!("{at} done"),
            Happening::GoalFailed { .. } => life.ended = format!("{at} failed"),
            Happening::GoalUnknown { .. } => life.ended = format!("{at} not known"),
            _ => {}
        }
    }

    /// `None` if there were no goals.
    pub(super) fn table(&self) -> Option<String> {
        if self.goals.is_empty() {
            return None;
        }
        let mut table = Table::new();
        table.load_style(comfy_table::presets::UTF8_FULL_CONDENSED);
        table.set_header([
            "goal",
            "task",
            "accepted (s)",
            "begun",
            "set aside",
            "taken up again",
            "ended",
        ]);
        for life in &self.goals {
            let tasks: Vec<String> = life.tasks.iter().map(ToString::to_string).collect();
            let ended = if life.ended.is_empty() {
                "not yet"
            } else {
                &life.ended
            };
            table.add_row([
                life.goal.as_str(),
                &tasks.join("\n"),
                &life.accepted,
                &life.started,
                &life.suspended.join("\n"),
                &life.resumed.join("\n"),
                ended,
            ]);
        }
        Some(table.to_string())
    }
}
