//! What travels: types of their own, with conversions from and to the core's.
//!
//! The core may rename a field without a message changing, and a message may grow a field without
//! the core knowing. People type and read these messages, so facts, tasks and actions travel as
//! HDDL text and times as seconds. Every message says its version, `"v":1`; only people may leave
//! it out.

mod envelope;
mod event;
mod facts;
mod goal;
mod instruction;
mod service;
#[cfg(test)]
mod tests;
mod text;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

pub use envelope::{Acknowledgement, Message, Refusal};
pub use event::{
    EventNumber, event_from_line, event_to_line, numbered_event_from_line, numbered_event_to_line,
};
pub use facts::{FactsVerdict, Observed, facts_from_user};
pub use goal::{
    CommandVerdict, Verdict, command_from_user, command_to_wire, goal_from_user, goal_to_wire,
};
pub use instruction::{Answer, Instruction, Map, Report, ReportBody};
pub use service::{service_from_wire, service_to_wire};
pub use text::Text;

/// The version that this program writes, and the only one that it reads.
pub const VERSION: u32 = 1;

/// What people send is short. Anything longer is refused before it is looked at.
pub const USER_LIMIT_BYTES: usize = 64 * 1024;

/// Agents send each other maps, which are longer.
pub const AGENT_LIMIT_BYTES: usize = 4 * 1024 * 1024;

/// Why a message was not understood, in words for whoever sent it.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum WireError {
    /// Not even looked at.
    #[error("the message has {bytes} bytes, but at most {limit_bytes} are read")]
    TooLarge {
        /// Its size.
        bytes: usize,
        /// What is allowed.
        limit_bytes: usize,
    },
    /// Of another release.
    #[error(
        "the message is of version {found}, but this program speaks version {VERSION}: run the same release on both sides"
    )]
    Version {
        /// What it says of itself.
        found: Value,
    },
    /// Not what it should be.
    #[error("cannot read the {what}: {why}")]
    Malformed {
        /// What was expected.
        what: &'static str,
        /// What is wrong with it.
        why: String,
    },
}

impl WireError {
    pub(crate) fn malformed(what: &'static str, why: impl std::fmt::Display) -> Self {
        Self::Malformed {
            what,
            why: why.to_string(),
        }
    }
}

/// Bytes as text, if they are not too many.
fn text<'a>(what: &'static str, bytes: &'a [u8], limit_bytes: usize) -> Result<&'a str, WireError> {
    if bytes.len() > limit_bytes {
        return Err(WireError::TooLarge {
            bytes: bytes.len(),
            limit_bytes,
        });
    }
    std::str::from_utf8(bytes)
        .map(str::trim)
        .map_err(|_| WireError::malformed(what, "it is not UTF-8 text"))
}

/// A message between agents: JSON that says its version.
pub fn read<T: DeserializeOwned>(what: &'static str, bytes: &[u8]) -> Result<T, WireError> {
    let text = text(what, bytes, AGENT_LIMIT_BYTES)?;
    let value: Value =
        serde_json::from_str(text).map_err(|error| WireError::malformed(what, error))?;
    match value.get("v") {
        None => Err(WireError::malformed(
            what,
            "it does not say its version (`\"v\":1`)",
        )),
        Some(_) => from_value(what, value),
    }
}

/// A message whose version, if it says one, is ours.
fn from_value<T: DeserializeOwned>(what: &'static str, value: Value) -> Result<T, WireError> {
    if let Some(found) = value.get("v")
        && *found != VERSION
    {
        // Somebody else's value may be long.
        let found = match found {
            Value::Number(_) => found.clone(),
            _ => Value::from("unknown"),
        };
        return Err(WireError::Version { found });
    }
    body(what, value)
}

/// A part of a message, whose whole said the version.
pub fn body<T: DeserializeOwned>(what: &'static str, value: Value) -> Result<T, WireError> {
    serde_json::from_value(value).map_err(|error| WireError::malformed(what, error))
}

/// What goes into a message without a type of its own.
pub fn to_value(body: &impl Serialize) -> Result<Value, WireError> {
    serde_json::to_value(body).map_err(|error| WireError::malformed("own message", error))
}

/// One line of JSON.
pub fn write(message: &impl Serialize) -> Result<String, WireError> {
    serde_json::to_string(message).map_err(|error| WireError::malformed("own message", error))
}
