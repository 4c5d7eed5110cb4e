//! Informed search: the problem is grounded, and what is relaxed shows the way.

mod anytime;
mod greedy;
mod progress;
mod store;
#[cfg(test)]
mod tests;

use agent_core::model::Cost;

use crate::compile::Compiled;
use crate::control::{Control, Halt, Outcome};
use crate::ground::{Limits, Model, Stopped, ground, origin};
use crate::plan::Choices;
use greedy::{Found, greedy};

/// Searches for a plan.
pub fn search(compiled: &Compiled, control: &Control<'_>) -> Outcome {
    let model = match grounded(compiled, control) {
        Ok(Some(model)) => model,
        Ok(None) => return Outcome::Unsolvable,
        Err(halt) => return Outcome::Stopped(halt),
    };
    match greedy(&model, control) {
        Found::Plan(methods) => match origin::choices(compiled, &model, &methods) {
            Some(choices) => Outcome::Found(choices),
            None => Outcome::Stopped(Halt::Incomplete),
        },
        Found::Nothing => Outcome::Unsolvable,
        Found::Stopped(halt) => Outcome::Stopped(halt),
    }
}

/// Searches for ever cheaper plans than `bound`, if there is one; each is given to `found`.
///
/// # Errors
/// Why it ended without having searched everything. Otherwise the last plan found, or the one that
/// `bound` is of, is the cheapest; if there is neither, there is no plan.
pub fn search_for_the_cheapest(
    compiled: &Compiled,
    bound: Option<Cost>,
    control: &Control<'_>,
    found: &mut dyn FnMut(Choices),
) -> Result<(), Halt> {
    let Some(model) = grounded(compiled, control)? else {
        return Ok(());
    };
    let bound = bound.map_or(u64::MAX, |cost| cost.0);
    let mut lost = false;
    anytime::anytime(
        &model,
        bound,
        control,
        &mut |methods, _| match origin::choices(compiled, &model, &methods) {
            Some(choices) => found(choices),
            None => lost = true,
        },
    )?;
    if lost { Err(Halt::Incomplete) } else { Ok(()) }
}

/// `None` if that proves that there is no plan.
fn grounded(compiled: &Compiled, control: &Control<'_>) -> Result<Option<Model>, Halt> {
    let limits = Limits {
        memory_bytes: usize::try_from(control.memory_limit_bytes).unwrap_or(usize::MAX),
        stop: &|| control.is_over(),
    };
    let model = ground(compiled, &limits).map_err(|stopped| match stopped {
        Stopped::TooLarge => Halt::Memory,
        Stopped::Cancelled => Halt::Told,
    })?;
    if let Some(model) = &model {
        tracing::debug!(
            facts = model.facts,
            actions = model.actions.len(),
            methods = model.methods.len(),
            tasks = model.tasks.len(),
            bytes = model.bytes(),
            "grounded"
        );
    }
    Ok(model)
}
