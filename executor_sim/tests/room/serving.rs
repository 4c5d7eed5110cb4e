//! A drink from the counter to a guest.

use agent_core::model::Time;
use agent_core::protocol::{Answer, Report};
use executor_sim::{Room, RoomDoing, Spot, Tempo};

use crate::rig::Rig;

#[test]
fn a_drink_is_served_in_the_documented_time() {
    let mut rig = Rig::new();
    rig.change("(seated ann table1)");
    rig.done("k3", "(grasp cola1 ann kitchen)");
    assert_eq!(rig.now.secs(), 30.0);
    rig.done("k3", "(put-on-tray cola1 slot1 kitchen)");
    assert_eq!(rig.now.secs(), 45.0);
    rig.done("k3", "(move kitchen table1 kitchen-table1)");
    assert_eq!(rig.now.secs(), 85.0);
    rig.done("k3", "(take-from-tray cola1 slot1 table1)");
    rig.done("k3", "(put-drink cola1 cola ann table1)");
    assert_eq!(rig.now.secs(), 117.0);
    assert!(matches!(rig.spot("cola1"), Spot::Proper { node } if *node == "table1"));
    for fact in [
        "(at table1)",
        "(served ann cola)",
        "(stands cola1 table1)",
        "(hand-free)",
        "(empty slot1)",
    ] {
        assert!(rig.believes("k3", fact), "{fact}");
    }
    let served = rig.done_of(|doing| matches!(doing, RoomDoing::Served { .. }));
    assert_eq!(served, 1);
}

#[test]
fn parts_work_at_the_same_time_and_each_does_one_thing() {
    let mut rig = Rig::new();
    let watch = rig.start("k3", "(look ann kitchen)");
    let grasp = rig.start("k3", "(grasp cola1 ann kitchen)");
    let welcome = rig.start("k3", "(welcome ann kitchen)");
    let (_, second) = rig.begin("k3", "(grasp cola2 ann kitchen)");
    assert!(
        matches!(&second, Answer::Rejected { reason } if reason.contains("the arm is busy with (grasp cola1")),
        "{second:?}"
    );
    let (_, second) = rig.begin("k3", "(look ben kitchen)");
    assert!(
        matches!(&second, Answer::Rejected { reason } if reason.contains("the eyes are busy")),
        "{second:?}"
    );
    for (id, at_s) in [(&watch, 3.0), (&welcome, 4.0), (&grasp, 30.0)] {
        assert!(matches!(
            rig.run_until_end(id),
            Some(Report::Success { .. })
        ));
        assert_eq!(rig.now.secs(), at_s);
    }
    // The tray is put in order and somebody is spoken to while the base drives.
    let stow = rig.start("k3", "(put-on-tray cola1 slot1 kitchen)");
    let drive = rig.start("k3", "(move kitchen table1 kitchen-table1)");
    let speak = rig.start("k3", "(welcome ann kitchen)");
    for (id, at_s) in [(&speak, 34.0), (&stow, 45.0), (&drive, 70.0)] {
        assert!(matches!(
            rig.run_until_end(id),
            Some(Report::Success { .. })
        ));
        assert_eq!(rig.now.secs(), at_s);
    }
    assert!(rig.believes("k3", "(loaded cola1 slot1)"));
}

#[test]
fn whoever_drives_off_reaches_for_nothing() {
    let mut rig = Rig::new();
    let grasp = rig.start("k3", "(grasp cola1 ann kitchen)");
    rig.run_s(10.0);
    rig.start("k3", "(move kitchen table1 kitchen-table1)");
    let Some(Report::Failure { reason, .. }) = rig.end_of(&grasp) else {
        unreachable!("the bottle is out of reach");
    };
    assert!(reason.contains("does not stand at a place"), "{reason}");
    assert!(matches!(rig.spot("cola1"), Spot::Edge { .. }));
}

#[test]
fn of_two_who_reach_for_one_bottle_one_gets_it_and_the_other_is_told_why_not() {
    let plan = {
        let mut plan = crate::rig::paper().room().clone();
        let k3 = plan.vehicles["k3"].clone();
        plan.vehicles.insert("k4".into(), k3);
        plan
    };
    let restaurant = crate::rig::paper().with_room(plan).expect("two carriers");
    let room = Room::new(&restaurant).expect("a room for two carriers");
    for later_s in [0.0, 0.1, 15.0, 29.9, 30.0, 31.0] {
        let mut rig = Rig::of(room.clone());
        let first = rig.start("k3", "(grasp cola1 ann kitchen)");
        rig.run_s(later_s);
        let second = rig.start("k4", "(grasp cola1 ben kitchen)");
        let Some(Report::Failure {
            reason, blocked_by, ..
        }) = rig.run_until_end(&second)
        else {
            unreachable!("two have it");
        };
        assert!(reason.contains("k3"), "{reason}");
        assert_eq!(
            blocked_by,
            [crate::rig::parse_fact("(stands cola1 kitchen)")]
        );
        assert!(matches!(
            rig.run_until_end(&first),
            Some(Report::Success { .. })
        ));
        assert!(rig.believes("k3", "(holding cola1)"));
        // Both stand in the kitchen and see whose it is.
        assert!(!rig.believes("k4", "(stands cola1 kitchen)"));
        let other = rig.start("k4", "(grasp cola2 ben kitchen)");
        rig.run_until_end(&other);
        assert!(rig.believes("k4", "(holding cola2)"));
    }
}

#[test]
fn a_drive_takes_its_length_divided_by_the_speed_and_nothing_else() {
    for (from, to, way, seconds) in [
        ("kitchen", "table1", "kitchen-table1", 40.0),
        ("kitchen", "table2", "kitchen-table2", 48.0),
    ] {
        let mut rig = Rig::new();
        rig.done("k3", &format!("(move {from} {to} {way})"));
        assert_eq!(rig.now.secs(), seconds);
        rig.done("k3", &format!("(move {to} {from} {way})"));
        assert_eq!(rig.now.secs(), 2.0 * seconds);
    }
}

#[test]
fn a_tempo_scales_everything_that_is_begun() {
    let slow = Room::new(&crate::rig::paper())
        .expect("a room")
        .with_tempo(Tempo::new(|_| 1.5));
    let mut rig = Rig::of(slow);
    rig.done("k3", "(grasp cola1 ann kitchen)");
    assert_eq!(rig.now.secs(), 45.0);
    rig.done("k3", "(put-on-tray cola1 slot1 kitchen)");
    rig.done("k3", "(move kitchen table1 kitchen-table1)");
    assert_eq!(rig.now.secs(), 45.0 + 22.5 + 60.0);
    // By chance, the same things take equally long whoever does them and whenever.
    let varied = |wait_s| {
        let room = Room::new(&crate::rig::paper()).expect("a room");
        let mut rig = Rig::of(room.with_tempo(Tempo::varied(7, 0.15)));
        rig.run_s(wait_s);
        rig.done("k3", "(grasp cola1 ann kitchen)");
        rig.now.since(Time::from_secs(wait_s))
    };
    assert_eq!(varied(0.0), varied(100.0));
    let seconds = varied(0.0).secs();
    assert!((25.5..34.5).contains(&seconds) && seconds != 30.0);
}

#[test]
fn only_what_asks_is_told_what_a_guest_wants() {
    let mut rig = Rig::new();
    rig.change("(seated ben table2)");
    assert!(rig.believes("k2", "(seated ben table2)"), "it stands there");
    assert!(!rig.believes("k3", "(seated ben table2)"));
    assert!(!rig.believes("k2", "(wants ben juice)"));
    rig.done("k2", "(ask ben table2)");
    assert!(rig.believes("k2", "(wants ben juice)"));
    assert!(!rig.believes("k2", "(wants ben cola)"));
    assert!(!rig.believes("k3", "(wants ben juice)"));
}

#[test]
fn a_watcher_sees_who_comes_and_goes() {
    let mut rig = Rig::new();
    rig.change("(arrived ann)");
    assert!(rig.believes("k1", "(arrived ann)") && !rig.believes("k2", "(arrived ann)"));
    rig.change("(seated ann table1)");
    assert!(!rig.believes("k1", "(arrived ann)"));
    rig.change("(gone ann)");
    assert!(rig.believes("k1", "(gone ann)"));
    let (_, answer) = rig.begin("k1", "(grasp cola1 ann kitchen)");
    assert!(
        matches!(&answer, Answer::Rejected { reason } if reason.contains("k1 has no arm")),
        "{answer:?}"
    );
}

#[test]
fn guests_come_sit_and_go_by_plan() {
    let mut plan = crate::rig::paper().room().clone();
    let ann = plan.guests.get_mut("ann").expect("ann");
    (ann.arrives_s, ann.sits_s, ann.leaves_s) = (Some(5.0), Some(12.0), Some(300.0));
    let restaurant = crate::rig::paper().with_room(plan).expect("a plan for ann");
    let mut rig = Rig::of(Room::new(&restaurant).expect("a room"));
    rig.run_until(Time::from_secs(6.0));
    assert!(rig.believes("k1", "(arrived ann)"));
    rig.run_until(Time::from_secs(20.0));
    assert!(!rig.believes("k1", "(arrived ann)"));
    let mut sent_away = rig.clone();
    rig.run_until(Time::from_secs(301.0));
    assert!(rig.believes("k1", "(gone ann)"));
    // Whoever says otherwise decides from then on.
    sent_away.change("(arrived ann)");
    sent_away.run_until(Time::from_secs(301.0));
    assert!(sent_away.believes("k1", "(arrived ann)"));
}
