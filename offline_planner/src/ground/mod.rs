//! The problem without variables, as far as it can be reached.

mod build;
mod chain;
mod formula;
mod implied;
mod join;
mod lifted;
pub(crate) mod model;
pub(crate) mod origin;
mod reach;
mod space;
mod tables;
mod trim;

pub(crate) use model::Model;

use crate::compile::Compiled;

/// How far grounding may go.
pub(crate) struct Limits<'a> {
    /// What grounding may use, roughly.
    pub memory_bytes: usize,
    /// Whether to stop now.
    pub stop: &'a dyn Fn() -> bool,
}

/// Why grounding ended without a model.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Stopped {
    /// It would need more memory than it may use.
    TooLarge,
    /// It was told to.
    Cancelled,
}

/// Grounds the problem. `None` if that proves that there is no plan.
pub(crate) fn ground(compiled: &Compiled, limits: &Limits<'_>) -> Result<Option<Model>, Stopped> {
    let mut lifted = lifted::lift(compiled);
    implied::add_implied(&mut lifted);
    let reached = reach::reach(&lifted, limits)?;
    Ok(build::build(&lifted, reached).and_then(trim::trim))
}
