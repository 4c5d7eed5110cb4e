//! `(:action …)`.

use super::effect::CostedEffect;
use super::error::Faults;
use super::expression::Scope;
use super::fields::{Fields, read_precondition};
use crate::model::{Domain, Number, Operator, Parameter, Symbol};

/// What may stand in an action.
pub(super) const KEYWORDS: &[&str] = &[":parameters", ":precondition", ":effect"];

/// Reads an action whose name and parameters are already known.
pub(super) fn action(
    name: &Symbol,
    parameters: &[Parameter],
    fields: &Fields<'_>,
    domain: &Domain,
    faults: &mut Faults,
) -> Operator {
    let scope = Scope {
        parameters,
        domain: Some(domain),
    };
    let mut effect = CostedEffect::default();
    if let Some((_, tree)) = fields.get(":effect") {
        effect.read(tree, &scope, faults);
    }
    Operator {
        name: name.clone(),
        parameters: parameters.to_vec(),
        precondition: read_precondition(fields, &scope, faults),
        effect: effect.effect,
        cost: effect.cost.unwrap_or(Number::Constant(0.0)),
    }
}
