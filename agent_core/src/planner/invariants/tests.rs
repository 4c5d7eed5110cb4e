//! What is found in domains of which one knows what is to be found.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use super::*;
use crate::language::{parse_domain, parse_effects, parse_pattern};
use crate::model::{
    ActionModel, Atom, Change, Clause, Domain, Effect, ExecutionModel, Fact, Parameter, Pattern,
    Suspension, Symbol, Term,
};

fn domain(body: &str) -> Domain {
    let requirements = "(:requirements :typing :hierarchy :negative-preconditions :equality \
        :universal-effects)";
    let text = format!("(define (domain d) {requirements} {body})");
    parse_domain(&text).unwrap_or_else(|errors| panic!("{errors:?}"))
}

/// The model in which `action` can be suspended.
fn suspending(domain: &Domain, action: &str, effect: &[&str], resume: &str) -> ExecutionModel {
    let parameters = &domain.operators[&Symbol::from(action)].parameters;
    let suspension = Suspension {
        effect: parse_effects(effect, parameters, domain).unwrap(),
        resume: parse_pattern(resume, parameters).unwrap(),
        rollback: None,
        reach: None,
    };
    let mut model = ExecutionModel::default();
    model.actions.insert(
        Symbol::from(action),
        ActionModel {
            suspension: Some(suspension),
            ..ActionModel::default()
        },
    );
    model
}

fn groups(domain: &Domain, model: &ExecutionModel) -> Vec<String> {
    let found = mutex_groups(domain, model);
    found.iter().map(ToString::to_string).collect()
}

const ROBOT: &str = "(:types node arc - object)
    (:predicates (at ?n - node) (on ?a - arc) (link ?x ?y - node ?a - arc) (seen ?n - node))
    (:action move :parameters (?x ?y - node ?a - arc)
      :precondition (and (at ?x) (link ?x ?y ?a))
      :effect (and (not (at ?x)) (at ?y) (seen ?y)))
    (:action resume-move :parameters (?x ?y - node ?a - arc)
      :precondition (on ?a)
      :effect (and (not (on ?a)) (at ?y) (seen ?y)))";

#[test]
fn a_robot_is_at_one_node() {
    let domain = domain(
        "(:types node) (:predicates (at ?n - node) (seen ?n - node))
         (:action move :parameters (?x ?y - node) :precondition (at ?x)
           :effect (and (not (at ?x)) (at ?y) (seen ?y)))",
    );
    assert_eq!(groups(&domain, &ExecutionModel::default()), ["{(at *)}"]);
}

#[test]
fn a_robot_stopped_on_an_arc_is_at_no_node() {
    let domain = domain(ROBOT);
    let model = suspending(
        &domain,
        "move",
        &["(not (at ?x))", "(on ?a)"],
        "(resume-move ?x ?y ?a)",
    );
    assert_eq!(groups(&domain, &model), ["{(at *), (on *)}"]);
}

#[test]
fn without_the_suspension_nothing_is_ever_on_an_arc() {
    assert_eq!(
        groups(&domain(ROBOT), &ExecutionModel::default()),
        [] as [&str; 0],
        "resuming alone would put the robot at two nodes"
    );
}

#[test]
fn a_suspension_that_leaves_the_robot_at_its_node_breaks_the_group() {
    let domain = domain(ROBOT);
    let model = suspending(&domain, "move", &["(on ?a)"], "(resume-move ?x ?y ?a)");
    assert_eq!(groups(&domain, &model), [] as [&str; 0]);
}

#[test]
fn to_clear_whatever_is_there_is_to_keep_the_group() {
    let domain = domain(
        "(:types node area) (:predicates (at ?n - node) (in ?a - area) (inside ?n - node ?a - area))
         (:action approach :parameters (?n - node ?a - area)
           :precondition (and (in ?a) (inside ?n ?a))
           :effect (and (forall (?x - node) (not (at ?x))) (at ?n)))
         (:action enter :parameters (?a ?b - area) :precondition (in ?a)
           :effect (and (forall (?x - node) (not (at ?x))) (not (in ?a)) (in ?b)))",
    );
    assert_eq!(
        groups(&domain, &ExecutionModel::default()),
        ["{(at *)}", "{(in *)}"]
    );
}

/// `domain`'s action `name` with its effect changed.
fn with_effect(mut domain: Domain, name: &str, change: impl Fn(&mut Effect)) -> Domain {
    change(
        &mut domain
            .operators
            .get_mut(&Symbol::from(name))
            .unwrap()
            .effect,
    );
    domain
}

/// `(name)` or, of a variable, `(name ?v)`.
fn pattern(name: &str, variables: &[usize]) -> Pattern {
    Pattern {
        name: Symbol::from(name),
        args: variables.iter().copied().map(Term::Variable).collect(),
    }
}

fn holds(name: &str, variables: &[usize]) -> Clause {
    Clause::Fact(true, pattern(name, variables))
}

fn of_type(kind: &str) -> Vec<Parameter> {
    vec![Parameter {
        name: Symbol::from("?q"),
        kind: Symbol::from(kind),
    }]
}

#[test]
fn to_clear_a_part_of_what_may_be_there_does_not_keep_it() {
    let jump = |clear: Change| {
        let domain = domain(
            "(:types room - node node - object) (:predicates (at ?n - node) (seen ?n - node))
             (:action jump :parameters (?n - node) :effect (at ?n))",
        );
        let domain = with_effect(domain, "jump", |effect| effect.remove = vec![clear.clone()]);
        groups(&domain, &ExecutionModel::default())
    };
    let everything = Change {
        over: of_type("node"),
        when: Vec::new(),
        fact: pattern("at", &[1]),
    };
    assert_eq!(jump(everything.clone()), ["{(at *)}"]);
    let what_is_there = Change {
        when: vec![holds("at", &[1])],
        ..everything.clone()
    };
    assert_eq!(jump(what_is_there), ["{(at *)}"]);
    let rooms = Change {
        over: of_type("room"),
        ..everything.clone()
    };
    assert_eq!(jump(rooms), [] as [&str; 0]);
    for when in [holds("seen", &[1]), holds("seen", &[0])] {
        let sometimes = Change {
            when: vec![when],
            ..everything.clone()
        };
        assert_eq!(jump(sometimes), [] as [&str; 0]);
    }
}

#[test]
fn conditional_effects_balance_each_other_under_the_same_condition() {
    let go = |when_removed: &str, when_added: &str| {
        let domain = domain(
            "(:types node) (:predicates (at ?n - node) (lit) (open))
             (:action go :parameters (?x ?y - node) :precondition (at ?x)
               :effect (and (not (at ?x)) (at ?y)))",
        );
        let domain = with_effect(domain, "go", |effect| {
            effect.remove[0].when = vec![holds(when_removed, &[])];
            effect.add[0].when = vec![holds(when_added, &[])];
        });
        groups(&domain, &ExecutionModel::default())
    };
    assert_eq!(go("lit", "lit"), ["{(at *)}"]);
    assert_eq!(
        go("open", "lit"),
        [] as [&str; 0],
        "one may hold without the other"
    );
}

#[test]
fn quantified_effects_can_move_many_things_at_once() {
    let domain = domain(
        "(:types place box)
         (:predicates (at ?b - box ?p - place) (carried ?b - box))
         (:action take-all :parameters (?p - place))
         (:action drop-all :parameters (?p - place))",
    );
    // (forall (?b - box) (when (at ?b ?p) (and (not (at ?b ?p)) (carried ?b)))), and back.
    let (at, carried) = (pattern("at", &[1, 0]), pattern("carried", &[1]));
    let each = |when: &Pattern, fact: &Pattern| {
        vec![Change {
            over: of_type("box"),
            when: vec![Clause::Fact(true, when.clone())],
            fact: fact.clone(),
        }]
    };
    let domain = with_effect(domain, "take-all", |effect| {
        *effect = Effect {
            remove: each(&at, &at),
            add: each(&at, &carried),
        };
    });
    let domain = with_effect(domain, "drop-all", |effect| {
        *effect = Effect {
            remove: each(&carried, &carried),
            add: each(&carried, &at),
        };
    });
    assert_eq!(
        groups(&domain, &ExecutionModel::default()),
        ["{(at ?1 *), (carried ?1)}"]
    );
}

const BLOCKS: &str = "(:types block)
    (:predicates (on ?x ?y - block) (table ?x - block) (clear ?x - block) (holding ?x - block) (free))
    (:action pick-up :parameters (?x - block)
      :precondition (and (clear ?x) (table ?x) (free))
      :effect (and (not (clear ?x)) (not (table ?x)) (not (free)) (holding ?x)))
    (:action put-down :parameters (?x - block) :precondition (holding ?x)
      :effect (and (not (holding ?x)) (clear ?x) (table ?x) (free)))
    (:action stack :parameters (?x ?y - block) :precondition (and (holding ?x) (clear ?y))
      :effect (and (not (holding ?x)) (not (clear ?y)) (clear ?x) (free) (on ?x ?y)))
    (:action unstack :parameters (?x ?y - block)
      :precondition (and (on ?x ?y) (clear ?x) (free))
      :effect (and (not (on ?x ?y)) (not (clear ?x)) (not (free)) (holding ?x) (clear ?y)))";

#[test]
fn blocks_have_a_place_and_something_on_them_and_a_hand_holds_one() {
    assert_eq!(
        groups(&domain(BLOCKS), &ExecutionModel::default()),
        [
            "{(clear ?1), (holding ?1), (on * ?1)}",
            "{(free), (holding *)}",
            "{(holding ?1), (on ?1 *), (table ?1)}",
        ]
    );
}

#[test]
fn two_names_for_the_same_thing_are_seen_through() {
    // With ?x = ?y both would be added; the inequality says that it is not so.
    let swap = |different: &str| {
        domain(&format!(
            "(:types box place) (:predicates (at ?b - box ?p - place))
             (:action swap :parameters (?x ?y - box ?p ?q - place)
               :precondition (and (at ?x ?p) (at ?y ?q) {different})
               :effect (and (not (at ?x ?p)) (not (at ?y ?q)) (at ?x ?q) (at ?y ?p)))"
        ))
    };
    let model = ExecutionModel::default();
    let both = ["{(at ?1 *)}", "{(at * ?1)}"];
    assert_eq!(
        groups(&swap("(not (= ?x ?y)) (not (= ?p ?q))"), &model),
        both
    );
    // Or, without it, that a box is at one place: if ?x = ?y then ?p = ?q as well.
    assert_eq!(groups(&swap(""), &model), both);
    let copy = domain(
        "(:types box place) (:predicates (at ?b - box ?p - place))
         (:action put :parameters (?x ?y - box ?o ?p ?q - place)
           :precondition (at ?x ?o)
           :effect (and (not (at ?x ?o)) (at ?x ?p) (forall (?r - place) (not (at ?y ?r))) (at ?y ?q)))",
    );
    assert_eq!(groups(&copy, &model), [] as [&str; 0], "?x may be ?y");
}

#[test]
fn what_others_change_is_in_no_group() {
    let domain = domain(
        "(:types door) (:predicates (open ?d - door) (closed ?d - door))
         (:action open-it :parameters (?d - door) :precondition (closed ?d)
           :effect (and (not (closed ?d)) (open ?d)))
         (:action close-it :parameters (?d - door) :precondition (open ?d)
           :effect (and (not (open ?d)) (closed ?d)))",
    );
    let mut model = ExecutionModel::default();
    assert_eq!(
        groups(&domain, &model),
        ["{(closed ?1), (open ?1)}", "{(closed *), (open *)}"]
    );
    model.observable.push(Symbol::from("open"));
    assert_eq!(groups(&domain, &model), [] as [&str; 0]);
}

#[test]
fn two_things_that_are_never_gone_are_not_taken_for_one() {
    let domain = domain(
        "(:types room thing) (:predicates (in ?r - room) (held ?t - thing) (free))
         (:action go :parameters (?r ?s - room) :precondition (in ?r)
           :effect (and (not (in ?r)) (in ?s)))
         (:action take :parameters (?t - thing) :precondition (free)
           :effect (and (not (free)) (held ?t)))
         (:action put :parameters (?t - thing) :precondition (held ?t)
           :effect (and (not (held ?t)) (free)))",
    );
    assert_eq!(
        groups(&domain, &ExecutionModel::default()),
        ["{(free), (held *)}", "{(in *)}"]
    );
}

fn fact(name: &str, args: &[&str]) -> Fact {
    Atom::new(name, args.iter().copied())
}

#[test]
fn each_fact_belongs_to_one_variable_at_most() {
    let groups = mutex_groups(&domain(BLOCKS), &ExecutionModel::default());
    let variables = Variables::choose(&groups, []);
    let of = |name: &str, args: &[&str]| variables.variable_of(&fact(name, args));
    assert_eq!(of("clear", &["a"]), of("on", &["b", "a"]));
    assert_eq!(of("clear", &["a"]), of("holding", &["a"]));
    assert_ne!(of("clear", &["a"]), of("clear", &["b"]));
    assert!(of("clear", &["a"]).is_some());
    // What is left of the group of places when holding belongs elsewhere.
    assert_eq!(of("on", &["a", "b"]), of("clear", &["b"]));
    assert_eq!(of("free", &[]), None);
    assert_eq!(of("clear", &[]), None, "not as declared");
}

#[test]
fn a_belief_that_breaks_a_group_is_seen() {
    let domain = domain(ROBOT);
    let model = suspending(
        &domain,
        "move",
        &["(not (at ?x))", "(on ?a)"],
        "(resume-move ?x ?y ?a)",
    );
    let groups = mutex_groups(&domain, &model);
    let (at, on) = (fact("at", &["n1"]), fact("on", &["a1"]));
    let variables = Variables::choose(&groups, [&at]);
    assert_eq!(variables.groups().len(), 1);
    assert!(variables.broken([&at]).is_empty());
    assert_eq!(
        variables.broken([&at, &on]).into_iter().next(),
        variables.variable_of(&at)
    );
    assert_eq!(
        Variables::choose(&groups, [&at, &on]).variable_of(&at),
        None,
        "a group that does not hold is not chosen"
    );
}
