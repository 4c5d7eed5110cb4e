//! Planning and plan execution.

use agent_core::protocol::{Happening, Instruction};
use intermezzo_tests::of_superior;

use super::{ON_ARC5, entering, map_of, on_the_way, parent};

#[test]
fn actions_are_executed_one_after_the_other_until_the_goal_is_reached() {
    let mut parent = on_the_way();
    parent.success(1, &["(not (in area1))", "(in area3)"]);
    assert_eq!(parent.told(), ["execute #2 (enter area3 area5 door3_5)"]);
    parent.success(2, &[]);
    parent.success(3, &[]);
    parent.success(4, &[]);
    assert_eq!(
        parent.told(),
        [
            "execute #3 (enter area5 area7 door5_7)",
            "execute #4 (enter area7 area8 door7_8)",
            "execute #5 (approach n40 area8)",
        ]
    );
    parent.success(5, &["(at n40)"]);
    assert!(parent.said("tour", |what| *what == Happening::GoalSucceeded));
    assert_eq!(parent.running(), None);
}

#[test]
fn after_a_failure_another_plan_is_made_from_the_reported_facts() {
    let mut parent = on_the_way();
    parent.failure(1, &["(not (open door1_3))"], &["(open door1_3)"]);
    assert_eq!(parent.told(), ["execute #2 (enter area1 area2 door1_2)"]);
}

#[test]
fn an_action_that_fails_without_a_word_is_tried_three_times() {
    let mut parent = on_the_way();
    parent.failure(1, &[], &[]);
    parent.failure(2, &[], &[]);
    assert_eq!(
        parent.told(),
        [
            "execute #2 (enter area1 area3 door1_3)",
            "execute #3 (enter area1 area3 door1_3)"
        ]
    );
    parent.failure(3, &[], &[]);
    assert_eq!(parent.told(), ["execute #4 (enter area1 area2 door1_2)"]);
}

#[test]
fn a_goal_that_is_reached_already_needs_no_action() {
    let mut parent = parent();
    parent.goal("here", "(go n1)");
    assert!(parent.told().is_empty());
    assert!(parent.said("here", |what| *what == Happening::GoalSucceeded));
}

#[test]
fn the_record_of_a_suspended_action_is_cleared_when_the_next_action_is_another() {
    let mut child = entering();
    child.instruct(Instruction::Suspend { id: of_superior(1) });
    child.suspended(1, &ON_ARC5);
    child.told();
    child.observe(&["(not (on arc5))", "(at n5)", "(not (left n1))"]);
    child.instruct(Instruction::Resume {
        id: of_superior(1),
        map: Some(map_of("area1")),
    });
    assert_eq!(child.told()[0], "clear #1");
}

#[test]
fn an_executed_action_is_deleted_from_suspended_plans_too() {
    let mut parent = on_the_way();
    parent.emergency("exhibit", "(go n12)");
    parent.suspended(1, &[]);
    // The emergency goes where the tour would have gone.
    assert_eq!(
        parent.told(),
        ["suspend #1", "execute #2 (enter area1 area3 door1_3)"]
    );
    assert_eq!(
        parent.plans("tour")[0][0],
        "(resume-enter area1 area3 door1_3)"
    );
    parent.success(2, &[]);
    assert_eq!(parent.plans("tour")[0][0], "(enter area3 area5 door3_5)");
}

#[test]
fn a_late_report_of_an_action_that_has_ended_changes_nothing() {
    let mut parent = on_the_way();
    parent.success(1, &[]);
    parent.told();
    parent.success(1, &[]);
    parent.failure(1, &[], &[]);
    assert!(parent.told().is_empty());
    assert_eq!(parent.running().as_deref(), Some("tour"));
}

#[test]
fn an_action_whose_protected_state_breaks_is_stopped_and_another_plan_is_followed() {
    let mut parent = on_the_way();
    parent.observe(&["(not (open door1_3))"]);
    assert_eq!(parent.told(), ["suspend #1"]);
    assert!(parent.said("tour", |what| matches!(what, Happening::PlanRevised { .. })));
    parent.suspended(1, &["(in area1)"]);
    assert_eq!(
        parent.told(),
        ["clear #1", "execute #2 (enter area1 area2 door1_2)"]
    );
    assert_eq!(parent.running().as_deref(), Some("tour"));
}

#[test]
fn an_action_that_takes_too_long_is_stopped_and_counts_as_failed() {
    let mut parent = on_the_way();
    let due = agent_core::protocol::Machine::wake_at(&parent.agent).expect("it has a time-out");
    parent.now = due;
    parent.tell(agent_core::protocol::Input::Wake);
    assert_eq!(parent.told(), ["suspend #1"]);
    parent.suspended(1, &["(in area1)"]);
    assert_eq!(parent.told(), ["resume #1"], "once is not for ever");
}
