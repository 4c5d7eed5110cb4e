//! What execution models and plans are tried on.

/// A domain that an agent could act on, for execution models and plans.
pub const LEVEL: &str = "(define (domain lamps)
  (:requirements :typing :hierarchy)
  (:types lamp room - object)
  (:constants hall - room)
  (:predicates (lit ?l - lamp) (in ?l - lamp ?r - room) (hand-on ?l - lamp))
  (:functions (total-cost) - number (watts ?l - lamp) - number)
  (:task light :parameters (?l - lamp))
  (:method already :parameters (?l - lamp) :task (light ?l) :precondition (lit ?l)
    :ordered-subtasks ())
  (:method now :parameters (?l - lamp) :task (light ?l) :precondition (not (lit ?l))
    :ordered-subtasks (and (switch ?l) (light ?l)))
  (:action switch :parameters (?l - lamp) :precondition (in ?l hall)
    :effect (and (lit ?l) (increase (total-cost) (watts ?l))))
  (:action resume-switch :parameters (?l - lamp) :precondition (hand-on ?l)
    :effect (and (lit ?l) (not (hand-on ?l)))))";

/// A problem of it.
pub const PROBLEM: &str = "(define (problem two) (:domain lamps) (:objects l1 l2 - lamp)
  (:htn :ordered-subtasks (and (light l1) (light l2)))
  (:init (in l1 hall) (in l2 hall) (= (watts l1) 5) (= (watts l2) 40)))";
