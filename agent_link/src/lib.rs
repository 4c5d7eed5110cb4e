//! Everything that waits: the zenoh session and keys, the wire types and the one driver loop.
#![cfg_attr(test, allow(clippy::unwrap_used))]

mod keys;
pub mod wire;

pub use keys::{AgentKeys, Keys, NameError};
