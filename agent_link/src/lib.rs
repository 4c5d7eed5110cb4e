//! Everything that waits: the zenoh session and keys, the wire types and the one driver loop.
#![cfg_attr(test, allow(clippy::unwrap_used))]

mod keys;
mod process;
pub mod registry;
pub mod session;
pub mod wire;

pub use keys::{AgentKeys, Keys, NameError};
pub use process::{interrupted, runtime};
pub use session::Session;
