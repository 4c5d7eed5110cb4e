//! Users who take things away and get in the way, and parts that do not do as they are told.

use agent_core::model::Time;
use agent_core::protocol::{Answer, Report};
use executor_sim::{Fault, Faults, PartName, Room, Spot};

use crate::interruption::{before, moments};
use crate::rig::{Rig, facts_of, paper, parse_fact};

fn failure(rig: &Rig, id: &agent_core::protocol::ActionId) -> (String, Vec<String>) {
    match rig.end_of(id) {
        Some(Report::Failure {
            reason, blocked_by, ..
        }) => {
            let facts = blocked_by.iter().map(ToString::to_string);
            (reason.clone(), facts.collect())
        }
        other => unreachable!("it cannot be done any more: {other:?}"),
    }
}

#[test]
fn a_drink_that_is_taken_away_at_any_moment_fails_what_is_done_with_it() {
    // Which step, what is done then, and what somebody does.
    for (step, action, accident) in [
        (
            3,
            "(grasp cola1 ann kitchen)",
            "(not (stands cola1 kitchen))",
        ),
        (
            4,
            "(put-on-tray cola1 slot1 kitchen)",
            "(not (holding cola1))",
        ),
        (
            6,
            "(take-from-tray cola1 slot1 table1)",
            "(not (loaded cola1 slot1))",
        ),
        (
            7,
            "(put-drink cola1 cola ann table1)",
            "(not (with cola1 k3))",
        ),
    ] {
        let ready = before(step);
        for moment_s in moments(11.9) {
            let mut rig = ready.clone();
            let id = rig.start("k3", action);
            rig.run_s(moment_s);
            rig.change(accident);
            let (reason, blocked_by) = failure(&rig, &id);
            assert!(reason.contains("cola1"), "{action}: {reason}");
            assert!(blocked_by.len() <= 1, "{blocked_by:?}");
            assert_eq!(*rig.spot("cola1"), Spot::Away);
            for fact in [
                "(holding cola1)",
                "(loaded cola1 slot1)",
                "(stands cola1 kitchen)",
            ] {
                assert!(!rig.believes("k3", fact), "{action} at {moment_s}: {fact}");
            }
            assert!(rig.believes("k3", "(hand-free)"));
            // The arm is free for another.
            assert!(matches!(
                rig.begin("k3", "(wipe kitchen)"),
                (_, Answer::Accepted)
            ));
        }
    }
}

#[test]
fn a_guest_who_leaves_at_any_moment_is_not_served() {
    let ready = before(7);
    for moment_s in moments(19.9) {
        let mut rig = ready.clone();
        let id = rig.start("k3", "(put-drink cola1 cola ann table1)");
        rig.run_s(moment_s);
        rig.change("(gone ann)");
        let (reason, blocked_by) = failure(&rig, &id);
        assert!(
            reason.contains("ann does not sit at table1 but is gone"),
            "{reason}"
        );
        assert_eq!(blocked_by, ["(seated ann table1)"]);
        assert!(rig.believes("k3", "(holding cola1)"), "it is not lost");
        assert!(!rig.believes("k3", "(seated ann table1)"));
    }
}

#[test]
fn what_a_guest_leaves_behind_is_empty_and_can_be_cleared_away() {
    let mut rig = before(8);
    assert!(!rig.believes("k3", "(used cola1)"));
    rig.change("(gone ann)");
    assert!(rig.believes("k3", "(used cola1)"));
    rig.done("k3", "(collect cola1 table1)");
    assert!(rig.believes("k3", "(holding cola1)"));
}

#[test]
fn a_blocked_table_is_seen_by_who_drives_there_and_nobody_sets_off_to_it() {
    let mut rig = before(5);
    rig.change("(blocked table1)");
    assert!(!rig.believes("k3", "(blocked table1)"), "it is far away");
    let (_, answer) = rig.begin("k3", "(move kitchen table1 kitchen-table1)");
    assert!(
        matches!(&answer, Answer::Rejected { reason } if reason.contains("table1 is blocked")),
        "{answer:?}"
    );
    assert!(rig.believes("k3", "(blocked table1)"));
    for moment_s in moments(39.9) {
        let mut rig = before(5);
        let id = rig.start("k3", "(move kitchen table1 kitchen-table1)");
        rig.run_s(moment_s);
        rig.change("(blocked table1)");
        assert!(rig.believes("k3", "(blocked table1)"), "at {moment_s}");
        assert_eq!(rig.suspend("k3", &id), Answer::Suspending);
        rig.run_to_rest();
        assert!(matches!(rig.resume("k3", &id), Answer::Rejected { .. }));
        rig.change("(not (blocked table1))");
        assert_eq!(rig.resume("k3", &id), Answer::Accepted);
        rig.run_until_end(&id);
        assert!(rig.believes("k3", "(at table1)"));
    }
}

#[test]
fn a_spill_is_seen_where_it_is_and_wiped_up() {
    let mut rig = before(6);
    rig.change("(spill table1)");
    assert!(rig.believes("k3", "(spill table1)") && rig.believes("k2", "(spill table1)"));
    assert!(!rig.believes("k1", "(spill table1)"));
    let id = rig.start("k3", "(wipe table1)");
    rig.run_s(10.0);
    rig.suspend("k3", &id);
    rig.run_to_rest();
    assert!(rig.believes("k3", "(spill table1)"));
    let stopped = rig.now;
    rig.resume("k3", &id);
    rig.run_until_end(&id);
    assert_eq!(rig.now.since(stopped), Time::from_secs(15.0), "the rest");
    assert!(!rig.believes("k3", "(spill table1)") && !rig.believes("k2", "(spill table1)"));
}

#[test]
fn what_is_reported_is_all_that_the_vehicle_knows() {
    let mut rig = before(3);
    let id = rig.start("k3", "(grasp cola1 ann kitchen)");
    rig.run_until_end(&id);
    let report = rig.end_of(&id).expect("it has ended");
    let told = |text: &str, so: bool| {
        let fact = parse_fact(text);
        facts_of(report).iter().any(|change| match change {
            agent_core::model::FactChange::Add(added) => so && *added == fact,
            agent_core::model::FactChange::Remove(removed) => !so && *removed == fact,
            agent_core::model::FactChange::Set(..) => false,
        })
    };
    for (text, so) in [
        ("(holding cola1)", true),
        ("(with cola1 k3)", true),
        ("(hand-free)", false),
        ("(stands cola1 kitchen)", false),
        ("(edge cola1 kitchen)", false),
        ("(stands cola1 table3)", false),
        ("(with cola1 k2)", false),
        ("(stands cola2 kitchen)", true),
        ("(holding cola2)", false),
        ("(empty slot1)", true),
        ("(at kitchen)", true),
        ("(at table1)", false),
        ("(spill kitchen)", false),
    ] {
        assert!(told(text, so), "{text} {so}");
    }
    // What is out of sight nobody speaks of.
    for text in ["(seated ann table1)", "(spill table1)", "(arrived ann)"] {
        assert!(!told(text, true) && !told(text, false), "{text}");
    }
}

#[test]
fn parts_fail_stop_late_refuse_and_are_slow_as_the_list_has_it() {
    let with = |fault| {
        let room = Room::new(&paper()).expect("a room");
        let faults = Faults::list([(1, fault)]);
        Rig::of(room.with_faults("k3", PartName::Arm, faults))
    };
    let grasp = "(grasp cola1 ann kitchen)";

    let mut rig = with(Fault::Failure { fraction: 0.5 });
    let id = rig.start("k3", grasp);
    rig.run_until_end(&id);
    let (reason, _) = failure(&rig, &id);
    assert!(reason.contains("failed on the way"), "{reason}");
    // Half lifted, it is set down first.
    assert_eq!(rig.now, Time::from_secs(15.0 + 1.5));
    assert!(rig.believes("k3", "(edge cola1 kitchen)"));

    let mut rig = with(Fault::LateStop {
        delay: Time::from_secs(2.0),
    });
    let id = rig.start("k3", grasp);
    rig.run_s(10.0);
    assert_eq!(rig.suspend("k3", &id), Answer::Suspending);
    rig.run_to_rest();
    assert_eq!(rig.now, Time::from_secs(12.0 + 1.2));
    assert_eq!(rig.suspensions_of(&id), 1);

    let mut rig = with(Fault::RefusedSuspension);
    let id = rig.start("k3", grasp);
    rig.run_s(10.0);
    let finishes_in = Time::from_secs(20.0);
    assert_eq!(rig.suspend("k3", &id), Answer::Refused { finishes_in });
    assert!(matches!(
        rig.run_until_end(&id),
        Some(Report::Success { .. })
    ));

    let mut rig = with(Fault::Slow { pace: 0.5 });
    rig.done("k3", grasp);
    assert_eq!(rig.now, Time::from_secs(60.0));
    // The next one is as quick as ever.
    rig.done("k3", "(put-on-tray cola1 slot1 kitchen)");
    assert_eq!(rig.now, Time::from_secs(75.0));
}

#[test]
fn a_suspension_that_comes_late_may_find_it_done() {
    let room = Room::new(&paper()).expect("a room");
    let delay = Time::from_secs(5.0);
    let faults = Faults::list([(1, Fault::LateStop { delay })]);
    let mut rig = Rig::of(room.with_faults("k3", PartName::Arm, faults));
    let id = rig.start("k3", "(grasp cola1 ann kitchen)");
    rig.run_s(27.0);
    assert_eq!(rig.suspend("k3", &id), Answer::Suspending);
    let end = rig.run_until_end(&id);
    assert!(matches!(end, Some(Report::Success { .. })), "{end:?}");
    assert_eq!(rig.suspensions_of(&id), 0, "never both");
}
