//! Lists such as `?from ?to - area ?d - door`.

use std::collections::BTreeSet;

use super::error::Faults;
use super::fit::type_is_declared;
use super::near::hint;
use super::number::decimal;
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
    "and", "or", "not", "imply", "forall", "exists", "when", "increase",
];

/// More variables than anyone declares at once.
const MAX_VARIABLES: usize = 10_000;

/// More types than anyone joins in one `either`.
const MAX_EITHER: usize = 100;

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
                "expected {what}, found `{word}`: a name begins with a letter or a digit and goes on \
                 with letters, digits, `-`, `_` and the like"
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

/// Published problems call objects what they like, `4x4` and `a@b` among it.
fn is_name(word: &str) -> bool {
    let begins = |first: char| first.is_alphanumeric() || first == '_';
    word.starts_with(begins)
        && decimal(word).is_none()
        && word
            .chars()
            .all(|letter| letter.is_alphanumeric() || "-_.@#$%&*+/!~^|,'[]{}<>=:".contains(letter))
}

/// The type of a name: `object` if none is written. With a domain, it must be declared there.
pub(super) fn kind_of(
    typed: &Typed<'_>,
    domain: Option<&Domain>,
    faults: &mut Faults,
) -> Option<Symbol> {
    match typed.kind {
        Some(tree) => kind_named(tree, domain, faults),
        None => Some(Symbol::from("object")),
    }
}

/// The type that is written: a name, or `(either …)` of several.
pub(super) fn kind_named(
    tree: &Tree,
    domain: Option<&Domain>,
    faults: &mut Faults,
) -> Option<Symbol> {
    if tree.word() == Some("object") {
        return Some(Symbol::from("object"));
    }
    if let Some((union, members)) = either(tree) {
        if members.len() > MAX_EITHER {
            faults.add(
                tree.at,
                format!("more than {MAX_EITHER} types in one `either`"),
            );
            return None;
        }
        for member in tree.list().into_iter().flatten().skip(1) {
            kind_named(member, domain, faults);
        }
        if let [only] = members.as_slice() {
            return Some(only.clone());
        }
        if domain.is_some_and(|domain| !domain.unions.contains_key(&union)) {
            let message =
                format!("`{union}` is not used in the domain; declare a type above these");
            faults.add(tree.at, message);
        }
        return Some(union);
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

/// The name and the members of a union of types: `(either room door)`.
pub(super) fn either(tree: &Tree) -> Option<(Symbol, Vec<Symbol>)> {
    let (head, members) = tree.list()?.split_first()?;
    if head.word() != Some("either") || members.is_empty() {
        return None;
    }
    let words: Option<Vec<&str>> = members.iter().map(Tree::word).collect();
    let mut words = words?;
    words.sort_unstable();
    words.dedup();
    let name = format!("(either {})", words.join(" "));
    Some((
        Symbol::from(name),
        words.into_iter().map(Symbol::from).collect(),
    ))
}

/// The types of a list, one after the other: a group of names shares its type, and one look at it
/// is enough, as is one fault.
#[derive(Default)]
pub(super) struct Kinds {
    last: Option<(usize, Option<Symbol>)>,
}

impl Kinds {
    /// As [`kind_of`].
    pub(super) fn next(
        &mut self,
        typed: &Typed<'_>,
        domain: Option<&Domain>,
        faults: &mut Faults,
    ) -> Option<Symbol> {
        let place = typed.kind.map(|kind| kind.at);
        match &self.last {
            Some((last, kind)) if Some(*last) == place => kind.clone(),
            _ => {
                let kind = kind_of(typed, domain, faults);
                self.last = place.map(|place| (place, kind.clone()));
                kind
            }
        }
    }
}

/// Reads parameters: `?from ?to - area ?d - door`. With a domain, their types must be declared.
pub(super) fn parameters(
    items: &[Tree],
    domain: Option<&Domain>,
    faults: &mut Faults,
) -> Vec<Parameter> {
    let mut out: Vec<Parameter> = Vec::new();
    let mut names = BTreeSet::new();
    let mut kinds = Kinds::default();
    for typed in typed_list(items, faults) {
        let Some(name) = variable(typed.name, faults) else {
            continue;
        };
        if !names.insert(name.clone()) {
            faults.add(typed.name.at, format!("`{name}` is declared twice"));
            continue;
        }
        if out.len() == MAX_VARIABLES {
            let message = format!("more than {MAX_VARIABLES} variables");
            faults.add(typed.name.at, message);
            break;
        }
        let kind = kinds
            .next(&typed, domain, faults)
            .unwrap_or_else(|| Symbol::from("object"));
        out.push(Parameter { name, kind });
    }
    out
}
