//! Suspending, resuming, and what is kept between.

use agent_core::model::Time;
use agent_core::protocol::{Answer, Event, Happening, Machine, Report};
use executor_sim::Motion;

use crate::rig::{Rig, id, is_success, is_suspended, reason};

#[test]
fn at_every_instant_of_a_drive_a_suspension_ends_in_one_report() {
    let (mut stopped, mut arrived) = (0, 0);
    for step in 0..=1000 {
        let mut rig = Rig::new("n4");
        // The robot faces n1; n4 from n1 would need a turn, and so does this second drive.
        rig.execute(1, "move n4 n1 arc7");
        rig.until(10.0);
        rig.execute(2, "leave arc7 n4");
        rig.until(10.0 + f64::from(step) * 0.007);
        let answer = rig.suspend(2);
        rig.until(60.0);
        let (_, report) = rig.only(2);
        match &answer {
            Answer::Suspending if is_suspended(report) => stopped += 1,
            // The node was nearer than the braking distance.
            Answer::Suspending if is_success(report) => arrived += 1,
            Answer::Finished { outcome } => assert!(outcome == report && is_success(report)),
            _ => unreachable!("{answer:?}, then {report:?}"),
        }
        rig.check_belief();
        if is_suspended(report) {
            assert_eq!(rig.resume(2), Answer::Accepted);
            rig.until(120.0);
        }
        assert!(is_success(rig.told(2).last().expect("an end")));
        assert!((rig.odometer_m() - 6.0).abs() < 1e-9);
        assert!(rig.believes("at n4"));
        rig.check_belief();
    }
    assert!(stopped > 500 && arrived > 50, "{stopped}, {arrived}");
}

#[test]
fn a_robot_that_only_turned_stands_at_its_node_still() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n4 arc7");
    rig.until(1.0);
    assert_eq!(rig.suspend(1), Answer::Suspending);
    assert!(is_suspended(rig.only(1).1));
    assert!(rig.believes("at n1") && !rig.believes("on arc7"));
    rig.check_belief();
    let before_rad = rig.robot.world().pose(rig.now).heading_rad;
    assert!((before_rad.abs() - 1.5).abs() < 1e-6, "{before_rad}");
    rig.resume(1);
    rig.until(60.0);
    assert!(rig.believes("at n4"));
    // π in two pieces, then the way.
    let (at, ..) = rig.reports.last().expect("an end");
    let expected_s = std::f64::consts::PI / 1.5 + 3.0 + 1.5;
    assert!((at.secs() - expected_s).abs() < 1e-5, "{at:?}");
}

#[test]
fn an_explanation_goes_on_in_the_middle_of_the_sentence() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "narrate n1");
    rig.until(12.25);
    assert_eq!(rig.suspend(1), Answer::Suspending);
    assert!(is_suspended(rig.only(1).1));
    assert!(!rig.robot.world().pose(rig.now).speaking);
    rig.until(100.0);
    rig.resume(1);
    rig.until(105.0);
    rig.suspend(1);
    rig.until(200.0);
    rig.resume(1);
    rig.until(300.0);
    let (at, ..) = rig.reports.last().expect("an end");
    assert!((at.secs() - (200.0 + 30.0 - 12.25 - 5.0)).abs() < 1e-5);
    assert!(is_success(rig.told(1)[2]));
}

#[test]
fn two_records_are_held_one_inside_the_other() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "narrate n1");
    rig.until(10.0);
    rig.suspend(1);
    rig.execute(2, "move n1 n6 arc5");
    rig.until(13.0);
    rig.suspend(2);
    rig.until(15.0);
    assert_eq!(rig.events.last().map(|event| event.stack_depth), Some(2));
    rig.execute(3, "hail guest");
    rig.until(17.0);
    assert!(is_success(rig.only(3).1));
    assert_eq!(rig.resume(2), Answer::Accepted);
    rig.until(25.0);
    assert!(rig.believes("at n6"));
    assert_eq!(rig.resume(1), Answer::Accepted);
    rig.until(60.0);
    let (at, last, report) = rig.reports.last().expect("an end");
    assert!(*last == id(1) && is_success(report));
    assert!((at.secs() - 45.0).abs() < 1e-5);
}

#[test]
fn a_record_that_does_not_fit_fails_and_says_why() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(3.0);
    rig.suspend(1);
    rig.until(5.0);
    rig.execute(2, "leave arc5 n1");
    rig.until(20.0);
    rig.execute(3, "move n1 n4 arc7");
    rig.until(40.0);
    assert_eq!(rig.resume(1), Answer::Accepted);
    assert_eq!(
        reason(rig.told(1)[1]),
        "the record does not fit: the robot stands at n4"
    );
    rig.check_belief();
    // The record is gone, and the outcome remembered.
    let Answer::Finished { outcome } = rig.resume(1) else {
        unreachable!("it is over");
    };
    assert_eq!(&outcome, rig.told(1)[1]);
}

#[test]
fn a_record_of_a_drive_is_good_at_either_end_of_its_arc() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(3.0);
    rig.suspend(1);
    rig.until(5.0);
    rig.execute(2, "return n1 arc5");
    rig.until(20.0);
    assert_eq!(rig.resume(1), Answer::Accepted);
    rig.until(60.0);
    assert!(is_success(rig.told(1)[1]) && rig.believes("at n6"));
    rig.check_belief();
}

#[test]
fn a_started_report_comes_before_and_again_after() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "narrate n1");
    rig.suspend(1);
    rig.resume(1);
    let kinds: Vec<_> = rig
        .reports
        .iter()
        .map(|(_, _, report)| matches!(report, Report::Started))
        .collect();
    assert_eq!(kinds, [true, false, true]);
}

#[test]
fn a_robot_whose_controller_is_about_to_end_stops_and_remembers_what_it_did() {
    let mut rig = Rig::new("n4");
    rig.until(1.0);
    assert!(rig.robot.rests());
    rig.execute(1, "move n4 n1 arc7");
    rig.until(3.5);
    assert!(!rig.robot.rests());
    rig.robot.wind_down(rig.now);
    rig.until(20.0);
    assert!(rig.robot.rests());
    assert!(is_suspended(rig.only(1).1));
    assert!(!rig.believes("at n1"));
    assert_eq!(rig.resume(1), Answer::Accepted);
    rig.until(60.0);
    assert!(is_success(rig.told(1).last().expect("an end")));
}

#[test]
fn it_is_told_when_the_motors_are_told_to_stop_and_seen_when_the_body_does() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(3.0);
    assert_eq!(rig.robot.world().motion(), (Motion::Driving, Time::ZERO));
    rig.suspend(1);
    let stopping = |event: &&Event| matches!(event.what, Happening::ActionStopping { .. });
    let told: Vec<_> = rig.events.iter().filter(stopping).collect();
    assert_eq!(told.len(), 1);
    assert_eq!(told.first().map(|event| event.at), Some(rig.now));
    let braking = (Motion::Braking, rig.now);
    assert_eq!(rig.robot.world().motion(), braking);
    // Once is enough.
    rig.suspend(1);
    assert_eq!(rig.events.iter().filter(stopping).count(), 1);
    rig.until(20.0);
    let (motion, since) = rig.robot.world().motion();
    assert_eq!(motion, Motion::Still);
    // From 1 m/s, at 1 m/s².
    assert!(
        (since.since(braking.1).secs() - 1.0).abs() < 1e-3,
        "{since:?}"
    );
}
