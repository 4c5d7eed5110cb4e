//! Doors that are closed, and what they cost.

use std::sync::Arc;

use super::*;
use crate::language::parse_domain;
use crate::model::{Atom, Belief, ExecutionModel, Symbol};
use crate::planner::random_domain::problem;
use crate::planner::{Origin, TaskList};

/// From `a` to `c`: by `short` (1), by `long` (5), or by two doors `x` and `y` (1 each). A method asks
/// whether the short way is allowed at all.
fn house(facts: &[&[&str]]) -> Problem {
    let text = "(define (domain d)
        (:requirements :typing :hierarchy :negative-preconditions :method-preconditions)
        (:types door)
        (:constants short long x y - door)
        (:predicates (open ?d - door) (forbidden))
        (:task go :parameters ())
        (:method directly :task (go) :precondition (not (forbidden)) :ordered-subtasks (pass short))
        (:method around :task (go) :ordered-subtasks (go-around))
        (:method by-two :task (go) :ordered-subtasks (and (pass x) (pass y)))
        (:action pass :parameters (?d - door) :precondition (open ?d)
          :effect (increase (total-cost) 1))
        (:action go-around :parameters () :precondition (open long)
          :effect (increase (total-cost) 5)))";
    let text = text.replace("(:task", "(:functions (total-cost) - number) (:task");
    let domain = parse_domain(&text).unwrap_or_else(|errors| panic!("{errors:?}"));
    let model = ExecutionModel {
        observable: ["open", "forbidden"].map(Symbol::from).into(),
        ..ExecutionModel::default()
    };
    let fact = |words: &&[&str]| Atom::new(words[0], words[1..].iter().copied());
    let belief: Belief = facts.iter().map(fact).collect();
    problem(&Arc::new(domain), &Arc::new(model), &belief)
}

/// What would have to be different, and what it would cost then.
type Better = (Vec<String>, f64);

/// The plans that there are, and what would make for a better one.
fn considered(facts: &[&[&str]], budget: u64) -> (Vec<String>, Option<Better>, bool) {
    let agenda = Agenda {
        tasks: TaskList::of_tasks([Atom::new("go", [])].into_iter()),
        origin: Origin::Goal,
    };
    let all = consider(&house(facts), &[agenda], Settings::default(), None, budget);
    let words = |plan: &Plan| {
        let steps: Vec<String> = plan.actions().iter().map(ToString::to_string).collect();
        steps.join(" ")
    };
    let what_if = all.what_if.map(|it| {
        let changes = it.changes.iter().map(ToString::to_string);
        (changes.collect(), it.plan.cost.units())
    });
    (all.plans.iter().map(words).collect(), what_if, all.complete)
}

fn texts(texts: &[&str]) -> Vec<String> {
    texts.iter().map(ToString::to_string).collect()
}

#[test]
fn a_closed_door_on_a_shorter_way_is_named() {
    let (plans, what_if, complete) = considered(&[&["open", "long"], &["open", "x"]], 100);
    assert_eq!(plans, ["(go-around)"]);
    assert_eq!(what_if, Some((texts(&["(open short)"]), 1.0)));
    assert!(complete);
}

#[test]
fn a_way_that_would_be_longer_is_not() {
    let (plans, what_if, _) = considered(&[&["open", "short"], &["open", "x"]], 100);
    assert_eq!(plans, ["(pass short)"]);
    assert_eq!(what_if, None);
}

#[test]
fn what_only_a_method_asks_for_is_named_as_well() {
    let facts: [&[&str]; 3] = [&["open", "long"], &["open", "short"], &["forbidden"]];
    let (_, what_if, _) = considered(&facts, 100);
    let (changes, cost) = what_if.expect("the short way is allowed in some other world");
    assert!(
        changes.contains(&"(not (forbidden))".to_owned()),
        "{changes:?}"
    );
    assert_eq!(cost, 1.0);
}

#[test]
fn where_there_is_no_plan_it_says_what_it_would_take() {
    let (plans, what_if, _) = considered(&[], 100);
    assert_eq!(plans, [] as [&str; 0]);
    assert_eq!(what_if, Some((texts(&["(open short)"]), 1.0)));
}

#[test]
fn no_more_is_expanded_than_is_allowed() {
    let (plans, what_if, complete) = considered(&[&["open", "long"]], 1);
    assert_eq!((plans.len(), what_if, complete), (0, None, false));
}

#[test]
fn what_a_broken_plan_lacks_is_told_without_planning() {
    let agenda = Agenda {
        tasks: TaskList::of_tasks([Atom::new("go", [])].into_iter()),
        origin: Origin::Goal,
    };
    let open = house(&[&["open", "short"], &["open", "long"]]);
    let plans = consider(&open, &[agenda], Settings::default(), None, 100).plans;
    let closed = house(&[&["open", "long"]]);
    let mended = |best: f64| if_mended(&closed, &plans[0], Some(Cost::from_units(best)));
    let what_if = mended(5.0).expect("the short way is the better one");
    let changes: Vec<String> = what_if.changes.iter().map(ToString::to_string).collect();
    assert_eq!(changes, ["(open short)"]);
    assert_eq!(what_if.plan.cost.units(), 1.0);
    assert_eq!(mended(1.0), None, "it would be no better");
    assert_eq!(if_mended(&open, &plans[0], None), None, "it lacks nothing");
}

#[test]
fn what_the_graph_knows_is_at_hand_as_long_as_nothing_changes() {
    let agendas = [Agenda {
        tasks: TaskList::of_tasks([Atom::new("go", [])].into_iter()),
        origin: Origin::Goal,
    }];
    let house = house(&[&["open", "short"], &["open", "long"]]);
    let mut planner = crate::planner::GraphPlanner::new(Settings::default());
    assert_eq!(planner.known(&house, &agendas), []);
    planner.begin(house.clone(), &agendas);
    let outcome = planner.think(100).expect("the house is small");
    assert_eq!(planner.known(&house, &agendas), outcome.plans[..1]);
    let mut belief = Belief::clone(&house.belief);
    belief.apply(&FactChange::Remove(Fact::new("open", ["short"])));
    let closed = Problem {
        belief: Arc::new(belief),
        ..house
    };
    assert_eq!(planner.known(&closed, &agendas), [], "it was not told");
}
