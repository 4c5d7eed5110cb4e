//! Agents that wait for leave, and rest when they are told to.

use super::Rig;
use crate::agent::tests::toy::fact;
use crate::agent::{Agent, Proposal};
use crate::model::FactChange;
use crate::planner::{NaivePlanner, Settings};
use crate::protocol::{Command, Durable, Happening, Input, Resumption, Urgency};

/// An agent that asks leave.
fn asking() -> Rig {
    let mut rig = Rig::new();
    rig.agent = made();
    rig
}

fn made() -> Agent<NaivePlanner> {
    super::toy::agent(1, NaivePlanner::new(Settings::default())).named("mid".into(), true)
}

fn proposed(rig: &Rig) -> String {
    match rig.agent.proposal() {
        None => "nothing".to_owned(),
        Some(Proposal::NoPlan(wanted)) => format!("no plan: {wanted:?}"),
        Some(Proposal::Plan(plan)) => format!("{:?}", plan.actions()),
    }
}

fn grant(rig: &mut Rig) {
    rig.agent.grant(rig.now);
    rig.give(Input::Wake);
}

fn pause(rig: &mut Rig, why: Option<&str>) {
    rig.agent.pause(rig.now, why);
    rig.give(Input::Wake);
}

fn closes(door: &str) -> Input<std::convert::Infallible> {
    Input::Observation(vec![FactChange::Remove(fact(door))])
}

#[test]
fn nothing_is_begun_before_there_is_leave() {
    let mut rig = asking();
    rig.goal("there", "(go s2)", Urgency::Normal);
    rig.passes(100.0);
    assert_eq!(proposed(&rig), "[(move s0 s1), (move s1 s2)]");
    assert_eq!(rig.said(), [""; 0]);
    grant(&mut rig);
    assert_eq!(rig.said(), ["left: (move s0 s1)"]);
    assert_eq!(proposed(&rig), "nothing");
    rig.success();
    assert_eq!(proposed(&rig), "[(move s1 s2)]");
    grant(&mut rig);
    rig.success();
    assert!(rig.happened(|it| matches!(it, Happening::GoalSucceeded)));
}

#[test]
fn what_it_waits_for_leave_for_is_planned_anew_when_something_changes() {
    let mut rig = asking();
    rig.goal("there", "(go s2)", Urgency::Normal);
    // Somebody else has brought the robot there.
    rig.give(Input::Observation(vec![
        FactChange::Remove(fact("(at s0)")),
        FactChange::Add(fact("(at s1)")),
    ]));
    assert_eq!(proposed(&rig), "[(move s1 s2)]");
    rig.give(closes("(open s1 s2)"));
    assert!(proposed(&rig).starts_with("no plan"), "{}", proposed(&rig));
    rig.give(Input::Observation(vec![FactChange::Add(fact(
        "(open s1 s2)",
    ))]));
    assert_eq!(proposed(&rig), "[(move s1 s2)]");
    assert!(!rig.happened(|it| matches!(it, Happening::GoalBlocked { .. })));
}

#[test]
fn without_a_plan_it_gives_up_only_when_it_may() {
    let mut rig = asking();
    rig.give(closes("(open s0 s1)"));
    rig.goal("there", "(go s2)", Urgency::Normal);
    assert_eq!(proposed(&rig), "no plan: [(open s0 s1)]");
    grant(&mut rig);
    assert!(rig.happened(|it| matches!(it, Happening::GoalBlocked { .. })));
    assert!(rig.agent.running().is_none());
}

#[test]
fn who_is_to_rest_is_suspended_and_resumed_as_for_an_emergency() {
    let mut rig = asking();
    rig.goal("there", "(go s2)", Urgency::Normal);
    grant(&mut rig);
    pause(&mut rig, Some("the spill goes first"));
    assert_eq!(rig.said(), ["left: (move s0 s1)", "left: suspend"]);
    rig.suspended();
    assert!(rig.agent.running().is_none());
    assert_eq!(rig.agent.stack().depth(), 1);
    rig.goal("other", "(go s1)", Urgency::Emergency);
    assert!(rig.agent.running().is_none(), "it rests, whatever comes");
    rig.give(Input::Command(Command::Cancel("other".into())));
    pause(&mut rig, None);
    assert!(
        proposed(&rig).starts_with("[(resume-move s0 s1)"),
        "{}",
        proposed(&rig)
    );
    grant(&mut rig);
    assert_eq!(rig.said(), ["left: resume"]);
    assert!(rig.happened(|it| matches!(
        it,
        Happening::GoalResumed {
            how: Resumption::Continued,
            ..
        }
    )));
}

#[test]
fn who_rests_while_it_waits_for_leave_has_nothing_to_stop() {
    let mut rig = asking();
    rig.goal("there", "(go s2)", Urgency::Normal);
    pause(&mut rig, Some("the spill goes first"));
    assert_eq!(rig.said(), [""; 0]);
    assert_eq!(proposed(&rig), "nothing");
    grant(&mut rig);
    assert_eq!(rig.said(), [""; 0], "there is no leave for who rests");
    pause(&mut rig, None);
    assert_eq!(proposed(&rig), "[(move s0 s1), (move s1 s2)]");
}

#[test]
fn a_restart_forgets_the_proposal_and_comes_to_it_again() {
    let mut rig = asking();
    rig.goal("there", "(go s2)", Urgency::Normal);
    let mut again = made();
    again.recall(&rig.rows).expect("it can be read");
    rig.agent = again;
    rig.give(Input::Wake);
    assert_eq!(proposed(&rig), "[(move s0 s1), (move s1 s2)]");
    assert_eq!(rig.said(), [""; 0]);
}
