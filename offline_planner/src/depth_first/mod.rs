//! Depth-first search: the methods and bindings in order, the first that works.
//!
//! Nothing is grounded. The state is changed in place and taken back on the way up; what has been
//! tried in a state with a list of tasks is not tried again.

mod facts;
mod hash;
mod needs;
mod nesting;
mod order;
mod program;
mod query;
mod restarts;
mod search;
mod settled;
mod table;
#[cfg(test)]
mod tests;

pub use restarts::Restarts;
pub use search::DepthFirst;
