//! An executor that has stopped on its own, and other things that restarts bring about.

use super::{Rig, boss};
use crate::protocol::{Command, Happening, Input, Instruction, Report, Urgency};

#[test]
fn an_executor_that_has_stopped_on_its_own_is_told_to_go_on_and_nothing_has_failed() {
    let mut rig = Rig::new();
    rig.goal("own", "(go s1)", Urgency::Normal);
    rig.said();
    for _ in 0..10 {
        rig.suspended();
        assert_eq!(rig.said(), ["left: resume"]);
    }
    assert!(!rig.happened(|it| matches!(it, Happening::ActionFinished { .. })));
    rig.success();
    assert!(rig.happened(|it| matches!(it, Happening::GoalSucceeded)));
}

#[test]
fn a_suspension_that_is_told_late_changes_nothing() {
    let mut rig = Rig::new();
    rig.goal("own", "(go s2)", Urgency::Normal);
    let first = rig.running();
    rig.success();
    rig.said();
    let facts = Vec::new();
    let report = Report::Suspended { facts };
    rig.give(Input::Report { id: first, report });
    assert_eq!(rig.said(), [""; 0]);
}

#[test]
fn an_executor_that_has_stopped_on_its_own_while_its_goal_was_cancelled_rolls_back() {
    let mut rig = Rig::new();
    rig.goal("own", "(go s2)", Urgency::Normal);
    rig.give(Input::Command(Command::Cancel("own".into())));
    assert_eq!(rig.said(), ["left: (move s0 s1)", "left: suspend"]);
    rig.restart();
    rig.suspended();
    assert_eq!(rig.said(), ["left: clear", "left: (return s0 s1)"]);
    rig.restart();
    rig.success();
    assert!(rig.happened(|it| matches!(it, Happening::GoalFailed { .. })));
}

#[test]
fn a_superior_that_asks_twice_to_suspend_is_told_once_that_it_is_done() {
    let mut rig = Rig::new();
    rig.execute(1, "(go s3)");
    rig.boss(Instruction::Suspend { id: boss(1) });
    rig.suspended();
    rig.boss(Instruction::Suspend { id: boss(1) });
    let suspended = |(_, report): &&(_, Report)| matches!(report, Report::Suspended { .. });
    assert_eq!(rig.reports.iter().filter(suspended).count(), 1);
}

#[test]
fn the_time_of_an_action_begins_anew_after_a_restart() {
    let mut rig = Rig::new();
    rig.goal("own", "(go s1)", Urgency::Normal);
    rig.said();
    rig.restart();
    rig.passes(1000.0);
    assert_eq!(
        rig.said(),
        [""; 0],
        "nobody knows how much of it was spent on the action"
    );
    rig.passes(60.0);
    assert_eq!(rig.said(), ["left: suspend"]);
}

#[test]
fn a_goal_that_was_suspended_is_taken_up_again_after_a_restart_as_it_was() {
    let mut rig = Rig::new();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.goal("urgent", "(go s1)", Urgency::Emergency);
    rig.suspended();
    rig.said();
    rig.restart();
    rig.success();
    rig.restart();
    assert_eq!(rig.said(), ["left: (move s1 s0)"]);
    rig.success();
    assert_eq!(rig.said(), ["left: resume"]);
    assert!(rig.happened(|it| matches!(it, Happening::GoalResumed { .. })));
    rig.success();
    assert!(rig.agent.running().is_none());
}
