//! A small restaurant for tests: one carrier with a base, an arm, a tray for two and a voice.

use std::sync::Arc;

use crate::agent::{Configuration, Executors, Policy};
use crate::language::{parse_atom, parse_domain, parse_effects, parse_pattern};
use crate::model::{
    ActionModel, Clause, Domain, ExecutionModel, Fact, FactChange, Map, Number, Parameter,
    Suspension, Symbol,
};

const DOMAIN: &str = "
(define (domain bistro)
  (:requirements :typing :hierarchy :negative-preconditions :equality)
  (:types place bottle guest slot - object)
  (:predicates (at ?p - place) (on ?a ?b - place) (hand-free) (holding ?b - bottle)
    (loaded ?b - bottle ?s - slot) (empty ?s - slot) (stands ?b - bottle ?p - place)
    (edge ?b - bottle ?p - place) (for ?b - bottle ?g - guest) (seated ?g - guest ?p - place)
    (served ?g - guest) (told ?g - guest) (spill ?p - place) (blocked ?p - place)
    (counter ?p - place))
  (:functions (far ?a ?b - place) (total-cost))
  (:task serve :parameters (?g - guest))
  (:task get :parameters (?b - bottle ?g - guest))
  (:task bring :parameters (?b - bottle ?g - guest ?t - place))
  (:task stow :parameters (?b - bottle))
  (:task free-hand :parameters ())
  (:task reach :parameters (?p - place))
  (:task clean :parameters (?p - place))
  (:task chat :parameters (?g - guest))
  (:method served-already :parameters (?g - guest) :task (serve ?g)
    :precondition (served ?g) :ordered-subtasks ())
  (:method serving :parameters (?g - guest ?b - bottle ?t - place) :task (serve ?g)
    :precondition (and (not (served ?g)) (seated ?g ?t) (for ?b ?g))
    :ordered-subtasks (and (get ?b ?g) (bring ?b ?g ?t)))
  (:method aboard :parameters (?b - bottle ?g - guest ?s - slot) :task (get ?b ?g)
    :precondition (loaded ?b ?s) :ordered-subtasks ())
  (:method in-hand :parameters (?b - bottle ?g - guest) :task (get ?b ?g)
    :precondition (holding ?b) :ordered-subtasks ())
  (:method from-its-place :parameters (?b - bottle ?g - guest ?p - place ?s - slot)
    :task (get ?b ?g)
    :precondition (and (stands ?b ?p) (empty ?s))
    :ordered-subtasks (and (reach ?p) (free-hand) (grasp ?b ?p) (stow ?b)))
  (:method from-the-edge :parameters (?b - bottle ?g - guest ?p - place ?s - slot)
    :task (get ?b ?g)
    :precondition (and (edge ?b ?p) (empty ?s))
    :ordered-subtasks (and (reach ?p) (free-hand) (pick-up ?b ?p) (stow ?b)))
  (:method stowing :parameters (?b - bottle ?s - slot ?p - place) :task (stow ?b)
    :precondition (and (at ?p) (empty ?s)) :ordered-subtasks (put-on-tray ?b ?s ?p))
  (:method from-the-tray :parameters (?b - bottle ?g - guest ?t - place ?s - slot)
    :task (bring ?b ?g ?t)
    :precondition (loaded ?b ?s)
    :ordered-subtasks (and (reach ?t) (free-hand) (take ?b ?s ?t) (put-drink ?b ?g ?t)))
  (:method from-the-hand :parameters (?b - bottle ?g - guest ?t - place) :task (bring ?b ?g ?t)
    :precondition (and (holding ?b) (at ?t)) :ordered-subtasks (put-drink ?b ?g ?t))
  (:method stow-first :parameters (?b - bottle ?g - guest ?t ?p - place ?s - slot)
    :task (bring ?b ?g ?t)
    :precondition (and (holding ?b) (at ?p) (not (= ?p ?t)) (empty ?s))
    :ordered-subtasks (and (put-on-tray ?b ?s ?p) (reach ?t) (take ?b ?s ?t) (put-drink ?b ?g ?t)))
  (:method is-free :parameters () :task (free-hand)
    :precondition (hand-free) :ordered-subtasks ())
  (:method onto-the-tray :parameters (?b - bottle ?s - slot ?p - place) :task (free-hand)
    :precondition (and (holding ?b) (empty ?s) (at ?p))
    :ordered-subtasks (put-on-tray ?b ?s ?p))
  (:method onto-the-counter :parameters (?b - bottle ?p - place) :task (free-hand)
    :precondition (and (holding ?b) (at ?p) (counter ?p))
    :ordered-subtasks (put-down ?b ?p))
  (:method there :parameters (?p - place) :task (reach ?p)
    :precondition (at ?p) :ordered-subtasks ())
  (:method drive :parameters (?p ?x - place) :task (reach ?p)
    :precondition (and (at ?x) (not (= ?x ?p)) (hand-free)) :ordered-subtasks (move ?x ?p))
  (:method hand-first :parameters (?p ?x - place ?b - bottle) :task (reach ?p)
    :precondition (and (at ?x) (not (= ?x ?p)) (holding ?b))
    :ordered-subtasks (and (free-hand) (reach ?p)))
  (:method off-the-way :parameters (?p ?a ?b - place) :task (reach ?p)
    :precondition (on ?a ?b) :ordered-subtasks (and (leave ?a ?b) (reach ?p)))
  (:method cleaning :parameters (?p - place) :task (clean ?p)
    :precondition (spill ?p)
    :ordered-subtasks (and (reach ?p) (free-hand) (wipe ?p)))
  (:method clean-already :parameters (?p - place) :task (clean ?p)
    :precondition (not (spill ?p)) :ordered-subtasks ())
  (:method chatting :parameters (?g - guest ?t - place) :task (chat ?g)
    :precondition (seated ?g ?t) :ordered-subtasks (and (reach ?t) (talk ?g ?t)))
  (:action move :parameters (?a ?b - place)
    :precondition (and (at ?a) (hand-free) (not (blocked ?b)))
    :effect (and (not (at ?a)) (at ?b) (increase (total-cost) (far ?a ?b))))
  (:action resume-move :parameters (?a ?b - place)
    :precondition (and (on ?a ?b) (hand-free) (not (blocked ?b)))
    :effect (and (not (on ?a ?b)) (at ?b) (increase (total-cost) 20)))
  (:action return :parameters (?a ?b - place)
    :precondition (and (on ?a ?b) (hand-free))
    :effect (and (not (on ?a ?b)) (at ?a) (increase (total-cost) 20)))
  (:action leave :parameters (?a ?b - place)
    :precondition (and (on ?a ?b) (hand-free))
    :effect (and (not (on ?a ?b)) (at ?a) (increase (total-cost) 20)))
  (:action grasp :parameters (?b - bottle ?p - place)
    :precondition (and (at ?p) (hand-free) (stands ?b ?p))
    :effect (and (not (hand-free)) (not (stands ?b ?p)) (holding ?b) (increase (total-cost) 30)))
  (:action resume-grasp :parameters (?b - bottle ?p - place)
    :precondition (and (at ?p) (hand-free) (edge ?b ?p))
    :effect (and (not (hand-free)) (not (edge ?b ?p)) (holding ?b) (increase (total-cost) 20)))
  (:action set-back :parameters (?b - bottle ?p - place)
    :precondition (and (at ?p) (hand-free) (edge ?b ?p))
    :effect (and (not (edge ?b ?p)) (stands ?b ?p) (increase (total-cost) 8)))
  (:action pick-up :parameters (?b - bottle ?p - place)
    :precondition (and (at ?p) (hand-free) (edge ?b ?p))
    :effect (and (not (hand-free)) (not (edge ?b ?p)) (holding ?b) (increase (total-cost) 30)))
  (:action put-on-tray :parameters (?b - bottle ?s - slot ?p - place)
    :precondition (and (at ?p) (holding ?b) (empty ?s))
    :effect (and (not (holding ?b)) (not (empty ?s)) (hand-free) (loaded ?b ?s)
      (increase (total-cost) 15)))
  (:action resume-put-on-tray :parameters (?b - bottle ?s - slot ?p - place)
    :precondition (and (at ?p) (holding ?b) (empty ?s))
    :effect (and (not (holding ?b)) (not (empty ?s)) (hand-free) (loaded ?b ?s)
      (increase (total-cost) 8)))
  (:action take :parameters (?b - bottle ?s - slot ?p - place)
    :precondition (and (at ?p) (hand-free) (loaded ?b ?s))
    :effect (and (not (hand-free)) (not (loaded ?b ?s)) (empty ?s) (holding ?b)
      (increase (total-cost) 12)))
  (:action resume-take :parameters (?b - bottle ?s - slot ?p - place)
    :precondition (and (at ?p) (hand-free) (loaded ?b ?s))
    :effect (and (not (hand-free)) (not (loaded ?b ?s)) (empty ?s) (holding ?b)
      (increase (total-cost) 12)))
  (:action put-drink :parameters (?b - bottle ?g - guest ?p - place)
    :precondition (and (at ?p) (holding ?b) (seated ?g ?p) (not (served ?g)))
    :effect (and (not (holding ?b)) (hand-free) (stands ?b ?p) (served ?g)
      (increase (total-cost) 20)))
  (:action put-down :parameters (?b - bottle ?p - place)
    :precondition (and (at ?p) (holding ?b) (counter ?p))
    :effect (and (not (holding ?b)) (hand-free) (stands ?b ?p) (increase (total-cost) 20)))
  (:action wipe :parameters (?p - place)
    :precondition (and (at ?p) (hand-free) (spill ?p))
    :effect (and (not (spill ?p)) (increase (total-cost) 25)))
  (:action resume-wipe :parameters (?p - place)
    :precondition (and (at ?p) (hand-free) (spill ?p))
    :effect (and (not (spill ?p)) (increase (total-cost) 12)))
  (:action talk :parameters (?g - guest ?p - place)
    :precondition (and (at ?p) (seated ?g ?p))
    :effect (and (told ?g) (increase (total-cost) 10)))
  (:action resume-talk :parameters (?g - guest ?p - place)
    :precondition (and (at ?p) (seated ?g ?p))
    :effect (and (told ?g) (increase (total-cost) 5))))
";

/// Kitchen and tables; how many seconds the carrier drives from one to another.
pub const PLACES: [&str; 4] = ["kitchen", "table1", "table2", "table3"];
const FAR: [(&str, &str, f64); 6] = [
    ("kitchen", "table1", 40.0),
    ("kitchen", "table2", 48.0),
    ("kitchen", "table3", 60.0),
    ("table1", "table2", 23.0),
    ("table1", "table3", 40.0),
    ("table2", "table3", 23.0),
];

/// Guests, each with a bottle of their own in the kitchen.
pub const GUESTS: usize = 8;

fn parameters(domain: &Domain, action: &str) -> Vec<Parameter> {
    domain.operators[action].parameters.clone()
}

struct Models<'a> {
    domain: &'a Domain,
    model: ExecutionModel,
}

impl Models<'_> {
    fn action(&mut self, name: &str, seconds: f64, resources: &[&str], protected: &[&str]) {
        let parameters = parameters(self.domain, name);
        let protected = protected.iter().map(|text| {
            let pattern = parse_pattern(text, &parameters).expect("a pattern");
            Clause::Fact(true, pattern)
        });
        let model = ActionModel {
            duration_s: Some(match name {
                "move" => {
                    Number::Function(parse_pattern("(far ?a ?b)", &parameters).expect("a pattern"))
                }
                _ => Number::Constant(seconds),
            }),
            repeatable: name != "put-drink",
            achieves_state: name == "move",
            protected: protected.collect(),
            resources: resources.iter().map(|it| Symbol::from(*it)).collect(),
            ..ActionModel::default()
        };
        self.model.actions.insert(name.into(), model);
    }

    fn suspension(
        &mut self,
        name: &str,
        effect: &[&str],
        rollback: Option<&str>,
        reach: Option<&str>,
    ) {
        let parameters = parameters(self.domain, name);
        let names: Vec<&str> = parameters.iter().map(|it| it.name.as_str()).collect();
        let pattern = |text: &str| parse_pattern(text, &parameters).expect("a pattern");
        let suspension = Suspension {
            effect: parse_effects(effect, &parameters, self.domain).expect("an effect"),
            resume: pattern(&format!("(resume-{name} {})", names.join(" "))),
            rollback: rollback.map(pattern),
            reach: reach.map(pattern),
        };
        let model = self.model.actions.get_mut(name).expect("it is there");
        model.suspension = Some(suspension);
    }
}

fn model(domain: &Domain) -> ExecutionModel {
    let mut models = Models {
        domain,
        model: ExecutionModel::default(),
    };
    models.action("move", 0.0, &["base"], &[]);
    models.suspension(
        "move",
        &["(not (at ?a))", "(on ?a ?b)"],
        Some("(return ?a ?b)"),
        None,
    );
    for name in ["resume-move", "return", "leave"] {
        models.action(name, 20.0, &["base"], &[]);
    }
    models.action("grasp", 30.0, &["arm"], &["(at ?p)", "(stands ?b ?p)"]);
    models.suspension(
        "grasp",
        &["(not (stands ?b ?p))", "(edge ?b ?p)"],
        Some("(set-back ?b ?p)"),
        Some("(reach ?p)"),
    );
    models.action("resume-grasp", 20.0, &["arm"], &["(at ?p)"]);
    models.action("set-back", 8.0, &["arm"], &["(at ?p)"]);
    models.action("pick-up", 30.0, &["arm"], &["(at ?p)"]);
    models.action("put-on-tray", 15.0, &["arm", "tray"], &["(at ?p)"]);
    models.suspension("put-on-tray", &[], None, None);
    models.action("resume-put-on-tray", 8.0, &["arm", "tray"], &["(at ?p)"]);
    models.action("take", 12.0, &["arm", "tray"], &["(at ?p)"]);
    models.suspension("take", &[], None, Some("(reach ?p)"));
    models.action("resume-take", 12.0, &["arm", "tray"], &["(at ?p)"]);
    models.action("put-drink", 20.0, &["arm"], &["(at ?p)"]);
    models.action("put-down", 20.0, &["arm"], &["(at ?p)"]);
    models.action("wipe", 25.0, &["arm"], &["(at ?p)"]);
    models.suspension("wipe", &[], None, Some("(reach ?p)"));
    models.action("resume-wipe", 12.0, &["arm"], &["(at ?p)"]);
    models.action("talk", 10.0, &["voice"], &["(at ?p)"]);
    models.suspension("talk", &[], None, Some("(reach ?p)"));
    models.action("resume-talk", 5.0, &["voice"], &["(at ?p)"]);
    let mut model = models.model;
    model.observable = ["seated", "spill", "blocked"].map(Symbol::from).to_vec();
    model
}

/// A fact from its text.
pub fn fact(text: &str) -> Fact {
    parse_atom(text).expect("a fact")
}

/// What the carrier is made with. Guest `g0` sits at table 1, `g1` at table 2, and so on round.
pub fn configuration(epoch: u64) -> Configuration {
    let mut map = Map::default();
    for place in PLACES {
        map.objects.insert(place.into(), "place".into());
    }
    for slot in ["slot1", "slot2"] {
        map.objects.insert(slot.into(), "slot".into());
    }
    for (a, b, seconds) in FAR {
        for args in [[a, b], [b, a]] {
            let far = Fact::new("far", args);
            map.facts.apply(&FactChange::Set(far, seconds));
        }
    }
    map.facts.apply(&FactChange::Add(fact("(counter kitchen)")));
    let mut facts: Vec<FactChange> = [
        "(at kitchen)",
        "(hand-free)",
        "(empty slot1)",
        "(empty slot2)",
    ]
    .map(|text| FactChange::Add(fact(text)))
    .to_vec();
    for number in 0..GUESTS {
        let (guest, bottle) = (format!("g{number}"), format!("b{number}"));
        map.objects.insert(guest.as_str().into(), "guest".into());
        map.objects.insert(bottle.as_str().into(), "bottle".into());
        let table = PLACES[1 + number % 3];
        for text in [
            format!("(seated {guest} {table})"),
            format!("(for {bottle} {guest})"),
            format!("(stands {bottle} kitchen)"),
        ] {
            facts.push(FactChange::Add(fact(&text)));
        }
    }
    let domain = parse_domain(DOMAIN).expect("a domain");
    Configuration {
        name: "k3".into(),
        epoch,
        model: Arc::new(model(&domain)),
        domain: Arc::new(domain),
        map,
        maps_below: Arc::new(()),
        facts,
        executors: Executors::one("room"),
        policy: Policy {
            keep_what_helps: false,
            ..Policy::default()
        },
    }
}
