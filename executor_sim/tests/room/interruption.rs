//! Every action of every part, stopped at many moments of it.

use agent_core::protocol::{Answer, Report};
use executor_sim::{RoomDoing, Spot};

use crate::rig::Rig;

/// What a vehicle does one after another to serve a drink at table 1, each with the time that it takes.
pub const SERVING: [(&str, &str, f64); 10] = [
    ("k2", "(move table2 table1 table1-table2)", 23.0),
    ("k2", "(detect ann table1)", 66.0),
    ("k2", "(ask ann table1)", 10.0),
    ("k3", "(grasp cola1 ann kitchen)", 30.0),
    ("k3", "(put-on-tray cola1 slot1 kitchen)", 15.0),
    ("k3", "(move kitchen table1 kitchen-table1)", 40.0),
    ("k3", "(take-from-tray cola1 slot1 table1)", 12.0),
    ("k3", "(put-drink cola1 cola ann table1)", 20.0),
    ("k3", "(wipe table1)", 25.0),
    ("k3", "(collect cola1 table1)", 30.0),
];

/// With everything done that comes before that step.
pub fn before(step: usize) -> Rig {
    let mut rig = Rig::new();
    rig.change("(seated ann table1)");
    for (vehicle, action, _) in &SERVING[..step] {
        if action.starts_with("(wipe") {
            rig.change("(spill table1)");
        }
        rig.done(vehicle, action);
    }
    if SERVING[step].1.starts_with("(wipe") {
        rig.change("(spill table1)");
    }
    rig
}

/// Moments of an action: its beginning, its end, and many in between.
pub fn moments(duration_s: f64) -> impl Iterator<Item = f64> {
    let many = 24;
    (0..=many).map(move |part| duration_s * f64::from(part) / f64::from(many))
}

pub fn served(rig: &Rig) -> usize {
    rig.done_of(|doing| matches!(doing, RoomDoing::Served { .. }))
}

#[test]
fn what_is_stopped_at_any_moment_is_resumed_and_done_once() {
    for (step, (vehicle, action, duration_s)) in SERVING.iter().enumerate() {
        let ready = before(step);
        for moment_s in moments(*duration_s) {
            let mut rig = ready.clone();
            let deeds = rig.room.done_count();
            let id = rig.start(vehicle, action);
            rig.run_s(moment_s);
            let case = format!("{action} at {moment_s}");
            match rig.suspend(vehicle, &id) {
                Answer::Suspending => {
                    rig.run_to_rest();
                    assert_eq!(rig.suspensions_of(&id), 1, "{case}");
                    assert_eq!(rig.end_of(&id), None, "{case}");
                    assert_eq!(rig.resume(vehicle, &id), Answer::Accepted, "{case}");
                }
                Answer::Finished { outcome } => {
                    assert!(moment_s >= *duration_s, "{case}");
                    assert!(matches!(outcome, Report::Success { .. }), "{case}");
                }
                Answer::Refused { finishes_in } => {
                    assert!(action.starts_with("(put-drink"), "{case}");
                    let left_s = duration_s - moment_s;
                    assert!((finishes_in.secs() - left_s).abs() < 1e-5, "{case}");
                }
                other => unreachable!("{case}: {other:?}"),
            }
            let end = rig.run_until_end(&id);
            assert!(
                matches!(end, Some(Report::Success { .. })),
                "{case}: {end:?}"
            );
            let drives = usize::from(action.starts_with("(move"));
            let hasty = rig.done_of(|doing| matches!(doing, RoomDoing::SetDownInHaste { .. }));
            let done = usize::try_from(rig.room.done_count() - deeds).expect("a small number");
            assert_eq!(done - hasty, 1 - drives, "{case}: done once");
            assert_eq!(served(&rig), usize::from(step >= 7), "{case}");
        }
    }
}

#[test]
fn a_grasp_that_is_stopped_leaves_the_bottle_at_the_edge_within_three_seconds() {
    let ready = before(3);
    let mut longest_s: f64 = 0.0;
    for moment_s in moments(29.9) {
        let mut rig = ready.clone();
        let id = rig.start("k3", "(grasp cola1 ann kitchen)");
        rig.run_s(moment_s);
        assert_eq!(rig.suspend("k3", &id), Answer::Suspending);
        // As long as it is in the air, nobody has said that it stands.
        let before = rig.now;
        rig.run_to_rest();
        longest_s = longest_s.max(rig.now.since(before).secs());
        assert!(rig.now.since(before).secs() <= 3.0);
        assert!(matches!(rig.spot("cola1"), Spot::Edge { node } if *node == "kitchen"));
        for fact in ["(edge cola1 kitchen)", "(hand-free)"] {
            assert!(rig.believes("k3", fact), "{fact} at {moment_s}");
        }
        for fact in ["(stands cola1 kitchen)", "(holding cola1)"] {
            assert!(!rig.believes("k3", fact), "{fact} at {moment_s}");
        }
        // The other way: it is given up, and the bottle set back.
        assert_eq!(rig.clear("k3", &id), Answer::Accepted);
        rig.done("k3", "(set-back cola1 kitchen)");
        assert!(rig.believes("k3", "(stands cola1 kitchen)"));
        assert!(matches!(rig.spot("cola1"), Spot::Proper { .. }));
        assert!(matches!(rig.resume("k3", &id), Answer::Rejected { .. }));
    }
    assert!(longest_s > 2.9);
}

#[test]
fn an_arm_that_is_stopped_does_something_else_and_then_goes_on() {
    let ready = before(4);
    for moment_s in moments(14.9) {
        let mut rig = ready.clone();
        let id = rig.start("k3", "(put-on-tray cola1 slot1 kitchen)");
        rig.run_s(moment_s);
        assert_eq!(rig.suspend("k3", &id), Answer::Suspending);
        rig.run_to_rest();
        // Still in the hand: put down, something else is grasped and put away, and this one again.
        assert!(rig.believes("k3", "(holding cola1)"));
        rig.done("k3", "(put-down cola1 kitchen)");
        rig.done("k3", "(grasp juice1 ben kitchen)");
        rig.done("k3", "(put-on-tray juice1 slot2 kitchen)");
        rig.done("k3", "(grasp cola1 ann kitchen)");
        let before = rig.now;
        assert_eq!(rig.resume("k3", &id), Answer::Accepted);
        rig.run_until_end(&id);
        // What was left of it is what it takes.
        let left_s = 15.0 - moment_s;
        assert!((rig.now.since(before).secs() - left_s).abs() < 1e-5);
        assert!(rig.believes("k3", "(loaded cola1 slot1)"));
        assert!(rig.believes("k3", "(loaded juice1 slot2)"));
    }
}

#[test]
fn what_is_resumed_where_it_cannot_be_fails_and_says_why() {
    let mut rig = before(3);
    let id = rig.start("k3", "(grasp cola1 ann kitchen)");
    rig.run_s(10.0);
    rig.suspend("k3", &id);
    rig.run_to_rest();
    rig.done("k3", "(move kitchen table1 kitchen-table1)");
    assert_eq!(rig.resume("k3", &id), Answer::Accepted);
    let Some(Report::Failure {
        reason, blocked_by, ..
    }) = rig.end_of(&id)
    else {
        unreachable!("the record does not fit: {:?}", rig.end_of(&id));
    };
    assert!(
        reason.contains("cola1 is not at table1, it is at the edge of kitchen"),
        "{reason}"
    );
    assert_eq!(blocked_by.len(), 1);
}

#[test]
fn any_number_of_records_is_kept_in_each_part() {
    let mut rig = before(3);
    let mut kept = Vec::new();
    for bottle in ["cola1", "cola2", "juice1", "juice2"] {
        let id = rig.start("k3", &format!("(grasp {bottle} ann kitchen)"));
        rig.run_s(7.0);
        assert_eq!(rig.suspend("k3", &id), Answer::Suspending);
        rig.run_to_rest();
        kept.push(id);
    }
    assert_eq!(rig.resume("k3", &kept[1]), Answer::Accepted);
    assert!(
        matches!(rig.resume("k3", &kept[2]), Answer::Rejected { reason } if reason.contains("busy"))
    );
    rig.run_until_end(&kept[1]);
    assert!(rig.believes("k3", "(holding cola2)"));
    for id in [&kept[0], &kept[2], &kept[3]] {
        assert_eq!(rig.clear("k3", id), Answer::Accepted);
    }
}
