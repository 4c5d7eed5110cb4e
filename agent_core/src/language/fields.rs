//! The keywords of a method or an action, each with what follows it.

use std::collections::BTreeMap;

use super::error::Faults;
use super::expression::Scope;
use super::near::hint;
use super::tree::Tree;
use super::typed_list::parameters;
use crate::model::{Condition, Domain, Parameter};

/// Keyword, where it stands, and its value.
pub(super) type Fields<'t> = BTreeMap<&'t str, (usize, &'t Tree)>;

/// Reads `:parameters (…) :precondition (…)` and the like; every keyword must be one of `allowed`.
pub(super) fn fields<'t>(
    items: &'t [Tree],
    allowed: &[&str],
    owner: &str,
    faults: &mut Faults,
) -> Fields<'t> {
    let mut out = Fields::new();
    let mut items = items.iter().peekable();
    let keyword = |tree: &'t Tree| tree.word().filter(|word| word.starts_with(':'));
    while let Some(tree) = items.next() {
        let Some(word) = keyword(tree) else {
            faults.add(
                tree.at,
                format!(
                    "expected a keyword such as `{}`, found `{tree}`",
                    allowed[0]
                ),
            );
            continue;
        };
        if !allowed.contains(&word) {
            let hint = hint(word, allowed.iter().copied(), "");
            faults.add(
                tree.at,
                format!("`{word}` is not a keyword of {owner}{hint}"),
            );
        }
        let Some(value) = items.next_if(|next| keyword(next).is_none()) else {
            faults.add(
                tree.at,
                format!("`{word}` has no value; write `()` for none"),
            );
            continue;
        };
        if out.insert(word, (tree.at, value)).is_some() {
            faults.add(tree.at, format!("`{word}` is given twice"));
        }
    }
    out
}

/// The value of `:parameters`; none if the keyword is left out.
pub(super) fn read_parameters(
    fields: &Fields<'_>,
    domain: &Domain,
    faults: &mut Faults,
) -> Vec<Parameter> {
    let Some((_, tree)) = fields.get(":parameters") else {
        return Vec::new();
    };
    let Some(items) = tree.list() else {
        faults.add(tree.at, "expected parameters such as `(?x - node)`");
        return Vec::new();
    };
    parameters(items, Some(domain), faults)
}

/// The value of `:precondition`; always true if the keyword is left out.
pub(super) fn read_precondition(
    fields: &Fields<'_>,
    scope: &Scope<'_>,
    faults: &mut Faults,
) -> Condition {
    fields
        .get(":precondition")
        .map(|(_, tree)| scope.condition(tree, faults))
        .unwrap_or_default()
}
