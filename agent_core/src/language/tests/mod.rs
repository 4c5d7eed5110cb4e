//! What a modeller writes, and what is answered.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use super::*;
mod conditions;
mod problems;
mod reports;
use crate::model::{
    Change, Clause, Domain, Effect, FactChange, Number, Parameter, Pattern, Symbol, Term,
};

pub(super) const AREA: &str = include_str!("../../../../maps/museum/area.hddl");
pub(super) const NODE: &str = include_str!("../../../../maps/museum/node.hddl");

/// A domain in which nothing is wrong, to put faults into.
pub(super) const SMALL: &str = "(define (domain small)
  (:requirements :typing :hierarchy)
  (:types place - object room - place door - object)
  (:constants hall - room)
  (:predicates (at ?p - place) (joins ?a ?b - room ?d - door))
  (:functions (total-cost) - number (length ?d - door) - number)
  (:task go :parameters (?r - room))
  (:method stay :parameters (?r - room) :task (go ?r) :precondition (at ?r) :ordered-subtasks ())
  (:method one-door :parameters (?r ?a ?b - room ?d - door) :task (go ?r)
    :precondition (and (at ?a) (joins ?a ?b ?d) (not (= ?a ?r)))
    :ordered-subtasks (and (pass ?a ?b ?d) (go ?r)))
  (:action pass :parameters (?a ?b - room ?d - door)
    :precondition (and (at ?a) (joins ?a ?b ?d))
    :effect (and (not (at ?a)) (at ?b) (increase (total-cost) (length ?d)))))";

/// The faults of [`SMALL`] with one piece replaced.
fn faults_with(piece: &str, replacement: &str) -> Vec<String> {
    assert!(SMALL.contains(piece), "{piece}");
    faults(&SMALL.replace(piece, replacement))
}

fn faults(text: &str) -> Vec<String> {
    let errors = parse_domain_strictly(text).err().unwrap_or_default();
    errors.iter().map(ToString::to_string).collect()
}

/// Exactly one fault, at that place, and its message has these words.
#[track_caller]
fn one_fault(faults: &[String], place: &str, words: &[&str]) {
    assert_eq!(faults.len(), 1, "{faults:#?}");
    assert!(faults[0].starts_with(&format!("{place}: ")), "{faults:#?}");
    for word in words {
        assert!(faults[0].contains(word), "{word} is not in {faults:#?}");
    }
}

fn small() -> Domain {
    parse_domain(SMALL).unwrap()
}

fn room(name: &str) -> Parameter {
    parse_parameter(&format!("{name} - room")).unwrap()
}

fn pattern(name: &str, variables: &[usize]) -> Pattern {
    Pattern {
        name: Symbol::from(name),
        args: variables.iter().copied().map(Term::Variable).collect(),
    }
}

#[test]
fn a_domain_is_read_as_it_is_written() {
    let domain = small();
    assert_eq!(domain.name, Symbol::from("small"));
    assert_eq!(domain.types["room"], Symbol::from("place"));
    assert_eq!(domain.constants["hall"], Symbol::from("room"));
    assert_eq!(domain.predicates["joins"].len(), 3);
    assert_eq!(domain.functions["total-cost"], []);
    let method = &domain.methods[1];
    assert_eq!(method.task, pattern("go", &[0]));
    assert_eq!(
        method.precondition,
        [
            Clause::Fact(true, pattern("at", &[1])),
            Clause::Fact(true, pattern("joins", &[1, 2, 3])),
            Clause::Equal(false, Term::Variable(1), Term::Variable(0)),
        ]
    );
    assert_eq!(
        method.subtasks,
        [pattern("pass", &[1, 2, 3]), pattern("go", &[0])]
    );
    let pass = &domain.operators["pass"];
    assert_eq!(pass.effect.remove, [pattern("at", &[0]).into()]);
    assert_eq!(pass.effect.add, [pattern("at", &[1]).into()]);
    assert_eq!(pass.cost, Number::Function(pattern("length", &[2])));
}

#[test]
fn both_levels_of_the_museum_are_read() {
    let area = parse_domain(AREA).unwrap();
    assert_eq!(area.methods.len(), 6);
    assert_eq!(area.operators.len(), 10);
    // The quantified variable stands beyond the three parameters.
    assert_eq!(
        area.operators["enter"].effect.remove[0].fact,
        pattern("at", &[3])
    );
    let node = parse_domain(NODE).unwrap();
    assert_eq!(node.methods.len(), 10);
    assert_eq!(node.operators.len(), 13);
}

#[test]
fn capitals_and_comments_make_no_difference() {
    let shouted = SMALL
        .to_uppercase()
        .replace("(:ACTION", "; (never read\n(:ACTION");
    assert_eq!(parse_domain(&shouted).unwrap(), small());
}

#[test]
fn a_sign_may_stand_next_to_a_name() {
    let glued = SMALL
        .replace("(?r - room) :task", "(?r -room) :task")
        .replace("(= ?a ?r)", "(=?a ?r)");
    assert_ne!(glued, SMALL);
    assert_eq!(parse_domain(&glued).unwrap(), small());
}

#[test]
fn every_fault_is_reported_at_its_place() {
    let text = SMALL
        .replace("(at ?p - place)", "(at ?p - plase)")
        .replace("(and (pass ?a ?b ?d)", "(and (pass ?a ?b)")
        .replace("(length ?d)))", "(lenght ?d)))");
    let faults = faults(&text);
    assert_eq!(faults.len(), 3, "{faults:#?}");
    assert_eq!(
        faults[0],
        "5:25: type `plase` is not declared; did you mean `place`?"
    );
    assert_eq!(
        faults[1],
        "11:29: `pass` takes 3 argument(s) and is given 2"
    );
    assert_eq!(
        faults[2],
        "14:64: `lenght` is not a declared function; did you mean `length`?"
    );
}

#[test]
fn a_misspelt_name_is_reported_with_the_name_that_was_meant() {
    let words = |piece, replacement| faults_with(piece, replacement);
    let meant = |name: &str| format!("did you mean `{name}`?");
    one_fault(
        &words(":hierarchy)", ":hierarchie)"),
        "2:26",
        &[&meant(":hierarchy")],
    );
    one_fault(
        &words("(joins ?a ?b ?d) (not", "(jions ?a ?b ?d) (not"),
        "10:33",
        &[&meant("joins")],
    );
    one_fault(
        &words("(go ?r)))", "(og ?r)))"),
        "11:45",
        &["a declared task or action"],
    );
    one_fault(
        &words("(:requirements", "(:requirement"),
        "2:3",
        &[&meant(":requirements")],
    )
}

#[test]
fn what_is_declared_twice_is_refused() {
    for (piece, twice) in [
        ("(at ?p - place)", "(at ?p - place) (at ?p - place)"),
        (
            "(total-cost) - number",
            "(total-cost) - number (total-cost) - number",
        ),
        ("door - object)", "door - object door - place)"),
        ("hall - room", "hall hall - room"),
        ("(:task go", "(:task go :parameters (?r - room)) (:task go"),
        ("(:method one-door", "(:method stay"),
        ("(?r ?a ?b - room", "(?r ?a ?b ?a - room"),
    ] {
        let faults = faults_with(piece, twice);
        assert!(
            faults.len() == 1 && faults[0].ends_with("is declared twice"),
            "{twice}: {faults:#?}"
        );
    }
}

#[test]
fn a_name_is_a_task_or_an_action_but_not_both() {
    let faults = faults_with(
        "(:action pass",
        "(:action go :parameters (?r - room)) (:action pass",
    );
    one_fault(&faults, "12:12", &["`go` is both a task and an action"]);
}

#[test]
fn an_argument_of_another_type_is_refused_but_a_wider_one_is_not() {
    one_fault(
        &faults_with("(at ?r) :ordered", "(joins ?r hall ?r) :ordered"),
        "8:84",
        &["`?r` is of type room, but `joins` takes door there"],
    );
    // A place may happen to be a room.
    assert_eq!(
        faults_with(
            "(:method stay :parameters (?r - room)",
            "(:method stay :parameters (?r - place)"
        ),
        [""; 0]
    );
}

#[test]
fn a_variable_or_constant_that_nobody_declared_is_refused() {
    one_fault(
        &faults_with("(at ?b)", "(at ?c)"),
        "14:36",
        &["`?c` is not declared"],
    );
    one_fault(
        &faults_with("(at ?b)", "(at b)"),
        "14:36",
        &["did you mean `?b`?"],
    );
    one_fault(
        &faults_with("(at ?b)", "(at hal)"),
        "14:36",
        &["did you mean `hall`?"],
    );
}

#[test]
fn a_task_that_no_method_does_is_refused() {
    let faults = faults_with("(:task go", "(:task fly :parameters ()) (:task go");
    one_fault(&faults, "7:10", &["no method does the task `fly`"]);
}

#[test]
fn types_in_a_circle_are_refused() {
    let faults = faults_with("place - object", "place - room");
    assert_eq!(faults.len(), 2, "{faults:#?}");
    assert!(
        faults[0].contains("`place` stands above itself"),
        "{faults:#?}"
    );
}

#[test]
fn what_is_not_supported_is_named_with_its_place() {
    let cases = [
        ("(at ?r) :ordered", "(< (length ?r) 3) :ordered", "`<`"),
        (
            "(at ?r) :ordered",
            "(= (length ?r) 3) :ordered",
            "`= of numbers",
        ),
        (
            "(at ?r) :ordered",
            "(preference p (at ?r)) :ordered",
            "`preference`",
        ),
        ("(at ?b)", "(or (at ?b) (at ?a))", "`or in an effect`"),
        ("(at ?b)", "(not (and (at ?b)))", "`not of anything"),
        ("(at ?b)", "(decrease (total-cost) 1)", "`decrease`"),
        ("(at ?b)", "(assign (length ?d) 1)", "`assign`"),
    ];
    for (piece, replacement, what) in cases {
        let faults = faults_with(piece, replacement);
        assert!(
            faults.len() == 1 && faults[0].contains("not supported") && faults[0].contains(what),
            "{replacement}: {faults:#?}"
        );
    }
}

#[test]
fn what_is_only_a_slip_is_refused_only_when_reading_strictly() {
    for (piece, slip) in [
        ("(:task go", "(:task fly :parameters ()) (:task go"),
        ("(:method one-door", "(:method stay"),
        (":hierarchy)", ":hierarchie)"),
        ("place - object", "place - thing"),
        ("(at ?r) :ordered", "(joins ?r hall ?r) :ordered"),
        ("hall - room", "hall hall - room"),
    ] {
        assert_eq!(faults_with(piece, slip).len(), 1, "{slip}");
        assert!(parse_domain(&SMALL.replace(piece, slip)).is_ok(), "{slip}");
    }
}

#[test]
fn subtasks_without_an_order_are_refused() {
    one_fault(
        &faults_with(":ordered-subtasks (and (pass", ":subtasks (and (pass"),
        "11:5",
        &["partially ordered subtasks are not supported; write :ordered-subtasks"],
    );
    let loose = faults_with(
        ":ordered-subtasks (and (pass ?a ?b ?d) (go ?r))",
        ":subtasks (and (t1 (pass ?a ?b ?d)) (t2 (go ?r)) (t3 (go ?r)))
         :ordering (and (< t1 t2) (< t1 t3))",
    );
    let which = "which comes first, `(go ?r)` or `(go ?r)`";
    one_fault(&loose, "12:10", &["partially ordered", which]);
}

#[test]
fn subtasks_whose_order_is_spelt_out_are_read_in_that_order() {
    let spelt = SMALL.replace(
        ":ordered-subtasks (and (pass ?a ?b ?d) (go ?r))",
        ":subtasks (and (last (go ?r)) (first (pass ?a ?b ?d))) :ordering (< first last)",
    );
    assert_eq!(parse_domain(&spelt).unwrap(), small());
    let single = SMALL.replace(":ordered-subtasks ()", ":subtasks (and)");
    assert_eq!(parse_domain(&single).unwrap(), small());
}

#[test]
fn an_order_in_a_circle_is_refused() {
    let faults = faults_with(
        ":ordered-subtasks (and (pass ?a ?b ?d) (go ?r))",
        ":subtasks (and (a (go ?r)) (b (pass ?a ?b ?d))) :ordering (and (< a b) (< b a))",
    );
    one_fault(&faults, "11:53", &["in a circle"]);
}

#[test]
fn a_missing_parenthesis_is_found_in_the_section_that_lacks_it() {
    let faults = faults_with(":ordered-subtasks ())", ":ordered-subtasks ()");
    one_fault(&faults, "8:3", &["not closed before the next `(:method`"]);
}

#[test]
fn a_parenthesis_too_many_is_found() {
    let faults = faults_with(":ordered-subtasks ())", ":ordered-subtasks ())))");
    assert!(
        faults.iter().any(|fault| fault.contains("closes nothing")),
        "{faults:#?}"
    );
}

#[test]
fn a_hostile_depth_is_refused() {
    let faults = faults(&"(".repeat(1_000_000));
    one_fault(&faults, "1:201", &["200 parentheses deep"]);
}

#[test]
fn goals_and_reports_are_read() {
    assert_eq!(parse_atom(" (AT n1) ").unwrap().to_string(), "(at n1)");
    assert_eq!(parse_atom("(speak 30)").unwrap().to_string(), "(speak 30)");
    let tasks = parse_tasks("(and (show n2) (show n12))").unwrap();
    assert_eq!(format!("{tasks:?}"), "[(show n2), (show n12)]");
    assert_eq!(parse_tasks("(go n40)").unwrap().len(), 1);
    for text in ["(open d)", "(not (open d))", "(= (gap arc5 n6) 3.2)"] {
        assert_eq!(parse_fact_change(text).unwrap().to_string(), text);
    }
    let set = parse_fact_change("(= (gap arc5 n6) 3.2)").unwrap();
    assert!(matches!(set, FactChange::Set(_, 3.2)));
}

#[test]
fn pieces_that_are_no_goal_or_report_are_refused() {
    for text in [
        "",
        "at",
        "(at ?n)",
        "(at n1",
        "(at n1) (at n2)",
        "()",
        "((at) n1)",
        "(3 at)",
    ] {
        assert!(parse_atom(text).is_err(), "{text}");
    }
    for text in ["(and)", "(and go)", "(and (go n1) n2)"] {
        assert!(parse_tasks(text).is_err(), "{text}");
    }
    for text in [
        "(not)",
        "(= (gap a) nan)",
        "(= (gap a) 1e999)",
        "(= 3 (gap a))",
        "(= (gap a))",
    ] {
        assert!(parse_fact_change(text).is_err(), "{text}");
    }
}

#[test]
fn pieces_of_an_execution_model_are_read_with_the_variables_of_their_action() {
    let parameters = [room("?a"), room("?b")];
    assert_eq!(
        parse_pattern("(resume-pass ?b hall)", &parameters)
            .unwrap()
            .args,
        [Term::Variable(1), Term::Constant(Symbol::from("hall"))]
    );
    assert_eq!(
        parse_literal("(not (= ?a ?b))", &parameters).unwrap(),
        Clause::Equal(false, Term::Variable(0), Term::Variable(1))
    );
    let texts = [
        "(at ?b)",
        "(not (at ?a))",
        "(forall (?x - place) (not (at ?x)))",
    ];
    assert_eq!(
        parse_effects(&texts, &parameters, &small()).unwrap(),
        Effect {
            remove: vec![
                pattern("at", &[0]).into(),
                Change {
                    over: vec![Parameter {
                        name: Symbol::from("?x"),
                        kind: Symbol::from("place"),
                    }],
                    when: Vec::new(),
                    fact: pattern("at", &[2]),
                },
            ],
            add: vec![pattern("at", &[1]).into()],
        }
    );
    let wrong = parse_pattern("(resume-pass ?bb)", &parameters).unwrap_err();
    assert!(
        wrong
            .message
            .contains("`?bb` is not declared; did you mean"),
        "{wrong}"
    );
    assert!(parse_effects(&["(increase (total-cost) 3)"], &parameters, &small()).is_err());
    assert!(parse_parameter("?a - area ?b").is_err());
    assert!(parse_parameter("a - area").is_err());
}

#[test]
fn numbers_are_read_with_their_signs() {
    let parameters = [room("?a")];
    let read = |text| parse_number(text, &parameters);
    assert_eq!(read("30").unwrap(), Number::Constant(30.0));
    assert_eq!(
        read("(+ 60 (* 4 (length ?a)))").unwrap(),
        Number::Sum(vec![
            Number::Constant(60.0),
            Number::Product(vec![
                Number::Constant(4.0),
                Number::Function(pattern("length", &[0]))
            ])
        ])
    );
    assert_eq!(
        read("(- (/ 1 2) 3)").unwrap(),
        Number::Difference(
            Box::new(Number::Quotient(
                Box::new(Number::Constant(1.0)),
                Box::new(Number::Constant(2.0))
            )),
            Box::new(Number::Constant(3.0))
        )
    );
    for text in [
        "",
        "inf",
        "nan",
        "1e400",
        "(- 1)",
        "(/ 1 0)",
        "(+)",
        "x",
        "(length ?b)",
        "1 2",
    ] {
        assert!(read(text).is_err(), "{text}");
    }
}
