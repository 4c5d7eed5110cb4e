//! Driving, turning and braking, against closed formulas.

use std::f64::consts::{FRAC_PI_2, PI};

use agent_core::protocol::Answer;

use crate::rig::{Rig, is_success, is_suspended};

/// To gain 1 m/s at 0.5 m/s², keep it, and lose it at 1 m/s²: 2 s + 1 s for 1.5 m, and the rest.
fn way_s(length_m: f64) -> f64 {
    3.0 + (length_m - 1.5)
}

#[test]
fn a_drive_ahead_arrives_when_the_formula_says() {
    let mut rig = Rig::new("n1");
    assert_eq!(rig.execute(1, "move n1 n6 arc5"), Answer::Accepted);
    rig.until(60.0);
    let (at_s, report) = rig.only(1);
    assert!((at_s - way_s(6.0)).abs() < 2e-6, "{at_s}");
    assert!(is_success(report));
    assert!((rig.odometer_m() - 6.0).abs() < 1e-9);
    rig.check_belief();
    assert!(rig.believes("at n6") && !rig.believes("at n1"));
}

#[test]
fn a_robot_turns_before_it_sets_off() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(20.0);
    rig.execute(2, "move n6 n10 arc12");
    rig.until(20.0 + FRAC_PI_2 / 1.5 / 2.0);
    let pose = rig.robot.world().pose(rig.now);
    assert!((pose.heading_rad - FRAC_PI_2 / 2.0).abs() < 1e-6);
    assert_eq!((pose.speed_m_s, pose.node), (0.0, Some("n6".into())));
    rig.until(60.0);
    let (at_s, _) = rig.only(2);
    assert!((at_s - 20.0 - FRAC_PI_2 / 1.5 - way_s(8.0)).abs() < 2e-6);
    let pose = rig.robot.world().pose(rig.now);
    assert!((pose.heading_rad - FRAC_PI_2).abs() < 1e-9);
}

#[test]
fn a_pose_in_mid_drive_says_how_far_and_how_fast() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(1.0);
    let pose = rig.robot.world().pose(rig.now);
    assert!((pose.speed_m_s - 0.5).abs() < 1e-9);
    assert!((pose.position_m[0] - 0.25).abs() < 1e-9);
    assert_eq!(pose.arc, Some("arc5".into()));
    let fraction = pose.fraction.expect("on an arc");
    assert!((fraction - 0.25 / 6.0).abs() < 1e-9);
}

#[test]
fn a_robot_stops_within_its_braking_distance_and_not_before() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(3.0);
    // 1 m to gain speed, 1 m at full speed; 0.5 m and 1 s to stop.
    assert_eq!(rig.suspend(1), Answer::Suspending);
    assert!(rig.told(1).is_empty(), "it still rolls");
    rig.until(60.0);
    let (at_s, report) = rig.only(1);
    assert!(is_suspended(report));
    assert!((at_s - 4.0).abs() < 2e-6, "{at_s}");
    assert!((rig.gap_m("arc5", "n1") - 2.5).abs() < 1e-9);
    assert!((rig.gap_m("arc5", "n6") - 3.5).abs() < 1e-9);
    assert!(rig.believes("on arc5") && rig.believes("left n1") && !rig.believes("at n1"));
    rig.check_belief();
}

#[test]
fn a_drive_in_pieces_is_as_long_as_in_one() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n10 arc8");
    let mut now_s = 0.0;
    for piece in 0..6 {
        now_s += 2.3;
        rig.until(now_s);
        assert_eq!(rig.suspend(1), Answer::Suspending);
        now_s += 2.0;
        rig.until(now_s);
        rig.check_belief();
        assert!(rig.believes("left n1"), "piece {piece}");
        assert_eq!(rig.resume(1), Answer::Accepted);
    }
    rig.until(100.0);
    assert!(is_success(rig.told(1)[6]));
    assert!((rig.odometer_m() - 15.0).abs() < 1e-9);
    rig.check_belief();
}

#[test]
fn a_rollback_turns_round_and_drives_back_to_where_the_move_began() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(3.0);
    rig.suspend(1);
    rig.until(10.0);
    assert_eq!(rig.clear(1), Answer::Accepted);
    assert_eq!(rig.execute(2, "return n1 arc5"), Answer::Accepted);
    rig.until(60.0);
    let (at_s, report) = rig.only(2);
    assert!(is_success(report));
    assert!((at_s - 10.0 - PI / 1.5 - way_s(2.5)).abs() < 2e-6, "{at_s}");
    assert!((rig.odometer_m() - 5.0).abs() < 1e-9);
    assert!(rig.believes("at n1"));
    rig.check_belief();
}

#[test]
fn the_end_that_a_robot_left_is_kept_over_several_drives_on_one_arc() {
    let mut rig = Rig::new("n6");
    rig.execute(1, "leave arc5 n1");
    rig.until(5.0);
    rig.suspend(1);
    rig.until(8.0);
    assert!(rig.believes("left n6"));
    rig.execute(2, "leave arc5 n6");
    rig.until(11.0);
    assert_eq!(rig.suspend(2), Answer::Suspending);
    rig.until(15.0);
    assert!(rig.believes("on arc5") && rig.believes("left n6"));
    rig.check_belief();
}

#[test]
fn whoever_is_there_already_has_arrived() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "leave arc5 n1");
    assert!(is_success(rig.only(1).1));
    assert_eq!(rig.odometer_m(), 0.0);
    rig.check_belief();
}
