//! Experiments with robots that run.

pub(crate) mod fleet;
mod follow;
pub(crate) mod latency;
mod stamps;
