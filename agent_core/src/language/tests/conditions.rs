//! Conditions and effects, and what they are read to.

use super::{SMALL, pattern};
use crate::language::parse_domain;
use crate::model::{Change, Clause, Condition, Effect, Parameter, Pattern, Symbol, Term};

/// The first condition of the method `one-door`, if that were written so.
fn condition(text: &str) -> Condition {
    let text = SMALL.replace("(not (= ?a ?r))", text);
    let domain = parse_domain(&text).unwrap_or_else(|errors| panic!("{errors:#?}"));
    domain.methods[1].precondition[2..].to_vec()
}

fn at(variable: usize) -> Clause {
    Clause::Fact(true, pattern("at", &[variable]))
}

fn not_at(variable: usize) -> Clause {
    Clause::Fact(false, pattern("at", &[variable]))
}

fn quantified(name: &str, kind: &str) -> Vec<Parameter> {
    vec![Parameter {
        name: Symbol::from(name),
        kind: Symbol::from(kind),
    }]
}

#[test]
fn negations_are_moved_to_the_facts() {
    let choice = |choices: [Clause; 2]| Clause::Any(choices.map(|clause| vec![clause]).to_vec());
    let cases = [
        ("(or (at ?a) (at ?b))", choice([at(1), at(2)])),
        ("(imply (at ?a) (at ?b))", choice([not_at(1), at(2)])),
        (
            "(not (and (at ?a) (at ?b)))",
            choice([not_at(1), not_at(2)]),
        ),
        ("(not (not (at ?a)))", at(1)),
        ("(or (at ?a))", at(1)),
        ("(or)", Clause::Any(Vec::new())),
        (
            "(forall (?x - room) (at ?x))",
            Clause::Every(quantified("?x", "room"), vec![at(4)]),
        ),
        (
            "(not (forall (?x - room) (at ?x)))",
            Clause::Exists(quantified("?x", "room"), vec![not_at(4)]),
        ),
        (
            "(not (exists (?x - room) (at ?x)))",
            Clause::Every(quantified("?x", "room"), vec![not_at(4)]),
        ),
        (
            "(exists (?x - room) (forall (?y - room) (or (at ?x) (at ?y))))",
            Clause::Exists(
                quantified("?x", "room"),
                vec![Clause::Every(
                    quantified("?y", "room"),
                    vec![choice([at(4), at(5)])],
                )],
            ),
        ),
    ];
    for (text, clause) in cases {
        assert_eq!(condition(text), [clause], "{text}");
    }
    assert_eq!(
        condition("(not (or (at ?a) (at ?b)))"),
        [not_at(1), not_at(2)]
    );
    assert_eq!(
        condition("(not (imply (at ?a) (at ?b)))"),
        [at(1), not_at(2)]
    );
    assert_eq!(condition("(or (at ?a) ())"), []);
}

#[test]
fn the_inner_of_two_variables_of_one_name_is_meant() {
    assert_eq!(
        condition("(exists (?a - room) (at ?a))"),
        [Clause::Exists(quantified("?a", "room"), vec![at(4)])]
    );
}

#[test]
fn a_constraint_on_a_type_is_a_condition() {
    let same = |holds| Clause::Equal(holds, Term::Variable(4), Term::Variable(1));
    let of_type = quantified("?of-that-type", "room");
    assert_eq!(
        condition("(sortof ?a - room)"),
        [Clause::Exists(of_type.clone(), vec![same(true)])]
    );
    assert_eq!(
        condition("(not (sortof ?a - room))"),
        [Clause::Every(of_type, vec![same(false)])]
    );
}

/// The effect of the action `pass`, if a part of it were written so.
fn effect(text: &str) -> Effect {
    let text = SMALL.replace("(at ?b)", text);
    let domain = parse_domain(&text).unwrap_or_else(|errors| panic!("{errors:#?}"));
    domain.operators["pass"].effect.clone()
}

#[test]
fn effects_may_depend_and_range() {
    let found = effect("(forall (?x - room) (when (at ?x) (and (not (at ?x)) (at ?b))))");
    let change = |fact: Pattern| Change {
        over: quantified("?x", "room"),
        when: vec![at(3)],
        fact,
    };
    assert_eq!(
        found,
        Effect {
            remove: vec![pattern("at", &[0]).into(), change(pattern("at", &[3]))],
            add: vec![change(pattern("at", &[1]))],
        }
    );
}

#[test]
fn variables_of_a_condition_make_room_for_those_of_an_effect_within() {
    let found = effect("(when (exists (?y - room) (at ?y)) (forall (?x - room) (at ?x)))");
    assert_eq!(
        found.add,
        [Change {
            over: quantified("?x", "room"),
            when: vec![Clause::Exists(quantified("?y", "room"), vec![at(4)])],
            fact: pattern("at", &[3]),
        }]
    );
}

#[test]
fn quantified_variables_of_an_effect_never_share_a_name() {
    let found = effect("(forall (?a - room) (forall (?a - door) (joins ?b ?b ?a)))");
    let over = &found.add[0].over;
    assert_eq!(
        over.iter().map(|one| one.name.as_str()).collect::<Vec<_>>(),
        ["?a-2", "?a-3"]
    );
    assert_eq!(found.add[0].fact, pattern("joins", &[1, 1, 4]));
}

#[test]
fn a_union_that_nothing_is_of_is_none_of_the_domain() {
    for somewhere in [
        "(or () (exists (?x - (either room door)) (at ?x)))",
        "(forall (?x - (either room door)) ())",
    ] {
        let text = SMALL.replace("(not (= ?a ?r))", somewhere);
        let domain = parse_domain(&text).unwrap_or_else(|errors| panic!("{errors:#?}"));
        assert!(domain.unions.is_empty(), "{somewhere}");
    }
}

#[test]
fn a_type_may_be_either_of_several() {
    let domain = SMALL.replace("(?r - room) :task", "(?r - (either room door)) :task");
    let domain = parse_domain(&domain).unwrap();
    let union = Symbol::from("(either door room)");
    assert_eq!(domain.methods[0].parameters[0].kind, union);
    assert!(domain.is_a(&Symbol::from("room"), &union));
    assert!(!domain.is_a(&Symbol::from("place"), &union));
}
