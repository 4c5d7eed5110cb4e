//! Whether journals have in them what they should.

use agent_core::model::Symbol;
use agent_core::protocol::{Row, Rows};

use crate::process::Role;
use crate::scenario::Who;
use crate::store::apply;

use super::Simulation;

impl Simulation<'_> {
    /// S1: of every goal that the parent has acknowledged there is something in its journal.
    pub(super) fn owes_nothing(&mut self) {
        let node = &self.nodes[Who::Parent.index()];
        let line = node.role.as_ref().map_or(0, Role::line);
        let rows = node.store.rows();
        let mut lost = None;
        for goal in self.law.owed(line) {
            if self.witnesses.contains_key(goal) {
                continue;
            }
            match who_speaks_of(rows, goal) {
                Some(key) => {
                    self.witnesses.insert(goal.clone(), key.clone());
                }
                None => lost = Some(goal.clone()),
            }
        }
        if let Some(goal) = lost {
            self.broken(|| format!("S1: the parent has forgotten {goal}"));
        }
    }

    /// These rows of the parent's are about to be written. A row that has spoken of a goal and is
    /// not among them still does.
    pub(super) fn speaks_anew(&mut self, rows: &[Row]) {
        self.witnesses
            .retain(|_, key| rows.iter().all(|row| row.key != *key));
    }

    /// S10: who recalls what was just written, with what is in the journal, is as the one that has
    /// written it.
    pub(super) fn recalls(&mut self, who: Who, writing: &[Row]) {
        let node = &self.nodes[who.index()];
        let mut rows = node.store.rows().clone();
        apply(&mut rows, writing.iter().cloned());
        let recalled = self.role(who, node.epoch, &rows);
        let wrong = match (recalled, &node.role) {
            (Ok(mut recalled), Some(role)) => {
                let again = recalled.write_down().unwrap_or_default();
                let other = again.iter().find(|row| !differs_after_a_start(&row.key));
                other
                    .map(|row| format!("recalls another {}", row.key))
                    .or_else(|| unlike(role, &recalled))
            }
            (Err(error), _) => Some(error.to_string()),
            (Ok(_), None) => None,
        };
        if let Some(wrong) = wrong {
            self.broken(|| format!("S10: {who}: {wrong}"));
        }
    }
}

/// A row of a journal in which there is anything of a goal, be it live or ended.
pub(super) fn who_speaks_of<'a>(rows: &'a Rows, goal: &Symbol) -> Option<&'a String> {
    let name = goal.as_str();
    // Rows of goals first.
    let goals = rows.range("m/".to_owned()..).chain(rows.iter());
    let mut speaking = goals.filter(|(key, value)| {
        let is_name = |part: &[u8]| part == name.as_bytes();
        key.contains(name) || value.windows(name.len()).any(is_name)
    });
    speaking.next().map(|(key, _)| key)
}

/// What a start changes in a journal: the epoch is another, a robot halts, with a number, and what
/// was observed has been told again.
pub(super) fn differs_after_a_start(key: &str) -> bool {
    ["s/epoch", "m/ticket", "m/running"].contains(&key) || key.starts_with("s/observed/")
}

/// In what a recalled agent is not as the living one.
pub(super) fn unlike(living: &Role, recalled: &Role) -> Option<String> {
    let (living, recalled) = (living.as_agent()?, recalled.as_agent()?);
    let (was, is) = (living.counts(), recalled.counts());
    if was != is {
        return Some(format!("has {is:?}, and had {was:?}"));
    }
    let (was, is) = (living.executing(), recalled.executing());
    if was != is {
        return Some(format!("is having {is:?} done, and was {was:?}"));
    }
    (living.belief() != recalled.belief()).then(|| "believes something else".to_owned())
}
