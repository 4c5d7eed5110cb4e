//! The protocol between an agent and an executor, in every order of events.
//!
//! The stations are those that run in the processes. The superior is a real agent with a small domain;
//! the executor is a small machine with the rules of the robot's controller. Each has a disk, and
//! what is written is on it later; letters arrive in any order; within a budget they are lost or arrive
//! twice, and processes die at any moment. See the README for what is checked and what was found.

pub mod arm;
pub mod boss;
pub mod fence;
pub mod happen;
pub mod letter;
pub mod lives;
pub mod model;
pub mod mutant;
pub mod names;
pub mod node;
mod report;
pub mod role;
pub mod seen;
pub mod state;
pub mod tables;
mod tell;
pub mod world;

pub use model::{Budget, Protocol};
pub use mutant::Mutant;
pub use report::{Found, check};
