//! Small problems written for the purpose.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64};

use agent_core::language::{parse_domain, parse_problem};

use super::search;
use crate::compile::Compiled;
use crate::control::{Control, Outcome};
use crate::plan::Solution;

const DOMAIN: &str = "(define (domain workshop)
  (:predicates (sharp) (left) (right))
  (:task choose :parameters ())
  (:task sharpen :parameters ())
  (:method go-left :parameters () :task (choose) :ordered-subtasks (and (turn-left)))
  (:method go-right :parameters () :task (choose) :ordered-subtasks (and (turn-right)))
  (:method by-hand :parameters () :task (sharpen) :ordered-subtasks (and (file)))
  (:method by-machine :parameters () :task (sharpen) :precondition (left) :ordered-subtasks (and (grind)))
  (:action turn-left :parameters () :precondition () :effect (left))
  (:action turn-right :parameters () :precondition () :effect (right))
  (:action file :parameters () :precondition () :effect (sharp))
  (:action grind :parameters () :precondition () :effect (sharp))
  (:action cut :parameters () :precondition (sharp) :effect (not (sharp))))";

/// How the search for these tasks ends.
fn ended(tasks: &str) -> Outcome {
    let problem = format!(
        "(define (problem one) (:domain workshop)
           (:htn :ordered-subtasks (and {tasks})) (:init (sharp)))"
    );
    let domain = parse_domain(DOMAIN).expect("the domain is right");
    let instance = parse_problem(&problem, &domain).expect("the problem is right");
    let compiled = Arc::new(Compiled::new(&domain, &instance).expect("they fit"));
    let outcome = search(
        &compiled,
        &Control {
            stop: &AtomicBool::new(false),
            deadline: None,
            memory_limit_bytes: 1 << 24,
            expanded: &AtomicU64::new(0),
            seed: 1,
        },
    );
    if let Outcome::Found(choices) = &outcome {
        let solution = Solution::new(&compiled, choices).expect("choices make a plan");
        let mut text = Vec::new();
        solution.write(&mut text).expect("memory can be written to");
        let text = String::from_utf8(text).expect("names are text");
        plan_checker::check(DOMAIN, &problem, &text).expect("the plan is right");
    }
    outcome
}

#[test]
fn what_one_action_takes_a_task_between_can_bring_back() {
    let outcome = ended("(choose) (cut) (sharpen) (cut)");
    assert!(matches!(outcome, Outcome::Found(_)), "{outcome:?}");
}

#[test]
fn what_one_action_takes_is_gone_for_the_next() {
    let outcome = ended("(choose) (cut) (cut) (sharpen)");
    assert_eq!(outcome, Outcome::Unsolvable);
}
