//! Facts that nobody was told to bring about.

use agent_core::model::{FactChange, Symbol};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::text::{FromText, changes_to_text, from_text};
use super::{Text, USER_LIMIT_BYTES, VERSION, WireError, from_value, text};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FactsMessage {
    #[serde(default, rename = "v")]
    _v: u32,
    facts: Vec<Text<FactChange>>,
}

/// Facts as people type them: `(not (open door3_5))`, or `{"facts":["(open door3_5)"]}`.
pub fn facts_from_user(bytes: &[u8]) -> Result<Vec<FactChange>, WireError> {
    const WHAT: &str = "facts";
    let text = text(WHAT, bytes, USER_LIMIT_BYTES)?;
    if !text.starts_with('{') {
        let change =
            FactChange::from_text(text).map_err(|error| WireError::malformed(WHAT, error))?;
        return Ok(vec![change]);
    }
    let value: Value =
        serde_json::from_str(text).map_err(|error| WireError::malformed(WHAT, error))?;
    let message: FactsMessage = from_value(WHAT, value)?;
    Ok(from_text(message.facts))
}

/// What became of facts that were sent.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct FactsVerdict {
    v: u32,
    /// Whether they were passed on.
    pub accepted: bool,
    /// Why not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl FactsVerdict {
    /// Accepted, or not, for this reason.
    pub fn new<E: std::fmt::Display>(result: &Result<(), E>) -> Self {
        Self {
            v: VERSION,
            accepted: result.is_ok(),
            reason: result.as_ref().err().map(ToString::to_string),
        }
    }
}

/// Facts that an agent tells its superiors, numbered so that a receiver sees what it has missed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Observed {
    v: u32,
    /// New, and greater, at every start of the agent.
    pub epoch: u64,
    /// Counts from 1 within the epoch. In an answer to a query: the last one that is included.
    pub seq: u64,
    /// At the receivers' level.
    facts: Vec<Text<FactChange>>,
    /// Who has them in a report already.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reported_to: Option<String>,
}

impl Observed {
    /// Facts with their number.
    pub fn new(epoch: u64, seq: u64, facts: &[FactChange], reported_to: Option<&Symbol>) -> Self {
        Self {
            v: VERSION,
            epoch,
            seq,
            facts: changes_to_text(facts),
            reported_to: reported_to.map(ToString::to_string),
        }
    }

    /// As the core has them.
    pub fn into_facts(self) -> Vec<FactChange> {
        from_text(self.facts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use agent_core::model::Atom;

    #[test]
    fn facts_are_one_or_a_list() {
        let open = Atom::new("open", ["door3_5"]);
        assert_eq!(
            facts_from_user(b"(not (open door3_5))").unwrap(),
            [FactChange::Remove(open.clone())]
        );
        assert_eq!(
            facts_from_user(br#"{"facts":["(open door3_5)","(= (gap arc5 n6) 3.2)"]}"#).unwrap(),
            [
                FactChange::Add(open),
                FactChange::Set(Atom::new("gap", ["arc5", "n6"]), 3.2)
            ]
        );
        assert!(facts_from_user(br#"{"facts":["open"]}"#).is_err());
        assert!(facts_from_user(br#"{"facts":[],"v":3}"#).is_err());
        assert!(facts_from_user(b"").is_err());
    }
}
