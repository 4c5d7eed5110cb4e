//! Modifications of belief and plans when an action is suspended.

use agent_core::model::Atom;
use agent_core::protocol::Instruction;
use intermezzo_tests::{Bench, of_superior};

use super::{ON_ARC5, entering, map_of};

/// The child's plans for the goal that its superior has had suspended on arc5.
fn suspended_on_arc5() -> Bench {
    let mut child = entering();
    child.instruct(Instruction::Suspend { id: of_superior(1) });
    assert_eq!(child.told(), ["suspend #1"]);
    child.suspended(1, &ON_ARC5);
    child
}

#[test]
fn the_belief_has_the_effect_of_suspension() {
    let mut child = entering();
    child.instruct(Instruction::Suspend { id: of_superior(1) });
    // Even if the executor reports no fact.
    child.suspended(1, &[]);
    let belief = child.agent.belief();
    assert!(belief.holds(&Atom::new("on", ["arc5"])));
    assert!(belief.holds(&Atom::new("left", ["n1"])));
    assert!(!belief.holds(&Atom::new("at", ["n1"])));
}

#[test]
fn a_plan_that_starts_with_the_suspended_action_resumes_it() {
    let child = suspended_on_arc5();
    let plans = child.plans("superior.1.1");
    assert_eq!(
        plans[0],
        ["(resume-move n1 n6 arc5)", "(pass n6 n10 arc12 door1_3)"]
    );
}

#[test]
fn a_plan_that_starts_otherwise_rolls_back_first() {
    let child = suspended_on_arc5();
    let plans = child.plans("superior.1.1");
    let others: Vec<_> = plans
        .iter()
        .filter(|plan| plan[0] != "(resume-move n1 n6 arc5)")
        .collect();
    assert!(!others.is_empty(), "alternatives were kept: {plans:?}");
    for plan in others {
        assert_eq!(plan[0], "(return n1 arc5)", "{plan:?}");
        assert!(plan[1].starts_with("(move n1 "), "{plan:?}");
    }
}

#[test]
fn a_plan_whose_precondition_fails_is_not_followed() {
    let mut child = suspended_on_arc5();
    // Somebody pushes the robot to n4 meanwhile.
    child.observe(&["(not (on arc5))", "(not (left n1))", "(at n4)"]);
    child.instruct(Instruction::Resume {
        id: of_superior(1),
        map: Some(map_of("area1")),
    });
    let told = child.told();
    assert_eq!(told[0], "clear #1");
    assert!(told[1].starts_with("execute #2 (move n4 "), "{told:?}");
}

#[test]
fn new_plans_are_made_from_the_changed_belief_without_a_rollback() {
    let mut child = suspended_on_arc5();
    // An emergency of the superior's begins on the arc and needs no undoing of what it never began.
    child.execute(2, "(approach n1 area1)", Some(&map_of("area1")));
    assert_eq!(child.told(), ["execute #2 (leave arc5 n1)"]);
}
