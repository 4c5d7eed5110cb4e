//! A robot that cannot be interrupted does not move.

use super::{Rig, boss};
use crate::protocol::{Happening, Instruction, Report, Urgency};

#[test]
fn while_its_superior_is_gone_an_agent_stops_what_runs_and_goes_on_when_it_is_back() {
    let mut rig = Rig::new();
    rig.execute(1, "(go s3)");
    assert_eq!(rig.said(), ["left: (move s0 s1)"]);
    rig.neighbour("boss", false);
    assert!(rig.agent.holds());
    assert_eq!(rig.said(), ["left: suspend"]);
    rig.suspended();
    rig.passes(1000.0);
    assert_eq!(rig.said(), [""; 0], "nothing is begun or resumed");
    rig.neighbour("boss", true);
    assert!(!rig.agent.holds());
    assert_eq!(rig.said(), ["left: resume"]);
    assert!(rig.happened(|it| matches!(it, Happening::NeighbourLost { name } if *name == "boss")));
    assert!(rig.happened(|it| matches!(it, Happening::NeighbourBack { name } if *name == "boss")));
    // The superior has not asked for it, and is told nothing of it.
    assert!(
        !rig.reports
            .iter()
            .any(|(_, r)| matches!(r, Report::Suspended { .. }))
    );
    for _ in 0..3 {
        rig.success();
    }
    assert!(matches!(rig.reports.last(), Some((id, Report::Success { .. })) if *id == boss(1)));
}

#[test]
fn a_goal_that_is_being_planned_for_waits_for_the_superior() {
    let mut rig = Rig::new();
    rig.neighbour("boss", false);
    assert!(!rig.agent.holds(), "it has no goal of the superior's");
    rig.execute(1, "(go s2)");
    assert!(rig.agent.holds());
    assert_eq!(rig.said(), [""; 0]);
    assert!(!rig.happened(|it| matches!(it, Happening::GoalStarted)));
    rig.neighbour("boss", true);
    assert!(rig.happened(|it| matches!(it, Happening::GoalStarted)));
    assert_eq!(rig.said(), ["left: (move s0 s1)"]);
}

#[test]
fn a_goal_of_its_own_runs_on_unless_it_stands_above_a_superiors() {
    let mut rig = Rig::new();
    rig.goal("own", "(go s2)", Urgency::Emergency);
    rig.neighbour("boss", false);
    assert_eq!(rig.said(), ["left: (move s0 s1)"]);
    rig.success();
    assert_eq!(
        rig.said(),
        ["left: (move s1 s2)"],
        "no superior has a goal here"
    );

    let mut rig = Rig::new();
    rig.execute(1, "(go s3)");
    rig.goal("own", "(tell s0)", Urgency::Emergency);
    rig.suspended();
    rig.said();
    rig.neighbour("boss", false);
    assert_eq!(rig.said(), [""; 0], "it goes back to s0, and ends that");
    rig.success();
    assert_eq!(rig.said(), [""; 0]);
    rig.neighbour("boss", true);
    assert_eq!(rig.said(), ["left: (explain s0)"]);
}

#[test]
fn an_emergency_that_comes_while_an_agent_holds_waits_and_then_goes_first() {
    let mut rig = Rig::new();
    rig.execute(1, "(go s3)");
    rig.neighbour("boss", false);
    rig.suspended();
    rig.said();
    rig.goal("own", "(tell s0)", Urgency::Emergency);
    assert_eq!(rig.said(), [""; 0]);
    rig.neighbour("boss", true);
    assert_eq!(rig.said(), ["left: (return s0 s1)"]);
    assert_eq!(rig.agent.stack().depth(), 1);
}

#[test]
fn a_restarted_agent_holds_until_the_superiors_of_its_goals_are_seen() {
    let mut rig = Rig::new();
    rig.execute(1, "(go s3)");
    rig.success();
    rig.said();
    rig.restart();
    assert!(rig.agent.holds());
    rig.passes(1.0);
    assert_eq!(rig.said(), ["left: suspend"]);
    rig.neighbour("left", true);
    rig.suspended();
    assert_eq!(rig.said(), [""; 0]);
    rig.neighbour("boss", true);
    assert_eq!(rig.said(), ["left: resume"]);
    assert!(
        !rig.happened(|it| matches!(it, Happening::NeighbourBack { .. })),
        "it was not lost"
    );
}

#[test]
fn a_restarted_agent_whose_superior_is_there_goes_on_without_stopping() {
    let mut rig = Rig::new();
    rig.execute(1, "(go s3)");
    rig.said();
    rig.restart();
    rig.neighbour("boss", true);
    rig.success();
    assert_eq!(rig.said(), ["left: (move s1 s2)"]);
}

#[test]
fn a_superior_that_is_back_can_suspend_and_clear_what_was_held() {
    let mut rig = Rig::new();
    rig.execute(1, "(go s3)");
    rig.neighbour("boss", false);
    rig.suspended();
    // It was sent before the superior vanished, and comes late.
    rig.boss(Instruction::Suspend { id: boss(1) });
    assert!(matches!(
        rig.reports.last(),
        Some((_, Report::Suspended { .. }))
    ));
    rig.said();
    rig.boss(Instruction::Clear { id: boss(1) });
    assert_eq!(rig.said(), ["left: clear"]);
    assert!(!rig.agent.holds());
}

#[test]
fn an_executor_that_is_gone_is_named_and_an_action_does_not_fail_for_its_absence() {
    let mut rig = Rig::new();
    rig.goal("own", "(go s2)", Urgency::Normal);
    rig.said();
    rig.passes(50.0);
    rig.neighbour("left", false);
    assert!(rig.happened(|it| matches!(it, Happening::NeighbourLost { name } if *name == "left")));
    assert!(!rig.agent.holds());
    rig.passes(1000.0);
    assert_eq!(rig.said(), [""; 0], "its time is not up");
    rig.neighbour("left", true);
    rig.passes(59.0);
    assert_eq!(rig.said(), [""; 0]);
    rig.passes(1.0);
    assert_eq!(
        rig.said(),
        ["left: suspend"],
        "a minute from when it was back"
    );
}

#[test]
fn a_stranger_is_not_spoken_of() {
    let mut rig = Rig::new();
    rig.neighbour("stranger", false);
    rig.neighbour("stranger", true);
    assert_eq!(rig.events, []);
}
