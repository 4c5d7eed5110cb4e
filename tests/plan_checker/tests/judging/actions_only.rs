//! Plans that come without their decompositions.

use plan_checker::Kind::{self, *};
use plan_checker::check_sequence;

use crate::{DELIVERY, LETTER, POST, with};

const ACTIONS: &str = "(drive v depot street)\n(load letter v street)\n
    (drive v street shop)\n(unload letter v shop) ; done\n";

fn kind(problem: &str, actions: &str) -> Option<Kind> {
    check_sequence(POST, problem, actions)
        .err()
        .map(|faults| faults[0].kind)
}

#[test]
fn the_actions_of_a_right_plan_are_a_decomposition() {
    assert_eq!(kind(LETTER, ACTIONS), None);
    assert_eq!(kind(LETTER, DELIVERY), None);
}

#[test]
fn actions_that_can_be_done_but_that_no_method_wants_are_refused() {
    let problem = with(
        LETTER,
        "(road depot street)",
        "(road depot street) (road shop depot)",
    );
    let detour = with(
        ACTIONS,
        "(unload",
        "(drive v shop depot)\n(drive v depot street)\n(drive v street shop)\n(unload",
    );
    assert_eq!(kind(&problem, &detour), Some(NotARefinement));
    let longer = format!("{ACTIONS}(drive v shop depot)\n");
    let problem = with(&problem, "(at v shop)", "");
    assert_eq!(kind(&problem, &longer), Some(NotARefinement));
    assert_eq!(kind(&problem, ""), Some(Goal));
}

#[test]
fn actions_that_cannot_be_done_are_refused() {
    let faster = with(ACTIONS, "(drive v depot street)", "");
    assert_eq!(kind(LETTER, &faster), Some(Precondition));
    assert_eq!(kind(LETTER, "(fly v)"), Some(UnknownName));
}

#[test]
fn recursion_to_the_left_comes_to_an_end() {
    let domain = "(define (domain d) (:predicates (p))
        (:task many :parameters ())
        (:method more :parameters () :task (many) :ordered-subtasks (and (many) (one)))
        (:method twice :parameters () :task (many) :ordered-subtasks (and (many) (many)))
        (:method none :parameters () :task (many) :ordered-subtasks ())
        (:action one :parameters () :effect (p))
        (:action two :parameters () :effect (p)))";
    let problem = "(define (problem q) (:domain d) (:htn :subtasks (many)) (:init))";
    assert!(check_sequence(domain, problem, &"(one)\n".repeat(30)).is_ok());
    assert!(check_sequence(domain, problem, "").is_ok());
    assert!(check_sequence(domain, problem, "(one)\n(two)\n").is_err());
}
