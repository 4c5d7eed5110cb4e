//! What may go wrong, and how it looks from above.

use agent_core::model::Time;
use agent_core::protocol::{Answer, Durable};
use executor_sim::{Fault, FaultRates, Faults};

use crate::rig::{Rig, is_success, is_suspended, reason};

fn rig_with(fault: Fault) -> Rig {
    Rig::with("n1", Faults::list([(1, fault)]))
}

#[test]
fn a_late_robot_says_yes_at_once_and_stops_later() {
    let delay = Time::from_secs(1.5);
    let mut rig = rig_with(Fault::LateStop { delay });
    rig.execute(1, "move n1 n6 arc5");
    rig.until(3.0);
    assert_eq!(rig.suspend(1), Answer::Suspending);
    rig.until(60.0);
    let (at_s, report) = rig.only(1);
    assert!(is_suspended(report));
    assert!((at_s - 5.5).abs() < 5e-6, "{at_s}");
    assert!((rig.odometer_m() - 4.0).abs() < 1e-9);
    rig.check_belief();
    // What is resumed goes well.
    rig.resume(1);
    rig.until(61.0);
    rig.suspend(1);
    rig.until(62.0);
    assert!(is_suspended(rig.told(1)[1]));
}

#[test]
fn a_robot_that_is_too_late_arrives() {
    let delay = Time::from_secs(30.0);
    let mut rig = rig_with(Fault::LateStop { delay });
    rig.execute(1, "move n1 n6 arc5");
    rig.until(3.0);
    assert_eq!(rig.suspend(1), Answer::Suspending);
    rig.until(60.0);
    assert!(is_success(rig.only(1).1));
    assert_eq!(rig.robot.write_down(), {
        let mut undisturbed = Rig::new("n1");
        undisturbed.execute(1, "move n1 n6 arc5");
        undisturbed.until(60.0);
        undisturbed.robot.write_down()
    });
}

#[test]
fn a_robot_that_refuses_says_when_it_will_be_done() {
    let mut rig = rig_with(Fault::RefusedSuspension);
    rig.execute(1, "move n1 n6 arc5");
    rig.until(3.0);
    let finishes_in = Time::from_secs(4.5);
    assert_eq!(rig.suspend(1), Answer::Refused { finishes_in });
    rig.until(60.0);
    assert!(is_success(rig.only(1).1));
}

#[test]
fn an_action_that_fails_leaves_the_robot_standing_where_it_failed() {
    for (action, odometer_m) in [
        ("move n1 n6 arc5", 3.25),
        ("narrate n1", 0.0),
        ("shut d3", 0.0),
    ] {
        let mut rig = rig_with(Fault::Failure { fraction: 0.5 });
        rig.execute(1, action);
        rig.until(60.0);
        assert_eq!(
            reason(rig.only(1).1),
            format!("({action}) failed on the way")
        );
        assert!((rig.odometer_m() - odometer_m).abs() < 1e-5, "{action}");
        rig.check_belief();
        assert!(rig.believes("open d3"));
    }
}

#[test]
fn a_failing_robot_that_is_asked_to_stop_fails() {
    let mut rig = rig_with(Fault::Failure { fraction: 0.5 });
    rig.execute(1, "move n1 n6 arc5");
    rig.until(4.0);
    assert_eq!(rig.suspend(1), Answer::Suspending);
    rig.until(60.0);
    assert!(!reason(rig.only(1).1).is_empty());
    rig.check_belief();
}

#[test]
fn a_slow_robot_takes_its_time_and_does_all_of_it() {
    let mut rig = rig_with(Fault::Slow { pace: 0.5 });
    rig.execute(1, "move n1 n6 arc5");
    rig.until(60.0);
    // 1 s + 0.5 s for 0.375 m, the rest at half speed.
    let (at_s, _) = rig.only(1);
    assert!((at_s - 1.5 - 5.625 / 0.5).abs() < 2e-6, "{at_s}");

    let mut rig = rig_with(Fault::Slow { pace: 0.5 });
    rig.execute(1, "narrate n1");
    rig.until(20.0);
    rig.suspend(1);
    rig.resume(1);
    // 10 of 30 seconds' worth were said in 20; what is resumed goes well.
    rig.until(60.0);
    let (at, ..) = rig.reports.last().expect("an end");
    assert!((at.secs() - 40.0).abs() < 1e-5);
}

#[test]
fn faults_by_chance_are_the_same_again_from_the_same_seed() {
    let rates = FaultRates {
        late_stop_per_mille: 250,
        refused_suspension_per_mille: 250,
        failure_per_mille: 250,
        slow_per_mille: 250,
    };
    let run = |seed| {
        let mut rig = Rig::with("n1", Faults::random(seed, rates));
        for number in 1..=20 {
            rig.execute(number, "narrate n1");
            rig.until(rig.now.secs() + 3.0);
            rig.suspend(number);
            rig.until(rig.now.secs() + 200.0);
            rig.clear(number);
        }
        rig.reports
    };
    assert_eq!(run(3), run(3));
    assert_ne!(run(3), run(4));
}
