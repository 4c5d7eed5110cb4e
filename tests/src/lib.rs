//! Whole stacks of agents in virtual time: one clock, one wire, and the robots of `executor_sim`.

mod bench;
mod museum;
mod stack;
mod wire;

pub use bench::{Bench, of_superior};
pub use museum::{Museum, agent, museum};
pub use stack::{Heard, Stack};
pub use wire::Wire;
