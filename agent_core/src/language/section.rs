//! What domains and problems have in common: `(define (domain …) SECTION …)`.

use super::error::Faults;
use super::near::hint;
use super::tree::Tree;
use super::typed_list::name;
use crate::model::Symbol;

/// What authors announce. Whatever of it is used and not read here is refused at its place.
const REQUIREMENTS: &[&str] = &[
    ":strips",
    ":typing",
    ":hierarchy",
    ":hierachy", // so in the published benchmark domains
    ":htn",
    ":method-preconditions",
    ":negative-preconditions",
    ":disjunctive-preconditions",
    ":existential-preconditions",
    ":universal-preconditions",
    ":quantified-preconditions",
    ":universal-effects",
    ":conditional-effects",
    ":equality",
    ":constraints",
    ":fluents",
    ":numeric-fluents",
    ":action-costs",
    ":adl",
    ":partial-order",
    ":total-order",
];

/// The name and the sections of the one domain or problem (`what`) that a text must be.
pub(super) fn sections<'t>(
    trees: &'t [Tree],
    what: &str,
    known: &[&str],
    faults: &mut Faults,
) -> Option<(Symbol, Vec<&'t Tree>)> {
    let wrong = format!("expected `(define ({what} NAME) …)`");
    let Some((define, after)) = trees.split_first() else {
        faults.add(
            0,
            format!("this is empty; a {what} is `(define ({what} NAME) …)`"),
        );
        return None;
    };
    let (Some("define"), Some([_, header, items @ ..])) = (define.head(), define.list()) else {
        faults.add(define.at, wrong);
        return None;
    };
    let called = match (header.head(), header.list()) {
        (Some(word), Some([_, called])) if word == what => {
            name(called, &format!("the {what}'s name"), faults)
        }
        (Some(other @ ("domain" | "problem")), _) if other != what => {
            let message = format!("this is a {other}; a {what} is expected here");
            faults.add(header.at, message);
            return None;
        }
        _ => {
            faults.add(header.at, wrong);
            None
        }
    };
    if let Some(first) = after.first() {
        faults.add(
            first.at,
            format!("the {what} has ended before this: there is a `)` too many above"),
        );
    }
    let sections: Vec<&Tree> = items.iter().chain(after).collect();
    for section in &sections {
        match section.head() {
            Some(head) if known.contains(&head) => {}
            Some(head) if head.starts_with(':') => {
                let hint = hint(head, known.iter().copied(), "; it is not supported");
                let message = format!("`{head}` is not a section that is read here{hint}");
                faults.add(section.at, message);
            }
            _ => faults.add(
                section.at,
                format!(
                    "expected a section such as `({} …)`, found `{section}`",
                    known.last().unwrap_or(&":requirements")
                ),
            ),
        }
    }
    Some((called.unwrap_or_default(), sections))
}

/// What is announced says nothing that the text does not, so that nothing is made of it.
pub(super) fn requirements(items: &[Tree], faults: &mut Faults) {
    for item in items {
        let word = item.word().unwrap_or_default();
        if !REQUIREMENTS.contains(&word) {
            let hint = hint(word, REQUIREMENTS.iter().copied(), "");
            let message = format!("unknown requirement `{item}`{hint}");
            faults.slip(item.at, message);
        }
    }
}
