//! What is written is read again to the same.

use proptest::prelude::*;

use crate::language::tests::{AREA, NODE, SMALL};
use crate::language::{parse_domain, parse_problem, write_domain, write_problem};
use crate::model::arbitrary::{Choices, domain, instance};
use crate::model::{Clause, Domain, Instance, Parameter, Pattern, Symbol, Term};

#[track_caller]
fn read(text: &str) -> Domain {
    parse_domain(text).unwrap_or_else(|errors| panic!("{errors:#?}\n{text}"))
}

#[track_caller]
fn read_instance(text: &str, domain: &Domain) -> Instance {
    parse_problem(text, domain).unwrap_or_else(|errors| panic!("{errors:#?}\n{text}"))
}

#[test]
fn the_domains_of_the_museum_are_read_again_to_the_same() {
    for text in [AREA, NODE, SMALL] {
        let domain = read(text);
        assert_eq!(read(&write_domain(&domain)), domain);
    }
}

#[test]
fn a_domain_is_written_as_a_person_would() {
    let text = "(define (domain lamps)
  (:requirements :typing :hierarchy :method-preconditions :negative-preconditions :action-costs)
  (:types
    lamp - object)
  (:predicates
    (lit ?l - lamp))
  (:functions
    (total-cost) - number)
  (:task light :parameters (?l - lamp))
  (:method already
    :parameters (?l - lamp)
    :task (light ?l)
    :precondition (lit ?l)
    :ordered-subtasks ())
  (:method now
    :parameters (?l - lamp)
    :task (light ?l)
    :precondition (not (lit ?l))
    :ordered-subtasks (switch ?l))
  (:action switch
    :parameters (?l - lamp)
    :precondition (not (lit ?l))
    :effect (and (lit ?l) (increase (total-cost) 2.5))))
";
    assert_eq!(write_domain(&read(text)), text);
}

#[test]
fn an_inner_variable_never_takes_the_name_of_one_that_is_spoken_of() {
    let mut domain = read(SMALL);
    let method = &mut domain.methods[1];
    let at = |variable| {
        let name = Symbol::from("at");
        let args = vec![Term::Variable(variable)];
        Clause::Fact(true, Pattern { name, args })
    };
    // Of the name of parameter 1, which no text could then speak of.
    let variable = Parameter {
        name: method.parameters[1].name.clone(),
        kind: Symbol::from("room"),
    };
    let body = vec![at(1), at(4)];
    method.precondition = vec![Clause::Exists(vec![variable], body.clone())];
    let found = read(&write_domain(&domain));
    let [Clause::Exists(variables, found)] = &found.methods[1].precondition[..] else {
        panic!("{found:#?}");
    };
    assert_eq!(*found, body);
    assert_eq!(variables[0].name, Symbol::from("?a-2"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn a_random_domain_and_a_problem_of_it_are_read_again_to_the_same(
        choices in prop::collection::vec(any::<u16>(), 0..400),
    ) {
        let mut choices = Choices::new(&choices);
        let domain = domain(&mut choices);
        let instance = instance(&domain, &mut choices);
        prop_assert_eq!(read(&write_domain(&domain)), domain.clone());
        prop_assert_eq!(read_instance(&write_problem(&instance), &domain), instance);
    }
}
