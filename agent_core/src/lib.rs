//! The rules of interruption planning, without any input or output.
//!
//! The method is that of Hayashi, Tokura, Ozaki and Hasegawa, *Handling Emergency Goals in HTN
//! Planning* ("the paper" from here on): forward-chaining HTN agents that keep alternative plans
//! and a stack of suspended goals. Nothing in this crate reads a clock, a file or a socket, starts
//! a thread or draws a random number; what it needs is passed in. That lets one state machine be
//! tested, simulated, checked exhaustively and run.

pub mod agent;
pub mod language;
pub mod model;
pub mod parallel;
pub mod planner;
pub mod protocol;
pub mod service;
pub mod vehicle;
