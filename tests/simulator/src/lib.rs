//! Whole stacks in virtual time with everything going wrong.

pub mod dice;
pub mod ground;
pub mod scenario;
