//! Goals that are over.

use super::Rig;
use crate::model::Time;
use crate::protocol::{Happening, Reply, Urgency};

#[test]
fn a_goal_that_is_asked_for_again_after_it_is_done_is_acknowledged_and_not_done_again() {
    let mut rig = Rig::new();
    rig.goal("own", "(go s1)", Urgency::Normal);
    rig.success();
    rig.said();
    for _ in 0..2 {
        let again = rig.goal("own", "(go s1)", Urgency::Normal);
        assert_eq!(again, Some(Reply::Goal(Ok("own".into()))));
        assert_eq!(rig.said(), [""; 0]);
        rig.restart();
    }
    assert!(matches!(
        rig.goal("own", "(go s2)", Urgency::Normal),
        Some(Reply::Goal(Err(_)))
    ));
    let accepted = |it: &&crate::protocol::Event| matches!(it.what, Happening::GoalAccepted { .. });
    assert_eq!(rig.events.iter().filter(accepted).count(), 1);
}

#[test]
fn goals_that_are_over_are_forgotten_by_number_and_by_time() {
    let mut rig = Rig::new();
    for number in 0..8 {
        rig.passes(1.0);
        rig.goal(&format!("goal{number}"), "(go s0)", Urgency::Normal);
    }
    let names = |rig: &Rig| -> Vec<String> {
        rig.agent
            .ended()
            .map(|ended| ended.id.to_string())
            .collect()
    };
    assert_eq!(
        names(&rig),
        ["goal2", "goal3", "goal4", "goal5", "goal6", "goal7"]
    );
    assert_eq!(
        rig.agent.ended().next().map(|e| e.at),
        Some(Time::from_secs(3.0))
    );
    rig.restart();
    assert_eq!(names(&rig).len(), 6);
    rig.passes(297.0);
    assert_eq!(names(&rig), ["goal4", "goal5", "goal6", "goal7"]);
    rig.restart();
    rig.passes(1000.0);
    assert_eq!(names(&rig), [""; 0]);
    rig.restart();
    assert_eq!(names(&rig), [""; 0]);
}

#[test]
fn however_many_goals_need_no_action_none_waits_for_the_next_input() {
    let mut rig = Rig::new();
    rig.goal("first", "(go s1)", Urgency::Normal);
    for number in 0..40 {
        rig.goal(&format!("goal{number}"), "(go s1)", Urgency::Normal);
    }
    rig.success();
    let counts = rig.agent.counts();
    assert!(counts.values().all(|count| *count == 0), "{counts:?}");
}
