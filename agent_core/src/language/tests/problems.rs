//! Problems: objects, what holds at first, and what is to be done.

use super::{one_fault, small};
use crate::language::{parse_domain, parse_problem};
use crate::model::{Atom, Clause, Instance, Pattern, Symbol, Term};

const PROBLEM: &str = "(define (problem one) (:domain small)
  (:objects Den - room d1 d2 - door)
  (:htn :parameters (?r - room)
    :subtasks (and (t2 (go ?r)) (t1 (go hall)))
    :ordering (and (< t1 t2))
    :constraints (not (= ?r hall)))
  (:init (at den) (joins den hall d1) (= (length d1) 3) (= (length d2) 4.5))
  (:goal (and (at den) (not (at hall))))
  (:metric minimize (total-cost)))";

fn faults(text: &str) -> Vec<String> {
    let errors = parse_problem(text, &small()).err().unwrap_or_default();
    errors.iter().map(ToString::to_string).collect()
}

fn faults_with(piece: &str, replacement: &str) -> Vec<String> {
    assert!(PROBLEM.contains(piece), "{piece}");
    faults(&PROBLEM.replace(piece, replacement))
}

fn read(text: &str) -> Instance {
    parse_problem(text, &small()).unwrap_or_else(|errors| panic!("{errors:#?}"))
}

fn constant(name: &str) -> Term {
    Term::Constant(Symbol::from(name))
}

#[test]
fn a_problem_is_read_as_it_is_written() {
    let problem = read(PROBLEM);
    assert_eq!(problem.name, Symbol::from("one"));
    assert_eq!(problem.domain, Symbol::from("small"));
    assert_eq!(problem.objects["den"], Symbol::from("room"));
    assert_eq!(problem.objects.len(), 3);
    assert!(
        problem
            .init
            .holds(&Atom::new("joins", ["den", "hall", "d1"]))
    );
    assert_eq!(problem.init.facts().count(), 2);
    assert_eq!(problem.init.value(&Atom::new("length", ["d2"])), Some(4.5));
    assert_eq!(problem.parameters.len(), 1);
    assert_eq!(
        problem.constraints,
        [Clause::Equal(false, Term::Variable(0), constant("hall"))]
    );
    let go = |argument| Pattern {
        name: Symbol::from("go"),
        args: vec![argument],
    };
    assert_eq!(problem.tasks, [go(constant("hall")), go(Term::Variable(0))]);
    let at = |name| Pattern {
        name: Symbol::from("at"),
        args: vec![constant(name)],
    };
    assert_eq!(
        problem.goal,
        [
            Clause::Fact(true, at("den")),
            Clause::Fact(false, at("hall"))
        ]
    );
}

#[test]
fn the_order_of_sections_does_not_matter() {
    let init = "(:init (at den) (joins den hall d1) (= (length d1) 3) (= (length d2) 4.5))";
    let moved = PROBLEM
        .replace(init, "")
        .replace("(:objects", &format!("{init} (:objects"));
    assert_eq!(read(&moved), read(PROBLEM));
}

#[test]
fn a_single_task_needs_neither_order_nor_name() {
    for network in [
        ":subtasks (go hall)",
        ":tasks (and (go hall))",
        ":ordered-tasks (t1 (go hall))",
    ] {
        let text = format!("(define (problem p) (:domain small) (:init) (:htn {network}))");
        assert_eq!(read(&text).tasks.len(), 1, "{network}");
    }
}

#[test]
fn names_that_nobody_declared_are_refused_at_their_places() {
    let meant = ["did you mean `den`?"];
    one_fault(
        &faults_with(":init (at den)", ":init (at dens)"),
        "7:14",
        &meant,
    );
    one_fault(
        &faults_with("(and (at den)", "(and (at dens)"),
        "8:19",
        &meant,
    );
    one_fault(
        &faults_with("(go hall)", "(og hall)"),
        "4:38",
        &["`og` is not"],
    );
    one_fault(
        &faults_with("d2 - door", "d2 - dor"),
        "2:32",
        &["did you mean `door`?"],
    );
}

#[test]
fn constants_of_the_domain_may_be_declared_again() {
    let again = PROBLEM.replace("Den - room", "Den hall - room");
    assert_eq!(read(&again), read(PROBLEM));
    let otherwise = faults_with("Den - room", "Den - room hall - door");
    one_fault(&otherwise, "2:24", &["`hall` is of type room already"]);
}

#[test]
fn a_problem_without_tasks_is_refused() {
    let text = "(define (problem p) (:domain small) (:init) (:goal (at hall)))";
    one_fault(&faults(text), "1:1", &["add `(:htn"]);
}

#[test]
fn initial_tasks_without_an_order_are_refused() {
    let faults = faults_with(":ordering (and (< t1 t2))", "");
    one_fault(&faults, "4:5", &["partially ordered"]);
}

#[test]
fn a_domain_is_no_problem_and_a_problem_no_domain() {
    one_fault(&faults(super::SMALL), "1:9", &["this is a domain"]);
    let errors = parse_domain(PROBLEM).unwrap_err();
    assert!(
        errors[0].message.contains("this is a problem"),
        "{errors:?}"
    );
}
