//! Faults as they are shown.

use super::{SMALL, small};
use crate::language::{Spelling, excerpt, parse_domain, parse_problem, report};
use crate::model::Symbol;

#[test]
fn a_fault_is_shown_with_its_line_and_a_marker_under_the_word() {
    let text = SMALL
        .replace("(at ?p - place)", "(at ?p - plase)")
        .replace("(length ?d)))", "(lenght ?d)))");
    let errors = parse_domain(&text).unwrap_err();
    assert_eq!(
        report("small.hddl", &text, &errors),
        "small.hddl:5:25: type `plase` is not declared; did you mean `place`?
  |   (:predicates (at ?p - plase) (joins ?a ?b - room ?d - door))
  |                         ^^^^^
small.hddl:14:64: `lenght` is not a declared function; did you mean `length`?
  |     :effect (and (not (at ?a)) (at ?b) (increase (total-cost) (lenght ?d)))))
  |                                                                ^^^^^^"
    );
}

#[test]
fn faults_are_shown_in_the_order_of_the_text() {
    let text = SMALL
        .replace("(at ?p - place)", "(at ?p - plase)")
        .replace("(at ?b)", "(at ?c)");
    let mut errors = parse_domain(&text).unwrap_err();
    let shown = report("f", &text, &errors);
    errors.reverse();
    assert_eq!(report("f", &text, &errors), shown);
}

#[test]
fn tabs_keep_the_marker_in_its_place() {
    let shown = excerpt("(a)\n\t\t(at ?c)", 2, 7).unwrap();
    assert_eq!(shown, "  |   (at ?c)\n  |       ^^");
}

#[test]
fn of_a_long_line_what_stands_around_the_place_is_shown() {
    let text = format!("{} wrong) {}", "word ".repeat(1000), "more ".repeat(1000));
    let shown = excerpt(&text, 1, 5002).unwrap();
    let [source, marker] = shown.lines().collect::<Vec<_>>()[..] else {
        panic!("{shown}");
    };
    assert!(
        source.starts_with("  | … ") && source.ends_with(" …"),
        "{shown}"
    );
    assert!(source.chars().count() < 120, "{shown}");
    let at = marker.find('^').unwrap();
    let marked: String = source.chars().skip(at).take(marker.len() - at).collect();
    assert_eq!(marked, "wrong");
}

#[test]
fn what_would_confuse_a_terminal_is_not_shown() {
    let text = SMALL.replace("(at ?b)", "(\u{1b}[31mat ?b\u{7})");
    let errors = parse_domain(&text).unwrap_err();
    let shown = report("f", &text, &errors);
    assert!(shown.contains("\u{fffd}[31mat"), "{shown}");
    let control = |letter: char| letter.is_control() && letter != '\n';
    assert!(!shown.contains(control), "{shown:?}");
}

#[test]
fn a_place_beyond_the_text_is_no_reason_to_panic() {
    assert_eq!(excerpt("a", 2, 1), None);
    assert_eq!(excerpt("a", 0, 0), None);
    assert_eq!(excerpt("a", 1, 9), Some("  | a\n  |  ^".to_owned()));
}

#[test]
fn more_faults_than_anyone_reads_are_counted() {
    let facts = "(nowhere hall) ".repeat(5000);
    let text = format!("(define (problem p) (:domain small) (:init {facts}) (:htn))");
    let errors = parse_problem(&text, &small()).unwrap_err();
    let shown = report("f", &text, &errors);
    assert_eq!(shown.lines().count(), 61);
    assert!(shown.ends_with("f: and 980 faults more"), "{shown}");
}

#[test]
fn names_are_spelt_as_where_they_are_declared() {
    let text = SMALL
        .replace("(:action pass", "(:Action PassThrough")
        .replace("(pass ?a ?b ?d)", "(PASSTHROUGH ?a ?b ?d)")
        .replace("hall - room", "Hall - room");
    let spelling = Spelling::of(&[&text, "(define (problem p) (:objects Den DEN2 - room d))"]);
    let domain = parse_domain(&text).unwrap();
    let pass = &domain.methods[1].subtasks[0].name;
    assert_eq!(spelling.step(pass), "PassThrough");
    let object = |name: &str| spelling.object(&Symbol::from(name)).to_owned();
    assert_eq!(
        ["hall", "den", "den2", "d"].map(object),
        ["Hall", "Den", "DEN2", "d"]
    );
    assert_eq!(spelling.method(&domain.methods[1].name), "one-door");
}
