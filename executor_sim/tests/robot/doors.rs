//! Doors that open and close, with and without the robot.

use agent_core::model::FactChange;
use agent_core::protocol::{Answer, Report};
use executor_sim::Place;

use crate::rig::{Rig, atom, is_success, is_suspended};

/// From n6 it turns for π/3 s, then needs 2 s and 1 m to reach full speed; the door is at 4 m.
const SETS_OFF_S: f64 = std::f64::consts::FRAC_PI_3;

fn rig_on_arc12(at_s: f64) -> Rig {
    let mut rig = Rig::new("n6");
    rig.execute(1, "move n6 n10 arc12");
    rig.until(SETS_OFF_S + at_s);
    rig
}

fn offset_m(rig: &Rig) -> f64 {
    match rig.place() {
        Place::Arc { offset_m, .. } => offset_m,
        Place::Node { node } => unreachable!("at {node}"),
    }
}

#[test]
fn a_door_that_shuts_in_front_stops_the_robot_before_it() {
    let mut rig = rig_on_arc12(3.0);
    rig.door("d3", false);
    let seen = (rig.now, vec![FactChange::Remove(atom("open d3"))], None);
    assert_eq!(rig.observed, [seen]);
    rig.until(60.0);
    let (at_s, report) = rig.only(1);
    assert!((at_s - SETS_OFF_S - 4.0).abs() < 5e-6);
    let Report::Failure {
        reason,
        facts,
        blocked_by,
    } = report
    else {
        unreachable!("{report:?}");
    };
    assert_eq!(reason, "the door `d3` is closed");
    assert_eq!(*blocked_by, [atom("open d3")]);
    assert!(facts.contains(&FactChange::Remove(atom("open d3"))));
    assert!((offset_m(&rig) - 2.5).abs() < 1e-5);
    assert!(rig.believes("free arc12 n6") && !rig.believes("free arc12 n10"));
    rig.check_belief();
    // Back is possible, on is not.
    rig.execute(2, "leave arc12 n10");
    assert!(!is_success(rig.only(2).1));
    rig.execute(3, "leave arc12 n6");
    rig.until(100.0);
    assert!(is_success(rig.only(3).1));
    rig.check_belief();
}

#[test]
fn a_robot_too_near_to_stop_passes_under_the_door() {
    // At 3.6 m, with 0.5 m to stop.
    let mut rig = rig_on_arc12(4.6);
    rig.door("d3", false);
    rig.until(60.0);
    assert!(is_success(rig.only(1).1));
    assert!(rig.believes("at n10") && !rig.believes("open d3"));
    rig.check_belief();
}

#[test]
fn a_robot_does_not_set_off_towards_a_closed_door() {
    let mut rig = Rig::new("n6");
    rig.door("d3", false);
    assert_eq!(rig.execute(1, "move n6 n10 arc12"), Answer::Accepted);
    assert!(matches!(rig.only(1).1, Report::Failure { .. }));
    assert!(rig.believes("at n6"));
    rig.check_belief();
    assert_eq!(rig.odometer_m(), 0.0);
}

#[test]
fn a_door_behind_does_not_matter() {
    let mut rig = rig_on_arc12(6.0);
    rig.door("d3", false);
    rig.until(60.0);
    assert!(is_success(rig.only(1).1));
    rig.check_belief();
}

#[test]
fn a_door_that_shuts_while_a_robot_stands_on_its_arc_is_seen_from_there() {
    for (at_s, free, shut_off) in [(2.0, "n6", "n10"), (6.0, "n10", "n6")] {
        let mut rig = rig_on_arc12(at_s);
        rig.suspend(1);
        rig.until(20.0);
        assert!(rig.believes("free arc12 n6") && rig.believes("free arc12 n10"));
        rig.check_belief();
        rig.door("d3", false);
        assert!(rig.believes(&format!("free arc12 {free}")));
        assert!(!rig.believes(&format!("free arc12 {shut_off}")));
        rig.check_belief();
        rig.door("d3", true);
        rig.check_belief();
        let told = rig.observed.len();
        // Nothing has changed, so nothing is said.
        rig.door("d3", true).door("d99", true);
        assert_eq!(rig.observed.len(), told);
    }
}

#[test]
fn a_robot_that_is_asked_to_stop_while_a_door_stops_it_is_suspended() {
    let mut rig = rig_on_arc12(3.0);
    rig.door("d3", false);
    rig.until(SETS_OFF_S + 3.5);
    assert_eq!(rig.suspend(1), Answer::Suspending);
    rig.until(20.0);
    assert!(is_suspended(rig.only(1).1));
    rig.check_belief();
    rig.door("d3", true);
    rig.resume(1);
    rig.until(60.0);
    assert!(is_success(rig.told(1)[1]));
    assert!((rig.odometer_m() - 8.0).abs() < 1e-9);
}

#[test]
fn a_record_is_of_no_use_before_a_closed_door() {
    let mut rig = rig_on_arc12(3.0);
    rig.suspend(1);
    rig.until(20.0);
    rig.door("d3", false);
    rig.resume(1);
    let Report::Failure { blocked_by, .. } = rig.told(1)[1] else {
        unreachable!("the door is closed");
    };
    assert_eq!(*blocked_by, [atom("open d3")]);
    rig.check_belief();
}

#[test]
fn a_robot_opens_and_shuts_doors_in_the_time_that_it_takes() {
    let mut rig = Rig::new("n6");
    rig.execute(1, "shut d3");
    rig.until(4.9);
    assert!(rig.robot.world().doors()["d3"]);
    rig.until(10.0);
    let (at_s, report) = rig.only(1);
    assert!((at_s - 5.0).abs() < 1e-6);
    let Report::Success { facts } = report else {
        unreachable!("{report:?}");
    };
    assert!(facts.contains(&FactChange::Remove(atom("open d3"))));
    rig.check_belief();
    rig.execute(2, "unlock d3");
    assert!(matches!(rig.suspend(2), Answer::Refused { .. }));
    rig.until(20.0);
    assert!(rig.believes("open d3"));
    rig.check_belief();
}

#[test]
fn of_a_robot_that_drives_only_the_door_is_told() {
    let mut rig = rig_on_arc12(2.0);
    rig.suspend(1);
    rig.until(20.0);
    rig.clear(1);
    rig.execute(2, "leave arc12 n6");
    rig.until(21.0);
    rig.door("d3", false);
    let (_, facts, _) = rig.observed.last().expect("an observation");
    assert_eq!(*facts, [FactChange::Remove(atom("open d3"))]);
    rig.until(40.0);
    assert!(is_success(rig.only(2).1));
    rig.check_belief();
}
