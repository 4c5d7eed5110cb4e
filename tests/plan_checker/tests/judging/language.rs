//! What a domain may say, each by a plan that it allows and one that it does not.

use plan_checker::Kind::{self, *};

use crate::kinds;

/// Judges a plan of one action, `(act a b)`, or of none, for a domain with this precondition and
/// effect and a problem with these facts and this goal.
fn acting(condition: &str, effect: &str, facts: &str, goal: &str) -> Vec<Kind> {
    let domain = format!(
        "(define (domain d)
           (:types big small - thing other - object)
           (:constants k - big)
           (:predicates (p ?x - thing) (q ?x ?y - (either big other)) (r))
           (:action act :parameters (?x - big ?y - object)
             :precondition {condition} :effect {effect}))"
    );
    let problem = format!(
        "(define (problem e) (:domain d) (:objects a b - big s - small o - other)
           (:htn :tasks (act a b)) (:init {facts}) (:goal {goal}))"
    );
    kinds(&domain, &problem, "==>\n1 Act A b\nroot 1\n<==")
}

#[test]
fn conditions_mean_what_they_say() {
    let rows = [
        ("(p ?x)", "(p a)", "(p b)"),
        ("(not (p ?x))", "(p b)", "(p a)"),
        ("(or (p ?x) (r))", "(r)", "(p b)"),
        ("(not (or (p ?x) (r)))", "(p b)", "(r)"),
        ("(not (and (p ?x) (r)))", "(r)", "(r) (p a)"),
        ("(imply (p ?x) (r))", "(r) (p a)", "(p a)"),
        ("(imply (r) (p ?x))", "", "(r)"),
        (
            "(forall (?z - big) (p ?z))",
            "(p a) (p b) (p k)",
            "(p a) (p b) (p s)",
        ),
        (
            "(not (forall (?z - big) (p ?z)))",
            "(p a)",
            "(p a) (p b) (p k)",
        ),
        ("(exists (?z - small) (p ?z))", "(p s)", "(p a)"),
        ("(not (exists (?z) (p ?z)))", "(r)", "(p a)"),
        (
            "(forall (?z - (either small other)) (imply (= ?z o) (q ?x ?z)))",
            "(q a o)",
            "(q b o)",
        ),
        (
            "(exists (?z ?w - big) (and (q ?z ?w) (not (= ?z ?w)) (p ?w)))",
            "(q a a) (q a k) (p k) (p a)",
            "(q a a) (p a)",
        ),
        (
            "(exists (?z - big) (forall (?w - big) (q ?z ?w)))",
            "(q b a) (q b b) (q b k) (q a a)",
            "(q b a) (q a b) (q k k)",
        ),
        ("(and (not (= ?x ?y)) (p k) (= ?x ?x))", "(p k)", "(p a)"),
        ("()", "", "-"),
    ];
    for (condition, holds, does_not) in rows {
        let found = acting(condition, "(r)", holds, "(r)");
        assert_eq!(found, [], "{condition} with {holds}");
        if does_not != "-" {
            let found = acting(condition, "(r)", does_not, "(r)");
            assert_eq!(found, [Precondition], "{condition} with {does_not}");
        }
    }
}

#[test]
fn effects_do_what_they_say() {
    let rows = [
        ("(p ?x)", "", "(p a)", "(p b)"),
        ("(not (p ?x))", "(p a) (p b)", "(not (p a))", "(not (p b))"),
        // What is both deleted and added is true.
        ("(and (p ?x) (not (p ?x)))", "", "(p a)", "(not (p a))"),
        ("(when (p ?x) (r))", "(p a)", "(r)", "(not (r))"),
        ("(when (p ?x) (r))", "(p b)", "(not (r))", "(r)"),
        (
            "(forall (?z - big) (when (q ?z ?x) (p ?z)))",
            "(q b a) (q a b)",
            "(and (p b) (not (p a)) (not (p k)))",
            "(p a)",
        ),
        // All conditions are looked at before anything changes.
        ("(and (p ?x) (when (p ?x) (r)))", "", "(not (r))", "(r)"),
        (
            "(forall (?z - thing) (p ?z))",
            "",
            "(and (p s) (p a) (p k))",
            "(r)",
        ),
        ("()", "(r)", "(r)", "(not (r))"),
    ];
    for (effect, facts, holds, does_not) in rows {
        assert_eq!(
            acting("()", effect, facts, holds),
            [],
            "{effect} gives {holds}"
        );
        let found = acting("()", effect, facts, does_not);
        assert_eq!(found, [Goal], "{effect} does not give {does_not}");
    }
}

const VARIABLES: &str = "(define (domain d)
    (:types colour thing)
    (:predicates (has ?t - thing ?c - colour))
    (:task paint :parameters (?t - thing ?c - colour))
    (:task twice :parameters (?s ?t - thing))
    (:method m :parameters (?t - thing ?c ?old - colour) :task (paint ?t ?c)
      :precondition (has ?t ?old)
      :constraints (and (not (= ?old ?c)))
      :ordered-subtasks (act ?t ?c))
    (:method same :parameters (?t - thing ?c - colour) :task (twice ?t ?t)
      :subtasks (and (x (paint ?t ?c)) (y (paint ?t ?c))))
    (:action act :parameters (?t - thing ?c - colour) :effect ()))";

fn painting(facts: &str, htn: &str, plan: &str) -> Vec<Kind> {
    let problem = format!(
        "(define (problem e) (:domain d) (:objects red green - colour a b - thing)
           (:htn {htn}) (:init {facts}))"
    );
    kinds(VARIABLES, &problem, &format!("==>\n{plan}\n<=="))
}

#[test]
fn variables_that_only_conditions_name_are_searched_for() {
    let htn = ":tasks (paint a red)";
    let plan = "1 act a red\nroot 2\n2 paint a red -> m 1";
    assert_eq!(painting("(has a red) (has a green)", htn, plan), []);
    assert_eq!(
        painting("(has a red) (has b green)", htn, plan),
        [MethodPrecondition]
    );
}

#[test]
fn the_problem_s_tasks_may_have_variables() {
    let htn = ":parameters (?t - thing) :tasks (paint ?t red) :constraints (not (= ?t b))";
    let facts = "(has a green) (has b green)";
    let plan = |thing| format!("1 act {thing} red\nroot 2\n2 paint {thing} red -> m 1");
    assert_eq!(painting(facts, htn, &plan("a")), []);
    assert_eq!(painting(facts, htn, &plan("b")), [WrongRoots]);
}

#[test]
fn a_variable_that_is_repeated_has_one_value() {
    let facts = "(has a green) (has b green)";
    let htn = ":parameters (?s ?t - thing) :tasks (twice ?s ?t)";
    let plan = |first, second, colour| {
        format!(
            "1 act a red\n2 act a {colour}\nroot 5\n5 twice {first} {second} -> same 3 4\n\
             3 paint a red -> m 1\n4 paint a {colour} -> m 2"
        )
    };
    assert_eq!(painting(facts, htn, &plan("a", "a", "red")), []);
    assert_eq!(
        painting(facts, htn, &plan("a", "b", "red")),
        [NotAnInstance]
    );
    assert_eq!(
        painting(facts, htn, &plan("a", "a", "green")),
        [NotAnInstance]
    );
}

#[test]
fn a_partial_order_allows_all_its_linearisations_and_no_more() {
    let domain = "(define (domain d) (:predicates (p))
        (:task t :parameters ())
        (:task u :parameters ())
        (:method m :parameters () :task (t)
          :subtasks (and (a (a)) (b (b)) (u (u))) :ordering (< a b))
        (:method n :parameters () :task (u) :precondition (p) :subtasks (c))
        (:action a :parameters () :effect (p))
        (:action b :parameters () :effect (not (p)))
        (:action c :parameters () :effect ()))";
    let problem = "(define (problem e) (:domain d) (:htn :tasks (t)) (:init))";
    let judged = |actions: &str| {
        let plan = format!("==>\n{actions}\nroot 9\n9 t -> m 1 2 8\n8 u -> n 3\n<==");
        kinds(domain, problem, &plan)
    };
    assert_eq!(judged("1 a\n2 b\n3 c"), []);
    assert_eq!(judged("1 a\n3 c\n2 b"), []);
    assert_eq!(judged("3 c\n1 a\n2 b"), [MethodPrecondition]);
    assert_eq!(judged("2 b\n1 a\n3 c"), [WrongOrder]);
}

#[test]
fn costs_are_what_the_domain_adds_up() {
    let domain = "(define (domain d) (:types place)
        (:predicates (at ?p - place))
        (:functions (total-cost) - number (length ?a ?b - place) - number)
        (:action go :parameters (?a ?b - place) :precondition (at ?a)
          :effect (and (at ?b) (not (at ?a)) (increase (total-cost) (length ?a ?b))))
        (:action rest :parameters () :effect (increase (total-cost) 2)))";
    let problem = "(define (problem e) (:domain d) (:objects x y - place)
        (:htn :ordered-tasks (and (go x y) (rest) (go y x)))
        (:init (at x) (= (length x y) 5) (= (length y x) 7) (= (total-cost) 0))
        (:metric minimize (total-cost)))";
    let plan = "==>\n1 go x y\n2 rest\n3 go y x\nroot 1 2 3\n<==";
    let report = plan_checker::check(domain, problem, plan).expect("it is right");
    assert_eq!(report.cost, 14.0);
}
