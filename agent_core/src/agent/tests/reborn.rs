//! Neighbours that have lost their memory.

use super::{Rig, boss, toy};
use crate::protocol::{ActionId, Command, Happening, Input, Instruction, Urgency};

#[test]
fn goals_of_a_superior_that_has_lost_its_memory_are_ended_and_what_runs_is_stopped_first() {
    let mut rig = Rig::new();
    rig.execute(1, "(go s3)");
    rig.said();
    rig.reborn("boss");
    assert_eq!(rig.said(), ["left: suspend"]);
    assert!(rig.agent.running().is_some());
    rig.suspended();
    assert_eq!(rig.said(), ["left: clear"], "it is not even rolled back");
    assert!(rig.agent.running().is_none());
    let lost = "boss has lost its memory";
    assert!(rig.happened(|it| matches!(it, Happening::GoalFailed { reason } if reason == lost)));
    let reports = &rig.reports[1..];
    assert_eq!(reports, [], "nobody is there who would understand");
    let answer = rig.boss(Instruction::Execute {
        id: ActionId {
            epoch: 8,
            ..boss(1)
        },
        action: toy::fact("(go s1)"),
        map: None,
    });
    assert!(answer.is_some());
    assert_eq!(
        rig.said(),
        ["left: (return s0 s1)"],
        "it begins from where the robot stands"
    );
}

#[test]
fn a_goal_that_is_held_for_a_superior_is_dropped_and_what_stood_above_is_the_agents_own() {
    let mut rig = Rig::new();
    rig.execute(1, "(go s3)");
    rig.goal("own", "(tell s0)", Urgency::Emergency);
    rig.suspended();
    rig.boss(Instruction::Suspend { id: boss(1) });
    rig.said();
    // It goes back to s0, which is not stopped.
    rig.success();
    assert_eq!(rig.agent.stack().depth(), 2);
    rig.reborn("boss");
    assert_eq!(rig.said(), ["left: clear", "left: (explain s0)"]);
    rig.success();
    assert_eq!(rig.agent.stack().depth(), 0);
    assert!(rig.happened(|it| matches!(it, Happening::GoalSucceeded)));
}

#[test]
fn what_an_executor_without_memory_was_doing_is_begun_anew_and_has_not_failed() {
    let mut rig = Rig::new();
    rig.goal("own", "(go s1)", Urgency::Normal);
    for _ in 0..10 {
        assert_eq!(rig.said(), ["left: (move s0 s1)"]);
        rig.reborn("left");
    }
    assert_eq!(rig.said(), ["left: (move s0 s1)"]);
    rig.success();
    assert!(rig.happened(|it| matches!(it, Happening::GoalSucceeded)));
}

#[test]
fn records_that_an_executor_has_lost_are_not_resumed_but_begun_anew() {
    let mut rig = Rig::new();
    rig.goal("own", "(tell s0)", Urgency::Normal);
    assert_eq!(rig.said(), ["left: (explain s0)"]);
    rig.goal("urgent", "(go s1)", Urgency::Emergency);
    rig.suspended();
    assert_eq!(rig.said(), ["left: suspend", "left: (move s0 s1)"]);
    rig.reborn("left");
    assert_eq!(rig.said(), ["left: (move s0 s1)"]);
    rig.success();
    assert_eq!(rig.said(), ["left: (move s1 s0)"]);
    rig.success();
    assert_eq!(rig.said(), ["left: (explain s0)"], "from its beginning");
}

#[test]
fn a_record_that_is_lost_on_the_way_to_where_it_can_be_resumed_is_not_resumed() {
    let mut rig = Rig::new();
    // An action of the goal's own, with no task above it that could be begun again.
    rig.goal("own", "(explain s0)", Urgency::Normal);
    rig.goal("urgent", "(go s1)", Urgency::Emergency);
    rig.suspended();
    rig.said();
    rig.success();
    assert_eq!(
        rig.said(),
        ["left: (move s1 s0)"],
        "on its way back, to resume"
    );
    rig.reborn("left");
    assert_eq!(rig.said(), ["left: (move s1 s0)"]);
    rig.restart();
    rig.success();
    assert_eq!(rig.said(), ["left: (explain s0)"]);
    rig.success();
    assert!(rig.agent.running().is_none());
}

#[test]
fn nothing_is_rolled_back_of_which_the_record_is_lost() {
    let mut rig = Rig::new();
    rig.goal("own", "(go s3)", Urgency::Normal);
    rig.goal("urgent", "(tell s0)", Urgency::Emergency);
    rig.suspended();
    rig.give(Input::Command(Command::Cancel("own".into())));
    rig.reborn("left");
    rig.said();
    rig.success();
    assert_eq!(rig.said(), ["left: (explain s0)"]);
    rig.success();
    assert_eq!(rig.said(), [""; 0]);
    assert!(rig.agent.running().is_none());
    assert!(rig.happened(|it| matches!(it, Happening::GoalFailed { .. })));
}
