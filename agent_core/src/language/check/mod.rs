//! What must hold between a domain and its execution model, so that interrupting is safe.

mod beyond;
mod cases;
mod error;
mod names;
mod resuming;
mod state;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;

pub use error::{DomainError, Truth};

use crate::model::{Domain, ExecutionModel};

/// Everything that is wrong with an execution model.
///
/// Above all it proves of each action that can be suspended that the action which resumes it can
/// be executed then, and ends where the suspended one would have ended. An agent may then replace
/// one by the other in every plan (the paper, Algorithm 1) without looking at the plan again.
pub fn check_model(domain: &Domain, model: &ExecutionModel) -> Vec<DomainError> {
    let mut errors = Vec::new();
    names::check_names(domain, model, &mut errors);
    let misnamed: BTreeSet<String> = errors.iter().map(|error| error.key().to_owned()).collect();
    for (name, action) in &model.actions {
        let (Some(operator), Some(suspension)) = (domain.operators.get(name), &action.suspension)
        else {
            continue;
        };
        // What does not even fit its declaration proves nothing.
        let fits = ["effect", "resume"]
            .iter()
            .all(|part| !misnamed.contains(&format!("action.{name}.suspension.{part}")));
        if fits {
            resuming::check_resuming(domain, model, operator, suspension, &mut errors);
        }
    }
    errors
}
