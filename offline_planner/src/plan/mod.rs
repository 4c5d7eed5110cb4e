//! What planning results in.

mod choices;
mod solution;
mod write;

pub use choices::Choices;
pub use solution::{Node, NodeId, Solution};
