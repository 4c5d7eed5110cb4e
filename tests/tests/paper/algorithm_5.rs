//! Subplan suspension, on the instruction of a superior.

use agent_core::agent::ResumedBy;
use agent_core::protocol::{Answer, Instruction, Report};
use intermezzo_tests::of_superior;

use super::{ON_ARC5, entering, map_of};

fn suspend(number: u64) -> Instruction {
    Instruction::Suspend {
        id: of_superior(number),
    }
}

fn clear(number: u64) -> Instruction {
    Instruction::Clear {
        id: of_superior(number),
    }
}

fn resume(number: u64) -> Instruction {
    Instruction::Resume {
        id: of_superior(number),
        map: Some(map_of("area1")),
    }
}

#[test]
fn a_suspension_goes_down_and_is_reported_when_the_executor_stands() {
    let mut child = entering();
    assert_eq!(child.instruct(suspend(1)), Answer::Suspending);
    assert_eq!(child.told(), ["suspend #1"]);
    assert!(child.reported().is_empty());
    child.suspended(1, &ON_ARC5);
    assert_eq!(child.reported(), ["#1 suspended"]);
    assert_eq!(
        child.agent.stack().entries()[0].resumed_by,
        ResumedBy::Superior
    );
}

#[test]
fn a_held_goal_does_not_restart_by_itself() {
    let mut child = entering();
    child.instruct(suspend(1));
    child.suspended(1, &ON_ARC5);
    child.told();
    child.observe(&["(not (open door1_2))"]);
    assert!(child.told().is_empty());
    assert_eq!(child.running(), None);
}

#[test]
fn a_resumption_goes_down_and_the_goal_ends_as_if_never_suspended() {
    let mut child = entering();
    child.instruct(suspend(1));
    child.suspended(1, &ON_ARC5);
    assert_eq!(child.instruct(resume(1)), Answer::Accepted);
    assert_eq!(child.told(), ["suspend #1", "resume #1"]);
    child.success(1, &["(not (on arc5))", "(not (left n1))", "(at n6)"]);
    assert_eq!(child.told(), ["execute #2 (pass n6 n10 arc12 door1_3)"]);
    child.success(2, &["(not (at n6))", "(at n10)"]);
    assert_eq!(child.reported(), ["#1 suspended", "#1 success"]);
}

#[test]
fn a_clearance_goes_down_and_may_be_repeated() {
    let mut child = entering();
    child.instruct(suspend(1));
    child.suspended(1, &ON_ARC5);
    child.told();
    assert_eq!(child.instruct(clear(1)), Answer::Accepted);
    assert_eq!(child.told(), ["clear #1"]);
    assert!(child.stacked().is_empty());
    assert!(matches!(child.instruct(clear(1)), Answer::Finished { .. }));
    assert!(child.told().is_empty());
    // Nor is anything wrong with a clearance of what was never there.
    assert_eq!(child.instruct(clear(77)), Answer::Accepted);
}

#[test]
fn clear_takes_a_goal_out_at_depth_two_of_three() {
    let mut child = entering();
    for (superior, executor, task) in [
        (1, 1, ""),
        (2, 2, "(approach n4 area1)"),
        (3, 3, "(approach n2 area1)"),
    ] {
        if superior > 1 {
            child.execute(superior, task, Some(&map_of("area1")));
        }
        child.instruct(suspend(superior));
        child.suspended(executor, &ON_ARC5);
    }
    assert_eq!(
        child.stacked(),
        ["superior.1.1", "superior.1.2", "superior.1.3"]
    );
    assert_eq!(child.instruct(clear(2)), Answer::Accepted);
    assert_eq!(child.stacked(), ["superior.1.1", "superior.1.3"]);
    child.told();
    assert_eq!(child.instruct(resume(3)), Answer::Accepted);
    assert_eq!(child.told(), ["resume #3"]);
}

#[test]
fn the_answer_to_a_late_suspension_carries_the_outcome() {
    let mut child = entering();
    child.success(1, &["(not (at n1))", "(at n6)"]);
    child.success(2, &["(not (at n6))", "(at n10)"]);
    let answer = child.instruct(suspend(1));
    assert!(
        matches!(
            answer,
            Answer::Finished {
                outcome: Report::Success { .. }
            }
        ),
        "{answer:?}"
    );
}

#[test]
fn a_repeated_instruction_is_applied_once() {
    let mut child = entering();
    let map = map_of("area1");
    assert_eq!(
        child.execute(1, "(enter area1 area3 door1_3)", Some(&map)),
        Answer::Accepted
    );
    assert_eq!(child.instruct(suspend(1)), Answer::Suspending);
    assert_eq!(child.instruct(suspend(1)), Answer::Suspending);
    assert_eq!(child.told(), ["suspend #1"]);
    child.suspended(1, &ON_ARC5);
    assert_eq!(child.instruct(suspend(1)), Answer::Suspending);
    // A second report could be taken for one of a later suspension.
    assert_eq!(child.reported(), ["#1 suspended"]);
    child.instruct(resume(1));
    assert_eq!(child.instruct(resume(1)), Answer::Accepted);
    assert_eq!(child.told(), ["resume #1"]);
}

#[test]
fn a_suspension_during_a_resumption_suspends_again() {
    let mut child = entering();
    child.instruct(suspend(1));
    child.suspended(1, &ON_ARC5);
    child.instruct(resume(1));
    assert_eq!(child.instruct(suspend(1)), Answer::Suspending);
    assert_eq!(child.told(), ["suspend #1", "resume #1", "suspend #1"]);
    child.suspended(1, &ON_ARC5);
    child.instruct(resume(1));
    assert_eq!(child.told(), ["resume #1"]);
}

#[test]
fn a_resumption_when_the_robot_is_at_the_destination_already_needs_no_action() {
    let mut child = entering();
    child.instruct(suspend(1));
    child.suspended(1, &ON_ARC5);
    child.execute(2, "(approach n5 area1)", Some(&map_of("area1")));
    child.told();
    // #2 leads off the arc; then the robot is carried through the door.
    child.success(2, &["(not (on arc5))", "(at n1)"]);
    child.success(3, &["(not (at n1))", "(at n5)"]);
    child.told();
    child.instruct(clear(1));
    child.execute(3, "(approach n5 area1)", Some(&map_of("area1")));
    assert_eq!(child.told(), ["clear #1"]);
    assert!(child.reported().contains(&"#3 success".to_owned()));
}

#[test]
fn a_failure_names_the_facts_that_are_in_the_way() {
    let mut child = entering();
    child.observe(&["(not (open door1_3))"]);
    child.success(1, &["(not (at n1))", "(at n6)"]);
    assert_eq!(child.reported(), ["#1 failure [(open door1_3)]"]);
}

#[test]
fn a_goal_that_is_resumed_goes_on_though_another_is_held_above_it() {
    // A superior may take up its goals in another order than they were suspended in: a user has
    // set one of them aside.
    let mut child = entering();
    child.instruct(suspend(1));
    child.suspended(1, &ON_ARC5);
    child.execute(2, "(approach n4 area1)", Some(&map_of("area1")));
    child.instruct(suspend(2));
    child.suspended(2, &ON_ARC5);
    child.told();
    assert_eq!(child.instruct(resume(1)), Answer::Accepted);
    assert_eq!(child.running().as_deref(), Some("superior.1.1"));
    assert_eq!(child.told(), ["resume #1"]);
    assert_eq!(
        child.stacked(),
        ["superior.1.2"],
        "and that one is still held"
    );
    child.success(1, &["(not (on arc5))", "(at n6)"]);
    child.success(3, &["(not (at n6))", "(at n10)"]);
    assert_eq!(child.running(), None);
}
