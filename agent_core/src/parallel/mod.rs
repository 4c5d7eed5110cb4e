//! Plan parallelizing: several goals at once, each with a plan of its own, and which of their next actions
//! are done together.
//!
//! The method is that of the multitasking paper (plan parallelizing as a clique of greatest saving),
//! with its formulas restored: [`footprint`] says what an action needs and does, [`relation`] which
//! actions go together, [`clique`] which of those that do save most, and [`layer`] chooses one layer
//! after another. [`ParallelAgent`] is composed of ordinary agents by them.

mod agent;
pub mod clique;
pub mod footprint;
pub mod layer;
pub mod relation;
mod schedule;
#[cfg(test)]
mod tests;
mod world;

pub use agent::ParallelAgent;
pub use clique::{Clique, World};
pub use footprint::{Candidate, Footprint, Literals};
pub use layer::{Layer, Underway};
pub use relation::Relation;
pub use world::Present;
