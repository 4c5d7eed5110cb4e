//! Facts of which at most one holds, as one variable.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::language::{parse_domain, parse_tasks};
use crate::model::{Belief, ExecutionModel, Fact, FactChange, Map};
use crate::planner::graph::GraphPlanner;
use crate::planner::invariants::mutex_groups;
use crate::planner::{Agenda, NaivePlanner, Origin, Planner, Problem, Settings, TaskList};

/// A robot is at one place at most. Nobody asks whether it is there before it is taken away.
const DOMAIN: &str = "(define (domain places)
  (:requirements :typing :hierarchy)
  (:types place - object)
  (:constants here there - place)
  (:predicates (at ?p - place))
  (:task leave-and-greet :parameters (?p ?q - place))
  (:method one-after-the-other
    :parameters (?p ?q - place)
    :task (leave-and-greet ?p ?q)
    :ordered-subtasks (and (leave ?p) (greet ?q)))
  (:action move
    :parameters (?p ?q - place)
    :precondition (at ?p)
    :effect (and (not (at ?p)) (at ?q)))
  (:action leave
    :parameters (?p - place)
    :effect (not (at ?p)))
  (:action greet
    :parameters (?p - place)
    :precondition (at ?p)))";

/// Standing `here`, a place is left and then somebody is greeted. How many plans there are.
fn plans_to(task: &str, planner: &mut dyn Planner) -> usize {
    let domain = parse_domain(DOMAIN).expect("the places are in order");
    let model = ExecutionModel::default();
    let groups = mutex_groups(&domain, &model);
    assert_eq!(groups.len(), 1, "the places are one variable: {groups:?}");
    let mut belief = Belief::default();
    belief.apply(&FactChange::Add(Fact::new("at", ["here"])));
    let problem = Problem {
        domain: Arc::new(domain),
        model: Arc::new(model),
        map: Arc::new(Map::default()),
        belief: Arc::new(belief),
        forbidden: BTreeSet::new(),
    };
    let tasks = parse_tasks(task).expect("a task in HDDL");
    let agenda = Agenda {
        tasks: TaskList::of_tasks(tasks.into_iter()),
        origin: Origin::Goal,
    };
    planner.begin(problem, &[agenda]);
    loop {
        if let Some(outcome) = planner.think(100) {
            return outcome.plans.len();
        }
    }
}

#[test]
fn leaving_a_place_where_it_is_not_leaves_the_robot_where_it_is() {
    for (task, plans) in [
        ("(leave-and-greet there here)", 1),
        ("(leave-and-greet here here)", 0),
    ] {
        let mut graph = GraphPlanner::new(Settings::default());
        let mut naive = NaivePlanner::new(Settings::default());
        assert_eq!(plans_to(task, &mut naive), plans, "{task}");
        assert_eq!(plans_to(task, &mut graph), plans, "{task}");
    }
}
