//! How far it is from a state and a list of tasks to the end, as a guess or as a bound.

pub(crate) mod additive;
pub(crate) mod closure;
pub(crate) mod conflict;
pub(crate) mod least;
mod queue;
pub(crate) mod relaxed;
