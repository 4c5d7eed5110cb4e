//! What must be true of every text. The fuzzing targets share this file.

use agent_core::language::{
    Spelling, parse_atom, parse_domain, parse_domain_strictly, parse_effects, parse_fact_change,
    parse_literal, parse_number, parse_parameter, parse_pattern, parse_problem, parse_tasks,
    report, write_domain, write_problem,
};
use agent_core::model::Domain;

/// The domain that problems and pieces are about; it has something of everything.
pub const DOMAIN: &str = "(define (domain lamps)
  (:requirements :typing :hierarchy :adl)
  (:types lamp room - thing big - lamp)
  (:constants hall - room)
  (:predicates (lit ?l - lamp) (in ?t - thing ?r - room) (dark))
  (:functions (total-cost) - number (watts ?l - lamp) - number)
  (:task light :parameters (?l - (either lamp room)))
  (:method already :parameters (?l - lamp) :task (light ?l) :precondition (lit ?l))
  (:method now :parameters (?l - lamp ?r - room) :task (light ?l)
    :precondition (and (not (lit ?l)) (exists (?o - thing) (or (in ?o ?r) (= ?o ?l))))
    :subtasks (and (b (light ?l)) (a (switch ?l))) :ordering (< a b))
  (:action switch :parameters (?l - lamp) :precondition (imply (dark) (not (lit ?l)))
    :effect (and (lit ?l) (forall (?o - lamp) (when (lit ?o) (not (lit ?o))))
      (increase (total-cost) (* 2 (watts ?l))))))";

/// A domain is read or its faults are told, and what was read can be written.
pub fn domain(text: &str) {
    let _ = Spelling::of(&[text]);
    match parse_domain(text) {
        Ok(domain) => {
            let written = write_domain(&domain);
            match parse_domain(&written) {
                Ok(again) => same(&again, &domain, write_domain),
                // What is nested just within the limit may be written a little deeper.
                Err(errors) => only_too_deep(&errors, &written),
            }
            if let Err(errors) = parse_domain_strictly(text) {
                faults(text, &errors);
            }
        }
        Err(errors) => faults(text, &errors),
    }
}

/// A problem is read or its faults are told, and what was read can be written.
pub fn problem(text: &str, domain: &Domain) {
    match parse_problem(text, domain) {
        Ok(problem) => {
            let written = write_problem(&problem);
            match parse_problem(&written, domain) {
                Ok(again) => same(&again, &problem, write_problem),
                Err(errors) => only_too_deep(&errors, &written),
            }
        }
        Err(errors) => faults(text, &errors),
    }
}

/// Pieces of the language are read or refused.
pub fn pieces(text: &str, domain: &Domain) {
    let parameters = ["?l - lamp", "?r"].map(parse_parameter);
    let parameters: Vec<_> = parameters.into_iter().flatten().collect();
    let _ = parse_parameter(text);
    let _ = parse_atom(text);
    let _ = parse_tasks(text);
    let _ = parse_fact_change(text);
    let _ = parse_pattern(text, &parameters);
    let _ = parse_literal(text, &parameters);
    let _ = parse_effects(&[text], &parameters, domain);
    let _ = parse_number(text, &parameters);
}

/// Equal, but that inner variables may be called otherwise where one hid another; written, that
/// is settled.
fn same<T: PartialEq>(again: &T, first: &T, write: impl Fn(&T) -> String) {
    let settled = write(first).contains("-2") && write(again) == write(first);
    assert!(again == first || settled, "{}", write(first));
}

fn only_too_deep(errors: &[agent_core::language::LanguageError], written: &str) {
    let too_deep = |message: &str| message.contains("parentheses deep");
    let all = errors.iter().all(|error| too_deep(&error.message));
    assert!(all && !errors.is_empty(), "{errors:?}\n{written}");
}

fn faults(text: &str, errors: &[agent_core::language::LanguageError]) {
    assert!(!errors.is_empty(), "refused without a fault");
    assert!(errors.is_sorted(), "{errors:?}");
    let lines = text.matches('\n').count() + 1;
    assert!(
        errors.iter().all(|error| (1..=lines).contains(&error.line)),
        "{errors:?}"
    );
    let shown = report("file", text, errors);
    let control = |letter: char| letter.is_control() && letter != '\n';
    assert!(!shown.contains(control), "{shown:?}");
}
