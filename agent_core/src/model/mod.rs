//! The nouns, one a file.

#[cfg(test)]
pub(crate) mod arbitrary;
mod atom;
mod belief;
mod domain;
mod execution_model;
mod expression;
mod instance;
mod landmarks;
mod map;
mod quantity;
mod symbol;

pub use atom::{Action, Atom, Fact, Task};
pub use belief::{Belief, FactChange};
pub use domain::{Domain, Method, Operator};
pub use execution_model::{
    ActionModel, Arising, CostRule, ExecutionModel, Projection, Suspension, TaskModel,
};
pub use expression::{Change, Clause, Condition, Effect, Number, Parameter, Pattern, Term};
pub use instance::Instance;
pub use landmarks::{Landmarks, Reach};
pub use map::Map;
pub use quantity::{Cost, Time};
pub use symbol::Symbol;
