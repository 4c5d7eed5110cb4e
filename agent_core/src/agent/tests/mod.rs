//! Agents in a small world, without anything else.

pub(in crate::agent) mod history;
pub(in crate::agent) mod toy;
