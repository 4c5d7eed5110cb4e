//! Lists such as `?from ?to - area ?d - door`.

use super::error::Faults;
use super::fit::type_is_declared;
use super::near::hint;
use super::tree::Tree;
use crate::model::{Domain, Parameter, Symbol};

/// One name of a typed list.
pub(super) struct Typed<'t> {
    pub(super) name: &'t Tree,
    /// `None` if none is written.
    pub(super) kind: Option<&'t Tree>,
}

/// Words that mean something else wherever a name could stand.
const RESERVED: &[&str] = &[
    "and", "or", "not", "imply", "forall", "exists", "when", "increase", "object",
];

/// Pairs every name with the type that stands after its group.
pub(super) fn typed_list<'t>(items: &'t [Tree], faults: &mut Faults) -> Vec<Typed<'t>> {
    let mut out: Vec<Typed<'t>> = Vec::new();
    let mut group = 0;
    let mut items = items.iter();
    while let Some(item) = items.next() {
        if item.word() != Some("-") {
            out.push(Typed {
                name: item,
                kind: None,
            });
            continue;
        }
        if group == out.len() {
            faults.add(item.at, "there is no name before this `-`");
        }
        let Some(kind) = items.next() else {
            faults.add(item.at, "a type must follow this `-`");
            break;
        };
        if kind.head() == Some("either") {
            faults.add(
                kind.at,
                "`either` is not supported yet; declare a type above both",
            );
        }
        for typed in &mut out[group..] {
            typed.kind = Some(kind);
        }
        group = out.len();
    }
    out
}

/// The name that a word is, or a fault that says why it is none.
pub(super) fn name(tree: &Tree, what: &str, faults: &mut Faults) -> Option<Symbol> {
    let Some(word) = tree.word() else {
        faults.add(tree.at, format!("expected {what}, found `{tree}`"));
        return None;
    };
    if RESERVED.contains(&word) {
        faults.add(
            tree.at,
            format!("expected {what}, but `{word}` is a word of the language"),
        );
        return None;
    }
    if !is_name(word) {
        faults.add(
            tree.at,
            format!(
                "expected {what}, found `{word}`: a name begins with a letter and goes on with \
                 letters, digits, `-` and `_`"
            ),
        );
        return None;
    }
    Some(Symbol::from(word))
}

/// The variable that a word is, with its question mark, or a fault.
pub(super) fn variable(tree: &Tree, faults: &mut Faults) -> Option<Symbol> {
    let word = tree.word().unwrap_or_default();
    if word.strip_prefix('?').is_some_and(is_name) {
        return Some(Symbol::from(word));
    }
    faults.add(
        tree.at,
        format!("expected a variable such as `?x`, found `{tree}`"),
    );
    None
}

fn is_name(word: &str) -> bool {
    let mut letters = word.chars();
    letters
        .next()
        .is_some_and(|first| first.is_alphabetic() || first == '_')
        && letters.all(|letter| letter.is_alphanumeric() || matches!(letter, '-' | '_' | '.'))
}

/// The type of a name: `object` if none is written. With a domain, it must be declared there.
pub(super) fn kind_of(
    typed: &Typed<'_>,
    domain: Option<&Domain>,
    faults: &mut Faults,
) -> Option<Symbol> {
    let Some(tree) = typed.kind else {
        return Some(Symbol::from("object"));
    };
    if tree.word() == Some("object") {
        return Some(Symbol::from("object"));
    }
    if tree.head() == Some("either") {
        return None; // already a fault
    }
    let kind = name(tree, "a type", faults)?;
    if let Some(domain) = domain.filter(|domain| !type_is_declared(domain, &kind)) {
        let hint = hint(
            kind.as_str(),
            domain.types.keys().map(Symbol::as_str),
            "; declare it in `(:types …)`",
        );
        faults.add(tree.at, format!("type `{kind}` is not declared{hint}"));
    }
    Some(kind)
}

/// Reads parameters: `?from ?to - area ?d - door`. With a domain, their types must be declared.
pub(super) fn parameters(
    items: &[Tree],
    domain: Option<&Domain>,
    faults: &mut Faults,
) -> Vec<Parameter> {
    let mut out: Vec<Parameter> = Vec::new();
    let mut last_type = None;
    for typed in typed_list(items, faults) {
        let Some(name) = variable(typed.name, faults) else {
            continue;
        };
        if out.iter().any(|parameter| parameter.name == name) {
            faults.add(typed.name.at, format!("`{name}` is declared twice"));
            continue;
        }
        // A group of variables shares its type, and one fault about it is enough.
        let place = typed.kind.map(|kind| kind.at);
        let mut repeated = Faults::default();
        let report = if place.is_some() && place == last_type {
            &mut repeated
        } else {
            &mut *faults
        };
        last_type = place;
        let kind = kind_of(&typed, domain, report).unwrap_or_else(|| Symbol::from("object"));
        out.push(Parameter { name, kind });
    }
    out
}
