//! Decision 11: nothing is repeated blindly that must not be done twice.

use super::{Rig, boss, toy};
use crate::model::FactChange;
use crate::protocol::{Happening, Input, Report, Urgency};

fn goal_unknown(rig: &Rig) -> bool {
    rig.happened(|it| matches!(it, Happening::GoalUnknown { .. }))
}

#[test]
fn an_action_that_may_be_repeated_is_planned_for_again_from_what_is_believed() {
    let mut rig = Rig::new();
    rig.goal("own", "(go s2)", Urgency::Normal);
    assert_eq!(rig.said(), ["left: (move s0 s1)"]);
    for _ in 0..5 {
        rig.unknown(Vec::new());
        assert_eq!(rig.said(), ["left: (move s0 s1)"]);
    }
    let stands = ["(at s0)", "(at s1)"].map(toy::fact);
    let [gone, here] = stands;
    rig.report(Report::Failure {
        reason: String::new(),
        facts: vec![FactChange::Remove(gone), FactChange::Add(here)],
        blocked_by: Vec::new(),
    });
    assert_eq!(rig.said(), ["left: (move s1 s2)"]);
}

#[test]
fn an_action_that_must_not_be_repeated_ends_the_goal_and_its_superior_is_told_that_nobody_knows() {
    let mut rig = Rig::new();
    rig.execute(1, "(tell s0)");
    assert_eq!(rig.said(), ["left: (explain s0)"]);
    rig.unknown(Vec::new());
    assert_eq!(rig.said(), [""; 0]);
    assert!(goal_unknown(&rig));
    assert!(matches!(rig.reports.last(), Some((id, Report::Unknown { .. })) if *id == boss(1)));
    assert!(rig.agent.running().is_none());
    let ended = rig.agent.ended().last().expect("it is remembered");
    assert!(matches!(ended.outcome, Report::Unknown { .. }));
}

#[test]
fn a_users_goal_ends_as_unknown_and_is_not_begun_again() {
    let mut rig = Rig::new();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.said();
    rig.unknown(Vec::new());
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.restart();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    assert_eq!(rig.said(), [""; 0]);
    let ended = rig
        .agent
        .ended_goal(&"own".into())
        .expect("it is remembered");
    assert!(matches!(ended.outcome, Report::Unknown { .. }));
}

#[test]
fn where_the_facts_tell_it_is_known() {
    let told = toy::fact("(told s0)");
    let mut rig = Rig::new();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.said();
    rig.unknown(vec![FactChange::Add(told.clone())]);
    assert!(rig.happened(|it| matches!(it, Happening::GoalSucceeded)));
    assert!(!goal_unknown(&rig));

    let mut rig = Rig::new();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.said();
    rig.unknown(vec![FactChange::Remove(told)]);
    assert_eq!(rig.said(), ["left: (explain s0)"], "it was not done");
    assert!(!goal_unknown(&rig));
}

#[test]
fn what_was_so_before_tells_nothing() {
    let told = FactChange::Add(toy::fact("(told s0)"));
    let mut rig = Rig::new();
    rig.give(Input::Observation(vec![told.clone()]));
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.unknown(vec![told]);
    assert!(goal_unknown(&rig));
}

#[test]
fn an_executor_without_memory_leaves_what_must_not_be_repeated_unknown() {
    let mut rig = Rig::new();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.said();
    rig.reborn("left");
    assert_eq!(rig.said(), [""; 0]);
    assert!(goal_unknown(&rig));
}

#[test]
fn what_was_suspended_before_it_is_known_not_to_be_done_goes_on_and_nothing_else_of_the_stack_ends()
{
    let mut rig = Rig::new();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    rig.goal("urgent", "(go s1)", Urgency::Emergency);
    rig.said();
    // It was to stop, and then nobody knew.
    rig.unknown(Vec::new());
    assert!(goal_unknown(&rig));
    assert_eq!(rig.said(), ["left: (move s0 s1)"], "the emergency goes on");
}
