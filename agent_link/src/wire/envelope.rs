//! Once and in order: what is around an instruction or a report, and what comes back.

use agent_core::protocol::Envelope;
use serde::{Deserialize, Serialize};

use super::{Answer, VERSION};

/// An [`Envelope`] as it travels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Message<T> {
    v: u32,
    from: String,
    line: u64,
    epoch: u64,
    seq: u64,
    #[serde(default)]
    settled: u64,
    #[serde(default)]
    to_line: u64,
    /// A copy that runs ahead of its number: an instruction to stop.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    ahead: bool,
    body: T,
}

impl<T> Message<T> {
    /// The same, as a copy that runs ahead of its number.
    #[must_use]
    pub fn ahead(self) -> Self {
        Self {
            ahead: true,
            ..self
        }
    }

    /// Who sends.
    pub fn sender(&self) -> &str {
        &self.from
    }

    /// Whether it runs ahead of its number.
    pub fn is_ahead(&self) -> bool {
        self.ahead
    }
}

impl<T: Clone> From<&Envelope<T>> for Message<T> {
    fn from(envelope: &Envelope<T>) -> Self {
        Self {
            v: VERSION,
            from: envelope.from.to_string(),
            line: envelope.line,
            epoch: envelope.epoch,
            seq: envelope.seq,
            settled: envelope.settled,
            to_line: envelope.to_line,
            ahead: false,
            body: envelope.body.clone(),
        }
    }
}

impl<T> From<Message<T>> for Envelope<T> {
    fn from(message: Message<T>) -> Self {
        Self {
            from: message.from.into(),
            line: message.line,
            epoch: message.epoch,
            seq: message.seq,
            settled: message.settled,
            to_line: message.to_line,
            body: message.body,
        }
    }
}

/// What the receiver of a [`Message`] says. Only one that says neither `refused` nor another `seq`
/// than was asked about means that the message was applied.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Acknowledgement {
    v: u32,
    /// The message it is about; `None` if that could not be read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seq: Option<u64>,
    /// The epoch in which the receiver's memory begins: another than before says that it has lost it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<u64>,
    /// To an instruction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub answer: Option<Answer>,
    /// Why the message was not applied.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<Refusal>,
}

/// Why a message was not applied.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct Refusal {
    /// In words for a person.
    pub reason: String,
    /// The receiver has heard from a later start of the same sender: to repeat is pointless.
    #[serde(default)]
    pub superseded: bool,
}

impl Acknowledgement {
    /// It was applied by a receiver of that line; to an instruction with this answer.
    pub fn applied(line: u64, seq: u64, answer: Option<Answer>) -> Self {
        Self {
            v: VERSION,
            seq: Some(seq),
            line: Some(line),
            answer,
            refused: None,
        }
    }

    /// It was not, and may be sent again.
    pub fn refused(seq: Option<u64>, reason: impl std::fmt::Display) -> Self {
        Self {
            v: VERSION,
            seq,
            line: None,
            answer: None,
            refused: Some(Refusal {
                reason: reason.to_string(),
                superseded: false,
            }),
        }
    }

    /// It was not and never will be.
    pub fn superseded(seq: u64) -> Self {
        Self {
            v: VERSION,
            seq: Some(seq),
            line: None,
            answer: None,
            refused: Some(Refusal {
                reason: "a later start of the same sender has been heard from".to_owned(),
                superseded: true,
            }),
        }
    }
}
