//! `(:types …)`, and the unions that `(either …)` makes of them.

use std::collections::{BTreeMap, BTreeSet};

use super::error::Faults;
use super::near::hint;
use super::tree::Tree;
use super::typed_list::{Kinds, either, name, typed_list};
use crate::model::{Domain, Parameter, Symbol};

/// More types above one another than anyone declares; whoever asks whether an object is of a type
/// climbs them all.
const MAX_HEIGHT: usize = 100;

/// Reads all types into the domain.
pub(super) fn types(items: &[Tree], domain: &mut Domain, faults: &mut Faults) {
    let list = typed_list(items, faults);
    let mut places = BTreeMap::new();
    let mut kinds = Kinds::default();
    for typed in &list {
        if typed.name.word() == Some("object") {
            continue; // some write out what holds anyway
        }
        let Some(kind) = name(typed.name, "a type", faults) else {
            continue;
        };
        if let Some(above) = typed.kind.filter(|above| above.word().is_none()) {
            let message = format!("expected one type above `{kind}`, found `{above}`");
            faults.add(above.at, message);
            continue;
        }
        let above = kinds.next(typed, None, faults);
        let above = above.unwrap_or_else(|| Symbol::from("object"));
        let message = format!("type `{kind}` is declared twice");
        match domain.types.insert(kind.clone(), above.clone()) {
            Some(before) if before == above => faults.slip(typed.name.at, message),
            Some(_) => faults.add(typed.name.at, message),
            None => {}
        }
        places.insert(kind, typed.name.at);
    }
    // Only now are all types known that may stand above others.
    let mut undeclared = BTreeSet::new();
    for kind in list.iter().filter_map(|typed| typed.kind) {
        if let Some(word) = kind.word().filter(|word| *word != "object")
            && !domain.types.contains_key(word)
            && undeclared.insert(word)
        {
            let among = domain.types.keys().map(Symbol::as_str);
            let hint = hint(word, among, "; declare it in `(:types …)`");
            let message = format!("type `{word}` is not declared{hint}");
            faults.slip(kind.at, message);
        }
    }
    for above in undeclared {
        let above = Symbol::from(above);
        domain.types.insert(above, Symbol::from("object"));
    }
    check_heights(domain, &places, faults);
}

/// No type stands above itself, nor too many above one.
fn check_heights(domain: &Domain, places: &BTreeMap<Symbol, usize>, faults: &mut Faults) {
    let mut heights: BTreeMap<&Symbol, usize> = BTreeMap::new();
    let place = |kind: &Symbol| places.get(kind).copied().unwrap_or_default();
    for kind in domain.types.keys() {
        // Up to where the height is known, then down again.
        let mut path: Vec<&Symbol> = Vec::new();
        let mut on_path = BTreeSet::new();
        let mut next = Some(kind);
        while let Some(kind) = next.filter(|kind| !heights.contains_key(kind)) {
            if !on_path.insert(kind) {
                for in_circle in path.iter().skip_while(|before| **before != kind) {
                    let message = format!("type `{in_circle}` stands above itself");
                    faults.add(place(in_circle), message);
                }
                break;
            }
            path.push(kind);
            next = domain
                .types
                .get_key_value(&domain.types[kind])
                .map(|(above, _)| above);
        }
        let lowest = next
            .and_then(|known| heights.get(known))
            .map_or(0, |known| known + 1);
        for (kind, height) in path.into_iter().rev().zip(lowest..) {
            if height == MAX_HEIGHT {
                let message = format!("more than {MAX_HEIGHT} types above one another");
                faults.add(place(kind), message);
            }
            heights.insert(kind, height);
        }
    }
}

/// Notes every `(either …)` that occurs anywhere in a text.
pub(super) fn unions(tree: &Tree, domain: &mut Domain) {
    if let Some((union, members)) = either(tree).filter(|(_, members)| members.len() > 1) {
        domain.unions.insert(union, members);
    }
    for item in tree.list().unwrap_or_default() {
        unions(item, domain);
    }
}

/// Forgets unions that nothing is of: they stood where they mean nothing, or in a condition that
/// is always true.
pub(super) fn forget_unused_unions(domain: &mut Domain) {
    if domain.unions.is_empty() {
        return;
    }
    let mut used = BTreeSet::new();
    let mut note = |parameter: &Parameter| {
        used.insert(parameter.kind.clone());
    };
    let lists = [&domain.predicates, &domain.functions, &domain.tasks];
    let declared = lists.into_iter().flat_map(BTreeMap::values).flatten();
    let own = domain
        .operators
        .values()
        .map(|operator| &operator.parameters);
    let own = own.chain(domain.methods.iter().map(|method| &method.parameters));
    let effects = domain.operators.values().map(|operator| &operator.effect);
    let changes = effects.flat_map(|effect| effect.remove.iter().chain(&effect.add));
    let over = changes.clone().flat_map(|change| &change.over);
    declared
        .chain(own.flatten())
        .chain(over)
        .for_each(&mut note);
    let conditions = domain
        .operators
        .values()
        .map(|operator| &operator.precondition);
    let conditions = conditions.chain(domain.methods.iter().map(|method| &method.precondition));
    for clause in conditions
        .chain(changes.map(|change| &change.when))
        .flatten()
    {
        clause.each_quantified(&mut note);
    }
    used.extend(domain.constants.values().cloned());
    domain.unions.retain(|union, _| used.contains(union));
}
