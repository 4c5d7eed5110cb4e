//! Whole stacks in virtual time with everything going wrong.
//!
//! Parent, child and controller are the machines of the product, each in a station with a journal;
//! the world is that of `executor_sim`. A scenario is made from a seed, is a value, and can be
//! replayed and cut down. Somebody who sees everything ([`law`]) says what was wrong.

pub mod counts;
pub mod dice;
pub mod disk;
pub mod fleet;
pub mod ground;
pub mod law;
pub mod mutant;
pub mod process;
pub mod scenario;
pub mod shrink;
pub mod simulation;
pub mod store;
pub mod wire;
