//! Whether a domain has the words for what a map says.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Domain, Fact, Map, Parameter, Symbol};

/// What the map says and the domain cannot, one sentence for each word, and none twice.
pub(crate) fn missing_words(domain: &Domain, map: &Map) -> Vec<String> {
    let mut missing = BTreeSet::new();
    for (object, kind) in &map.objects {
        if kind != "object" && !domain.types.contains_key(kind) {
            missing.insert(format!("the map needs the type {kind}"));
        }
        if domain.constants.contains_key(object) {
            missing.insert(format!(
                "{object} is a constant, but also the name of something on the map"
            ));
        }
    }
    for fact in map.facts.facts() {
        missing.extend(misfit("predicate", &domain.predicates, fact, domain, map));
    }
    for (function, _) in map.facts.values() {
        missing.extend(misfit("function", &domain.functions, function, domain, map));
    }
    let unlisted = map
        .facts
        .landmarks()
        .filter_map(|landmarks| landmarks.example());
    for function in unlisted {
        missing.extend(misfit(
            "function",
            &domain.functions,
            &function,
            domain,
            map,
        ));
    }
    missing.into_iter().collect()
}

fn misfit(
    what: &str,
    declared: &BTreeMap<Symbol, Vec<Parameter>>,
    fact: &Fact,
    domain: &Domain,
    map: &Map,
) -> Option<String> {
    let kinds: Vec<&Symbol> = fact
        .args
        .iter()
        .filter_map(|arg| map.objects.get(arg))
        .collect();
    let fits = declared.get(&fact.name).is_some_and(|parameters| {
        parameters.len() == kinds.len()
            && (parameters.iter().zip(&kinds))
                .all(|(parameter, kind)| domain.is_a(kind, &parameter.kind))
    });
    (!fits).then(|| {
        let kinds: Vec<&str> = kinds.into_iter().map(Symbol::as_str).collect();
        format!(
            "the map needs the {what} ({} {})",
            fact.name,
            kinds.join(" ")
        )
    })
}

#[cfg(test)]
mod tests {
    use agent_core::language::parse_domain;

    use super::*;
    use crate::{Site, area_level, museum, scaled_map};

    fn missing(change: impl FnOnce(&mut Domain)) -> Vec<String> {
        let site = Site::from_text("map.geojson", museum::MAP).expect("sound");
        let mut domain = parse_domain(museum::AREA_DOMAIN).expect("in order");
        change(&mut domain);
        missing_words(&domain, &area_level(&site))
    }

    #[test]
    fn the_area_domain_has_the_words_for_the_area_level() {
        assert_eq!(missing(|_| {}), [""; 0]);
    }

    #[test]
    fn what_is_not_declared_is_missing() {
        let found = missing(|domain| {
            domain.predicates.remove("located");
            domain.functions.remove("visit");
            domain.types.remove("door");
        });
        assert_eq!(
            found,
            [
                "the map needs the function (visit node)",
                "the map needs the predicate (located node area)",
                "the map needs the type door",
            ]
        );
    }

    #[test]
    fn distances_that_are_too_many_to_list_need_a_word_too() {
        let site = Site::from_text("scaled", &scaled_map(1000, 1)).expect("sound");
        let mut domain = parse_domain(museum::AREA_DOMAIN).expect("in order");
        assert_eq!(missing_words(&domain, &area_level(&site)), [""; 0]);
        domain.functions.remove("distance");
        assert_eq!(
            missing_words(&domain, &area_level(&site)),
            ["the map needs the function (distance area node)"]
        );
    }

    #[test]
    fn what_is_declared_for_other_things_or_for_fewer_is_missing() {
        let found = missing(|domain| {
            let joins = domain.predicates.get_mut("joins").expect("declared");
            joins.swap(1, 2);
            let crossing = domain.functions.get_mut("crossing").expect("declared");
            crossing.pop();
        });
        assert_eq!(
            found,
            [
                "the map needs the function (crossing area area door)",
                "the map needs the predicate (joins area area door)",
            ]
        );
    }

    #[test]
    fn what_is_declared_for_more_general_things_will_do() {
        let found = missing(|domain| {
            let located = domain.predicates.get_mut("located").expect("declared");
            located[0].kind = Symbol::from("object");
        });
        assert_eq!(found, [""; 0]);
    }
}
