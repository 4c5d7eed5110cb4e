//! Whole stacks of agents in virtual time: one clock, one wire, and the robots of `executor_sim`.
#![expect(clippy::panic, reason = "a harness fails its test in the plainest way")]

mod bench;
mod museum;
mod planning;
mod rig;
mod stack;
mod wire;

pub use bench::{Bench, of_superior};
pub use museum::{Museum, agent, agent_planning, museum};
pub use planning::{Planning, TestPlanner};
pub use rig::{Ground, Rig, door_change};
pub use stack::{Heard, Stack};
pub use wire::Wire;
