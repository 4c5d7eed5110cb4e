//! `(:method …)`.

use super::error::Faults;
use super::expression::Scope;
use super::fields::{Fields, read_parameters, read_precondition};
use super::fit::Sort;
use super::subtasks::subtasks;
use crate::model::{Domain, Method, Symbol};

/// What may stand in a method.
pub(super) const KEYWORDS: &[&str] = &[
    ":parameters",
    ":task",
    ":precondition",
    ":ordered-subtasks",
    ":ordered-tasks",
    ":subtasks",
    ":tasks",
    ":ordering",
    ":order",
    ":constraints",
];

/// Reads a method. `at` is where its name stands.
pub(super) fn method(
    name: Symbol,
    at: usize,
    fields: &Fields<'_>,
    domain: &Domain,
    faults: &mut Faults,
) -> Option<Method> {
    let parameters = read_parameters(fields, domain, faults);
    let scope = Scope {
        parameters: &parameters,
        domain: Some(domain),
    };
    let task = match fields.get(":task") {
        Some((_, tree)) => scope.pattern(tree, Sort::Task, faults),
        None => {
            faults.add(
                at,
                format!("the method `{name}` does not say which task it does: add `:task (…)`"),
            );
            None
        }
    };
    let mut precondition = read_precondition(fields, &scope, faults);
    // Constraints restrict the variables, just as a precondition does.
    if let Some((_, tree)) = fields.get(":constraints") {
        precondition.extend(scope.condition(tree, faults));
    }
    let subtasks = subtasks(fields, &scope, faults);
    Some(Method {
        task: task?,
        precondition,
        subtasks,
        name,
        parameters,
    })
}
