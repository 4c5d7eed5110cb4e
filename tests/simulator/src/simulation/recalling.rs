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
        let lost = self.law.owed(line).find(|goal| !speak_of(rows, goal));
        if let Some(goal) = lost.cloned() {
            self.broken(|| format!("S1: the parent has forgotten {goal}"));
        }
    }

    /// S10: who recalls what was just written, with what is in the journal, is as the one that has
    /// written it.
    pub(super) fn recalls(&mut self, who: Who, writing: &[Row]) {
        let node = &self.nodes[who.index()];
        let mut rows = node.store.rows().clone();
        apply(&mut rows, writing);
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

/// Whether there is anything of a goal in a journal, be it live or ended.
pub(super) fn speak_of(rows: &Rows, goal: &Symbol) -> bool {
    let name = goal.as_str();
    rows.iter().any(|(key, value)| {
        let is_name = |part: &[u8]| part == name.as_bytes();
        key.contains(name) || value.windows(name.len()).any(is_name)
    })
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
