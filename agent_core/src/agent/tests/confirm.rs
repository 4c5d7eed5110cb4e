//! Execution monitoring: what sensors have to confirm, and what must hold meanwhile.

use super::{Rig, toy};
use crate::protocol::{Happening, Report, Urgency};

fn rig() -> Rig {
    Rig::of(toy::monitored)
}

fn succeeded(rig: &Rig) -> bool {
    rig.happened(|it| matches!(it, Happening::GoalSucceeded))
}

#[test]
fn an_action_succeeds_when_its_executor_says_so_and_tells_what_sensors_have_seen() {
    let mut rig = rig();
    rig.goal("own", "(go s2)", Urgency::Normal);
    rig.done(&["not (at s0)", "(at s1)"]);
    assert_eq!(rig.said(), ["left: (move s0 s1)", "left: (move s1 s2)"]);
    assert_eq!(rig.failures(), [""; 0]);
}

#[test]
fn what_was_seen_while_it_ran_confirms_it_as_well() {
    let mut rig = rig();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.seen(&["(told s0)"]);
    assert!(!succeeded(&rig), "the executor has not said so");
    rig.success();
    assert!(succeeded(&rig));
}

#[test]
fn what_nobody_has_confirmed_is_waited_for_and_whoever_sees_it_confirms_it() {
    let mut rig = rig();
    rig.goal("own", "(go s2)", Urgency::Normal);
    rig.said();
    rig.success();
    rig.passes(59.0);
    rig.restart();
    rig.neighbour("left", true);
    assert_eq!(rig.said(), [""; 0]);
    assert!(!rig.agent.belief().holds(&toy::fact("(at s1)")));
    rig.seen(&["(at s1)"]);
    assert_eq!(rig.said(), ["left: (move s1 s2)"]);
    assert_eq!(rig.failures(), [""; 0]);
    assert!(
        !rig.agent.belief().holds(&toy::fact("(at s0)")),
        "what it predicts otherwise is believed with it"
    );
}

#[test]
fn what_was_told_after_the_executors_word_counts_more_than_what_was_predicted() {
    let mut rig = rig();
    rig.goal("own", "(go s2)", Urgency::Normal);
    rig.success();
    rig.seen(&["(at s0)"]);
    rig.seen(&["(at s1)"]);
    assert!(rig.agent.belief().holds(&toy::fact("(at s0)")));
}

#[test]
fn an_action_fails_whose_goal_states_are_not_confirmed_in_time() {
    let mut rig = rig();
    rig.goal("own", "(go s2)", Urgency::Normal);
    rig.success();
    rig.said();
    rig.passes(60.0);
    assert_eq!(
        rig.failures(),
        ["no sensor has confirmed it in time: (at s1) does not hold"]
    );
    assert_eq!(rig.said(), ["left: (move s0 s1)"], "it may be tried again");
}

#[test]
fn what_must_not_be_done_twice_and_was_not_confirmed_is_unknown() {
    let mut rig = rig();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.said();
    rig.success();
    rig.passes(60.0);
    assert!(rig.happened(|it| matches!(it, Happening::GoalUnknown { .. })));
    assert_eq!(rig.said(), [""; 0]);
}

#[test]
fn an_action_fails_if_its_executor_says_that_it_is_done_and_sensors_that_it_is_not() {
    let why = "left says that it is done, but (told s0) does not hold";
    let mut rig = rig();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.done(&["not (told s0)"]);
    assert_eq!(rig.failures(), [why]);
    assert_eq!(rig.said(), ["left: (explain s0)"; 2]);
    rig.success();
    assert_eq!(rig.failures(), [why], "nothing was told yet");
    // Nothing new, but told.
    rig.seen(&["not (told s0)"]);
    assert_eq!(rig.failures(), [why; 2]);
    assert_eq!(rig.said(), ["left: (explain s0)"]);
}

#[test]
fn a_broken_protected_state_fails_the_action_and_it_is_undone_and_not_resumed() {
    let mut rig = rig();
    rig.goal("own", "(go s2)", Urgency::Normal);
    rig.said();
    rig.seen(&["not (open s0 s1)"]);
    assert_eq!(rig.said(), ["left: suspend"]);
    rig.suspended();
    assert_eq!(
        rig.failures(),
        ["(open s0 s1) does not hold, which (move s0 s1) protects"]
    );
    assert!(!rig.happened(|it| matches!(it, Happening::ActionSuspended { .. })));
    assert_eq!(rig.said(), ["left: clear"]);
    assert!(rig.happened(|it| matches!(it, Happening::GoalBlocked { .. })));
    rig.seen(&["(open s0 s1)"]);
    assert_eq!(rig.said(), ["left: (return s0 s1)"]);
    rig.done(&["not (on s0 s1)", "(at s0)"]);
    assert_eq!(rig.said(), ["left: (move s0 s1)"]);
    assert!(rig.happened(|it| matches!(it, Happening::ActionRolledBack { .. })));
}

#[test]
fn an_action_that_takes_too_long_fails_and_is_not_resumed() {
    let mut rig = rig();
    rig.goal("own", "(go s2)", Urgency::Normal);
    rig.passes(60.0);
    rig.said();
    rig.suspended();
    assert_eq!(rig.failures(), ["(move s0 s1) takes longer than it may"]);
    assert!(rig.agent.running().is_some_and(|it| it.records.is_empty()));
}

#[test]
fn what_failed_and_is_so_all_the_same_is_not_done_again() {
    for late in [true, false] {
        let mut rig = rig();
        rig.goal("own", "(tour s0 s1)", Urgency::Normal);
        rig.said();
        let facts = toy::changes(&["(told s0)"]);
        let reason = "its voice broke at the last word".to_owned();
        match late {
            true => rig.report(Report::Failure {
                reason,
                facts,
                blocked_by: Vec::new(),
            }),
            // It is carried off, and then the executor says that it had done it.
            false => {
                rig.passes(60.0);
                rig.report(Report::Success { facts });
            }
        }
        assert_eq!(rig.failures().len(), 1);
        let said: Vec<String> = rig.said();
        assert_eq!(said.last().map(String::as_str), Some("left: (move s0 s1)"));
        assert_eq!(rig.agent.running().map(|it| it.failures.len()), Some(0));
    }
}

#[test]
fn an_emergency_does_not_wait_for_sensors() {
    let mut rig = rig();
    rig.goal("own", "(go s2)", Urgency::Normal);
    rig.success();
    rig.said();
    rig.goal("urgent", "(tell s1)", Urgency::Emergency);
    assert_eq!(
        rig.said(),
        ["left: (explain s1)"],
        "it is believed to be there"
    );
    assert_eq!(rig.failures(), [""; 0]);
}

#[test]
fn what_waits_for_confirmation_does_not_wait_for_an_executor_that_has_lost_its_memory() {
    let mut rig = rig();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.success();
    rig.reborn("left");
    assert!(!rig.happened(|it| matches!(it, Happening::GoalUnknown { .. })));
    rig.seen(&["(told s0)"]);
    assert!(succeeded(&rig));
}
