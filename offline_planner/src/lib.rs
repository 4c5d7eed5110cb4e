//! A planner for whole problems: from a domain and a problem in HDDL to a plan.
//!
//! [`solve`] is the entrance. Behind it: [`compile`] puts numbers for names, searches work on that,
//! and hand over [`Choices`](plan::Choices), of which a [`Solution`] is made.

pub mod compile;
mod control;
mod depth_first;
mod ground;
mod heuristic;
mod improve;
pub mod informed;
pub mod plan;
mod portfolio;
mod solve;

pub use control::{Control, Halt, Outcome};
pub use plan::Solution;
pub use solve::{Options, Progress, Verdict, solve};
