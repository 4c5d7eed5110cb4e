//! Tasks and actions are done with arguments of their types only.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::Problem;
use super::decompose::successors;
use super::network::{Item, TaskList};
use super::state::Delta;
use crate::language::parse_domain;
use crate::model::{Atom, Belief, ExecutionModel, Map, Task};

const DOMAIN: &str = "(define (domain d)
  (:types room door - place)
  (:constants hall - room gate - door)
  (:predicates (open ?d - door) (lit ?p - place))
  (:task tend :parameters (?p - place))
  (:task knock :parameters (?d - door))
  (:method sweep :parameters (?r - room) :task (tend ?r) :ordered-subtasks ())
  (:method shut :parameters (?d - door) :task (tend ?d) :ordered-subtasks (close ?d))
  (:method itself :parameters (?p - place) :task (tend ?p) :ordered-subtasks (close ?p))
  (:method softly :parameters (?p - place) :task (knock ?p) :ordered-subtasks ())
  (:action close :parameters (?d - door) :effect (not (open ?d))))";

/// The names of what comes next when `task` is to be done: the first task left, or the action.
fn next(task: Task) -> Vec<String> {
    let problem = Problem {
        domain: Arc::new(parse_domain(DOMAIN).expect("nothing is wrong with it")),
        model: Arc::new(ExecutionModel::default()),
        map: Arc::new(Map::default()),
        belief: Arc::new(Belief::default()),
        forbidden: BTreeSet::new(),
    };
    let tasks = TaskList::default().prepend(Item::Task(task), None);
    let found = successors(
        &problem,
        &Delta::new(),
        &tasks,
        &mut 0,
        &mut BTreeSet::new(),
    );
    let words = found.into_iter().map(|successor| {
        let step = successor.step.map(|step| step.action().to_string());
        let left = successor.tasks.items().map(|item| item.atom().to_string());
        step.into_iter().chain(left).collect::<Vec<_>>().join(" ")
    });
    words.collect()
}

#[test]
fn a_method_for_a_narrower_type_does_only_such_tasks() {
    assert_eq!(next(Atom::new("tend", ["hall"])), ["", "(close hall)"]);
    assert_eq!(
        next(Atom::new("tend", ["gate"])),
        ["(close gate)", "(close gate)"]
    );
}

#[test]
fn an_action_with_an_argument_of_another_type_cannot_be_executed() {
    assert_eq!(next(Atom::new("close", ["gate"])), ["(close gate)"]);
    assert_eq!(next(Atom::new("close", ["hall"])), [""; 0]);
}

#[test]
fn a_task_with_an_argument_of_another_type_cannot_be_done() {
    assert_eq!(next(Atom::new("knock", ["gate"])), [""]);
    assert_eq!(next(Atom::new("knock", ["hall"])), [""; 0]);
}

#[test]
fn an_object_that_nobody_has_declared_may_be_anything() {
    assert_eq!(next(Atom::new("knock", ["somewhere"])), [""]);
}
