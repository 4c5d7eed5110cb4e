//! Informed search: the problem is grounded, and what is relaxed shows the way.

mod greedy;
mod progress;
mod store;

use crate::compile::Compiled;
use crate::control::{Control, Halt, Outcome};
use crate::ground::{Limits, Stopped, ground, origin};
use greedy::{Found, greedy};

/// Searches for a plan.
pub fn search(compiled: &Compiled, control: &Control<'_>) -> Outcome {
    let limits = Limits {
        memory_bytes: usize::try_from(control.memory_limit_bytes).unwrap_or(usize::MAX),
        stop: &|| control.is_over(),
    };
    let model = match ground(compiled, &limits) {
        Ok(Some(model)) => model,
        Ok(None) => return Outcome::Unsolvable,
        Err(Stopped::TooLarge) => return Outcome::Stopped(Halt::Memory),
        Err(Stopped::Cancelled) => return Outcome::Stopped(Halt::Told),
    };
    tracing::debug!(
        facts = model.facts,
        actions = model.actions.len(),
        methods = model.methods.len(),
        tasks = model.tasks.len(),
        bytes = model.bytes(),
        "grounded"
    );
    match greedy(&model, control) {
        Found::Plan(methods) => match origin::choices(compiled, &model, &methods) {
            Some(choices) => Outcome::Found(choices),
            None => Outcome::Stopped(Halt::Incomplete),
        },
        Found::Nothing => Outcome::Unsolvable,
        Found::Stopped(halt) => Outcome::Stopped(halt),
    }
}
