//! What goes down, what is answered, and what comes up.

use std::collections::BTreeMap;

use agent_core::model::{self, Action, Atom, FactChange, Symbol, Time};
use agent_core::protocol::{self, ActionId};
use serde::{Deserialize, Serialize};

use super::Text;
use super::text::{changes_to_text, from_text, to_text};

/// A map as it travels.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Map {
    /// Object and its type.
    objects: BTreeMap<String, String>,
    /// Facts and values about them.
    facts: Vec<Text<FactChange>>,
    /// What was known of things that change.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    news: Vec<Text<FactChange>>,
}

impl From<&model::Map> for Map {
    fn from(map: &model::Map) -> Self {
        let facts: Vec<FactChange> = map
            .facts
            .facts()
            .cloned()
            .map(FactChange::Add)
            .chain(
                map.facts
                    .values()
                    .map(|(function, value)| FactChange::Set(function.clone(), value)),
            )
            .collect();
        Self {
            objects: map
                .objects
                .iter()
                .map(|(object, kind)| (object.to_string(), kind.to_string()))
                .collect(),
            facts: changes_to_text(&facts),
            news: changes_to_text(&map.news),
        }
    }
}

impl From<Map> for model::Map {
    fn from(map: Map) -> Self {
        let mut facts = model::Belief::default();
        facts.apply_all(&from_text(map.facts));
        Self {
            objects: map
                .objects
                .into_iter()
                .map(|(object, kind)| (Symbol::from(object), Symbol::from(kind)))
                .collect(),
            facts,
            news: from_text(map.news),
        }
    }
}

/// An instruction as it travels: `{"verb":"suspend","id":"parent.3.17"}`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "verb", rename_all = "snake_case")]
#[expect(missing_docs, reason = "the fields are those of the core's type")]
pub enum Instruction {
    /// Begin.
    Execute {
        id: Text<ActionId>,
        action: Text<Action>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        map: Option<Map>,
    },
    /// Stop if you can.
    Suspend { id: Text<ActionId> },
    /// Take up the record.
    Resume {
        id: Text<ActionId>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        map: Option<Map>,
    },
    /// Drop the record.
    Clear { id: Text<ActionId> },
}

impl From<&protocol::Instruction> for Instruction {
    fn from(instruction: &protocol::Instruction) -> Self {
        use protocol::Instruction as Core;
        match instruction {
            Core::Execute { id, action, map } => Self::Execute {
                id: Text(id.clone()),
                action: Text(action.clone()),
                map: map.as_ref().map(Map::from),
            },
            Core::Suspend { id } => Self::Suspend {
                id: Text(id.clone()),
            },
            Core::Resume { id, map } => Self::Resume {
                id: Text(id.clone()),
                map: map.as_ref().map(Map::from),
            },
            Core::Clear { id } => Self::Clear {
                id: Text(id.clone()),
            },
        }
    }
}

impl From<Instruction> for protocol::Instruction {
    fn from(instruction: Instruction) -> Self {
        match instruction {
            Instruction::Execute { id, action, map } => Self::Execute {
                id: id.0,
                action: action.0,
                map: map.map(Into::into),
            },
            Instruction::Suspend { id } => Self::Suspend { id: id.0 },
            Instruction::Resume { id, map } => Self::Resume {
                id: id.0,
                map: map.map(Into::into),
            },
            Instruction::Clear { id } => Self::Clear { id: id.0 },
        }
    }
}

/// An answer as it travels: `{"answer":"refused","finishes_in_s":2.5}`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "answer", rename_all = "snake_case")]
#[expect(missing_docs, reason = "the fields are those of the core's type")]
pub enum Answer {
    /// Begun, or dropped.
    Accepted,
    /// Stopping.
    Suspending,
    /// It cannot be suspended.
    Refused { finishes_in_s: f64 },
    /// It has ended already.
    Finished { outcome: Report },
    /// Not understood or not possible.
    Rejected { reason: String },
}

impl From<&protocol::Answer> for Answer {
    fn from(answer: &protocol::Answer) -> Self {
        use protocol::Answer as Core;
        match answer {
            Core::Accepted => Self::Accepted,
            Core::Suspending => Self::Suspending,
            Core::Refused { finishes_in } => Self::Refused {
                finishes_in_s: finishes_in.secs(),
            },
            Core::Finished { outcome } => Self::Finished {
                outcome: outcome.into(),
            },
            Core::Rejected { reason } => Self::Rejected {
                reason: reason.clone(),
            },
        }
    }
}

impl From<Answer> for protocol::Answer {
    fn from(answer: Answer) -> Self {
        match answer {
            Answer::Accepted => Self::Accepted,
            Answer::Suspending => Self::Suspending,
            Answer::Refused { finishes_in_s } => Self::Refused {
                finishes_in: Time::from_secs(finishes_in_s),
            },
            Answer::Finished { outcome } => Self::Finished {
                outcome: outcome.into(),
            },
            Answer::Rejected { reason } => Self::Rejected { reason },
        }
    }
}

/// A report as it travels: `{"report":"success","facts":["(at n5)"]}`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "report", rename_all = "snake_case")]
#[expect(missing_docs, reason = "the fields are those of the core's type")]
pub enum Report {
    /// It has begun.
    Started,
    /// How far it is, from 0 to 1.
    Progress { fraction: f64 },
    /// It has ended as it should.
    Success { facts: Vec<Text<FactChange>> },
    /// It has ended otherwise.
    Failure {
        reason: String,
        facts: Vec<Text<FactChange>>,
        #[serde(default)]
        blocked_by: Vec<Text<Atom>>,
    },
    /// It has ended, and nobody can tell how.
    Unknown {
        reason: String,
        facts: Vec<Text<FactChange>>,
    },
    /// The executor stands still.
    Suspended { facts: Vec<Text<FactChange>> },
}

impl From<&protocol::Report> for Report {
    fn from(report: &protocol::Report) -> Self {
        use protocol::Report as Core;
        match report {
            Core::Started => Self::Started,
            Core::Progress { fraction } => Self::Progress {
                // JSON has no word for what is not a number.
                fraction: if fraction.is_finite() { *fraction } else { 0.0 },
            },
            Core::Success { facts } => Self::Success {
                facts: changes_to_text(facts),
            },
            Core::Failure {
                reason,
                facts,
                blocked_by,
            } => Self::Failure {
                reason: reason.clone(),
                facts: changes_to_text(facts),
                blocked_by: to_text(blocked_by),
            },
            Core::Unknown { reason, facts } => Self::Unknown {
                reason: reason.clone(),
                facts: changes_to_text(facts),
            },
            Core::Suspended { facts } => Self::Suspended {
                facts: changes_to_text(facts),
            },
        }
    }
}

impl From<Report> for protocol::Report {
    fn from(report: Report) -> Self {
        match report {
            Report::Started => Self::Started,
            Report::Progress { fraction } => Self::Progress { fraction },
            Report::Success { facts } => Self::Success {
                facts: from_text(facts),
            },
            Report::Failure {
                reason,
                facts,
                blocked_by,
            } => Self::Failure {
                reason,
                facts: from_text(facts),
                blocked_by: from_text(blocked_by),
            },
            Report::Unknown { reason, facts } => Self::Unknown {
                reason,
                facts: from_text(facts),
            },
            Report::Suspended { facts } => Self::Suspended {
                facts: from_text(facts),
            },
        }
    }
}

/// A report with the execution that it is about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReportBody {
    /// Which execution.
    pub id: Text<ActionId>,
    /// How it goes.
    #[serde(flatten)]
    pub report: Report,
}
