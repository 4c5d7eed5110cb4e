//! A small world for tests: spots in a row with a door, a robot that moves and explains.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::agent::{Agent, Configuration, Executors, Policy};
use crate::language::{parse_atom, parse_domain, parse_effects, parse_pattern};
use crate::model::{
    ActionModel, Clause, Domain, ExecutionModel, Fact, FactChange, Map, Number, Parameter,
    Projection, Suspension, Symbol, Time,
};
use crate::planner::Planner;

const DOMAIN: &str = "
(define (domain toy)
  (:requirements :typing :hierarchy :negative-preconditions)
  (:types spot - object)
  (:predicates (at ?a - spot) (on ?a ?b - spot) (link ?a ?b - spot) (open ?a ?b - spot)
    (told ?a - spot))
  (:functions (far ?a - spot) (total-cost))
  (:task go :parameters (?x - spot))
  (:task tell :parameters (?x - spot))
  (:task tour :parameters (?x ?y - spot))
  (:method there :parameters (?x - spot) :task (go ?x)
    :precondition (at ?x) :ordered-subtasks ())
  (:method nearer :parameters (?x ?y ?z - spot) :task (go ?x)
    :precondition (and (at ?y) (link ?y ?z) (open ?y ?z))
    :ordered-subtasks (and (move ?y ?z) (go ?x)))
  (:method off :parameters (?x ?y ?z - spot) :task (go ?x)
    :precondition (on ?y ?z)
    :ordered-subtasks (and (return ?y ?z) (go ?x)))
  (:method telling :parameters (?x - spot) :task (tell ?x)
    :ordered-subtasks (and (go ?x) (explain ?x)))
  (:method touring :parameters (?x ?y - spot) :task (tour ?x ?y)
    :ordered-subtasks (and (tell ?x) (go ?y) (tell ?y)))
  (:action move :parameters (?a ?b - spot)
    :precondition (and (at ?a) (link ?a ?b) (open ?a ?b))
    :effect (and (not (at ?a)) (at ?b) (increase (total-cost) 1)))
  (:action resume-move :parameters (?a ?b - spot)
    :precondition (on ?a ?b)
    :effect (and (not (on ?a ?b)) (at ?b)))
  (:action return :parameters (?a ?b - spot)
    :precondition (on ?a ?b)
    :effect (and (not (on ?a ?b)) (at ?a)))
  (:action explain :parameters (?a - spot)
    :precondition (at ?a)
    :effect (told ?a))
  (:action resume-explain :parameters (?a - spot)
    :precondition (at ?a)
    :effect (told ?a)))
";

/// How many spots there are.
pub const SPOTS: usize = 5;

/// A spot by its number.
pub fn spot(number: usize) -> String {
    format!("s{}", number % SPOTS)
}

fn model(domain: &Domain) -> ExecutionModel {
    let pattern = |text: &str, names: &[&str]| {
        let names: Vec<Parameter> = names.iter().map(|name| parameter(name)).collect();
        parse_pattern(text, &names).expect("a pattern")
    };
    let two = ["?a", "?b"];
    let parameters: Vec<Parameter> = two.iter().map(|name| parameter(name)).collect();
    let mut model = ExecutionModel::default();
    model.actions.insert(
        "move".into(),
        ActionModel {
            achieves_state: true,
            timeout_s: Some(Number::Constant(60.0)),
            protected: vec![Clause::Fact(true, pattern("(open ?a ?b)", &two))],
            suspension: Some(Suspension {
                effect: parse_effects(&["(not (at ?a))", "(on ?a ?b)"], &parameters, domain)
                    .expect("an effect"),
                resume: pattern("(resume-move ?a ?b)", &two),
                rollback: Some(pattern("(return ?a ?b)", &two)),
                reach: None,
            }),
            ..ActionModel::default()
        },
    );
    model.actions.insert(
        "explain".into(),
        ActionModel {
            repeatable: false,
            map_of: Some(0),
            suspension: Some(Suspension {
                effect: crate::model::Effect::default(),
                resume: pattern("(resume-explain ?a)", &["?a"]),
                rollback: None,
                reach: Some(pattern("(go ?a)", &["?a"])),
            }),
            ..ActionModel::default()
        },
    );
    model.observable.push("open".into());
    model.projections.push(Projection {
        parameters: vec![parameter("?a")],
        when: vec![Clause::Fact(true, pattern("(at ?a)", &["?a"]))],
        then: pattern("(robot-at ?a)", &["?a"]),
    });
    model
}

fn parameter(name: &str) -> Parameter {
    Parameter {
        name: name.into(),
        kind: "spot".into(),
    }
}

/// The spots and the ways between them. With `longer`, one more than usual.
pub fn map(longer: bool) -> Map {
    let mut map = Map::default();
    let count = SPOTS + usize::from(longer);
    for number in 0..count {
        map.objects
            .insert(Symbol::from(format!("s{number}")), "spot".into());
        if number > 0 {
            let (a, b) = (format!("s{}", number - 1), format!("s{number}"));
            for args in [[a.as_str(), &b], [b.as_str(), &a]] {
                map.facts.apply(&FactChange::Add(Fact::new("link", args)));
            }
        }
    }
    map
}

/// What an agent of this world is made with.
pub fn configuration(epoch: u64, policy: Policy) -> Configuration {
    let mut facts = vec![FactChange::Add(fact("(at s0)"))];
    for link in map(true).facts.facts() {
        let mut open = link.clone();
        open.name = "open".into();
        facts.push(FactChange::Add(open));
    }
    facts.push(FactChange::Set(fact("(far s0)"), 1.0));
    let domain = parse_domain(DOMAIN).expect("a domain");
    Configuration {
        name: "mid".into(),
        epoch,
        model: Arc::new(model(&domain)),
        domain: Arc::new(domain),
        map: map(false),
        maps_below: Arc::new(()),
        facts,
        executors: Executors {
            default: "left".into(),
            of_place: BTreeMap::from([
                ("s3".into(), "right".into()),
                ("s4".into(), "right".into()),
            ]),
        },
        policy,
    }
}

/// An agent of this world, in its epoch.
pub fn agent<P: Planner>(epoch: u64, planner: P) -> Agent<P> {
    Agent::new(configuration(epoch, policy()), planner)
}

/// An agent of this world that believes what it has done only when sensors confirm it.
pub fn monitored<P: Planner>(epoch: u64, planner: P) -> Agent<P> {
    let mut configuration = configuration(epoch, policy());
    let model = Arc::make_mut(&mut configuration.model);
    let goal_states = [("move", "(at ?b)"), ("explain", "(told ?a)")];
    for (action, goal_state) in goal_states {
        let names = ["?a", "?b"].map(parameter);
        let pattern = parse_pattern(goal_state, &names).expect("a pattern");
        if let Some(action) = model.actions.get_mut(action) {
            action.goal_states = vec![Clause::Fact(true, pattern)];
            action.timeout_s = Some(Number::Constant(60.0));
        }
    }
    Agent::new(configuration, planner)
}

/// Facts that are so, and those that are not.
pub fn changes(texts: &[&str]) -> Vec<FactChange> {
    let change = |text: &&str| match text.strip_prefix("not ") {
        Some(text) => FactChange::Remove(fact(text)),
        None => FactChange::Add(fact(text)),
    };
    texts.iter().map(change).collect()
}

/// Slices so small that planning is met in the middle, and few goals that are remembered.
pub fn policy() -> Policy {
    Policy {
        expansions_per_slice: 7,
        ended_kept: 6,
        ended_kept_for: Time::from_secs(300.0),
        ..Policy::default()
    }
}

/// A fact from its text.
pub fn fact(text: &str) -> Fact {
    parse_atom(text).expect("a fact")
}
