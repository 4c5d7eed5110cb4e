//! Processes that die: a vehicle's, and the room's own.

use agent_core::model::Symbol;
use agent_core::protocol::{Answer, Input, Report};
use executor_sim::{Room, Spot};

use crate::interruption::{SERVING, before, moments, served};
use crate::rig::{Rig, paper};

#[test]
fn a_vehicle_that_dies_stops_what_can_be_stopped_and_stands_with_what_it_holds() {
    for (step, (vehicle, action, duration_s)) in SERVING.iter().enumerate() {
        let ready = before(step);
        let name = Symbol::from(*vehicle);
        for moment_s in moments(*duration_s) {
            let mut rig = ready.clone();
            let id = rig.start(vehicle, action);
            rig.run_s(moment_s);
            let over = rig.end_of(&id).is_some();
            rig.tell(Input::Neighbour {
                name: name.clone(),
                there: false,
            });
            let died = rig.now;
            rig.run_to_rest();
            let case = format!("{action}, dead at {moment_s}");
            if action.starts_with("(put-drink") {
                // It cannot be stopped, and a guest is served by it.
                assert!(
                    matches!(rig.end_of(&id), Some(Report::Success { .. })),
                    "{case}"
                );
                assert_eq!(served(&rig), 1, "{case}");
                continue;
            }
            assert_eq!(rig.end_of(&id).is_some(), over, "{case}");
            assert!(rig.now.since(died).secs() <= 3.0, "{case}: it goes on");
            // Nothing is begun as long as nobody could stop it.
            let next = if *vehicle == "k2" {
                "(welcome ann table1)"
            } else {
                "(wipe table1)"
            };
            let waiting = rig.start(vehicle, next);
            rig.run_to_rest();
            assert_eq!(rig.reports_of(&waiting).count(), 0, "{case}");
            rig.tell(Input::Neighbour {
                name: name.clone(),
                there: true,
            });
            assert!(rig.reports_of(&waiting).next().is_some(), "{case}");
            rig.run_to_rest();
            // The same vehicle, back: its record is there.
            let resumed = rig.resume(vehicle, &id);
            if over {
                assert!(matches!(resumed, Answer::Finished { .. }), "{case}");
            } else {
                assert_eq!(resumed, Answer::Accepted, "{case}");
                let end = rig.run_until_end(&id);
                assert!(
                    matches!(end, Some(Report::Success { .. })),
                    "{case}: {end:?}"
                );
            }
        }
    }
}

#[test]
fn a_vehicle_without_memory_is_told_the_whole_truth_about_its_body() {
    for (step, (vehicle, action, duration_s)) in SERVING.iter().enumerate() {
        let ready = before(step);
        let name = Symbol::from(*vehicle);
        for moment_s in moments(*duration_s) {
            let mut rig = ready.clone();
            let id = rig.start(vehicle, action);
            rig.run_s(moment_s);
            let there = false;
            rig.tell(Input::Neighbour {
                name: name.clone(),
                there,
            });
            rig.run_to_rest();
            // Whoever comes now believes all sorts of things, and none of them is so.
            let wrong = agent_core::model::Belief::default();
            rig.beliefs.insert(name.clone(), wrong);
            let belief = rig.beliefs.get_mut(&name).expect("it is there");
            for fact in [
                "(at table3)",
                "(on kitchen-table3)",
                "(left kitchen)",
                "(holding water1)",
                "(loaded water2 slot3)",
                "(with water2 k3)",
                "(edge water1 kitchen)",
                "(edge water1 table1)",
                "(edge water1 table2)",
            ] {
                belief.apply(&agent_core::model::FactChange::Add(crate::rig::parse_fact(
                    fact,
                )));
            }
            let name = name.clone();
            rig.tell(Input::Reborn { name: name.clone() });
            rig.tell(Input::Neighbour { name, there: true });
            rig.run_to_rest();
            assert_true(&rig, vehicle);
            // Of what was, nothing is known.
            let unknown = rig.resume(vehicle, &id);
            assert!(matches!(unknown, Answer::Rejected { .. }), "{unknown:?}");
        }
    }
}

/// What the superior of a vehicle believes of its body is so.
pub fn assert_true(rig: &Rig, vehicle: &str) {
    let name = Symbol::from(vehicle);
    let mover = rig.room.mover(vehicle).expect("it has a body");
    let places = ["entrance", "kitchen", "table1", "table2", "table3"];
    let at = mover.stands_at(rig.now);
    for place in places {
        let so = at.as_ref().is_some_and(|at| at == place);
        assert_eq!(
            rig.believes(vehicle, &format!("(at {place})")),
            so,
            "{place}"
        );
    }
    let on = rig.beliefs[&name]
        .facts()
        .filter(|fact| fact.name == "on")
        .count();
    assert_eq!(on, usize::from(at.is_none()), "one place at a time");
    for (bottle, known) in rig.room.things().bottles() {
        let held = known.spot
            == Spot::Hand {
                vehicle: name.clone(),
            };
        if mover.has_arm() {
            assert_eq!(rig.believes(vehicle, &format!("(holding {bottle})")), held);
        }
        for slot in mover.slots() {
            let there = known.spot
                == Spot::Slot {
                    vehicle: name.clone(),
                    slot: slot.clone(),
                };
            let fact = format!("(loaded {bottle} {slot})");
            assert_eq!(rig.believes(vehicle, &fact), there, "{fact}");
        }
        let Some(at) = &at else { continue };
        let node = at.clone();
        let proper = known.spot == Spot::Proper { node };
        let fact = format!("(stands {bottle} {at})");
        assert_eq!(rig.believes(vehicle, &fact), proper, "{fact}");
        let node = at.clone();
        let edge = known.spot == Spot::Edge { node };
        let fact = format!("(edge {bottle} {at})");
        assert_eq!(rig.believes(vehicle, &fact), edge, "{fact}");
    }
}

#[test]
fn a_room_that_is_started_again_has_lost_nothing_and_does_nothing_twice() {
    for (step, (vehicle, action, duration_s)) in SERVING.iter().enumerate() {
        let ready = before(step);
        for moment_s in moments(*duration_s) {
            let mut rig = ready.clone();
            let id = rig.start(vehicle, action);
            rig.run_s(moment_s);
            let over = rig.end_of(&id).is_some();
            let case = format!("{action}, room dead at {moment_s}");
            rig.restart_room(Room::new(&paper()).expect("a room"));
            rig.run_to_rest();
            for name in ["k1", "k2", "k3"] {
                let name = Symbol::from(name);
                rig.tell(Input::Neighbour { name, there: true });
            }
            assert_true(&rig, vehicle);
            if over {
                assert_eq!(rig.suspensions_of(&id), 0, "{case}");
            } else if action.starts_with("(put-drink") {
                let end = rig.end_of(&id);
                assert!(
                    matches!(end, Some(Report::Failure { .. })),
                    "{case}: {end:?}"
                );
                assert_eq!(served(&rig), 0, "{case}");
                rig.done(vehicle, action);
            } else {
                assert_eq!(rig.suspensions_of(&id), 1, "{case}");
                assert_eq!(rig.resume(vehicle, &id), Answer::Accepted, "{case}");
                let end = rig.run_until_end(&id);
                assert!(
                    matches!(end, Some(Report::Success { .. })),
                    "{case}: {end:?}"
                );
            }
            assert_eq!(served(&rig), usize::from(step >= 7), "{case}");
        }
    }
}

#[test]
fn rows_of_another_restaurant_are_refused() {
    let rig = Rig::new();
    let mut plan = paper().room().clone();
    plan.bottles.remove("cola1");
    let other = paper().with_room(plan).expect("one bottle less");
    let mut room = Room::new(&other).expect("a room");
    let refused = agent_core::protocol::Durable::recall(&mut room, &rig.rows);
    assert!(
        refused
            .is_err_and(|why| why.key.contains("cola1") && why.reason.contains("no such bottle"))
    );
}

#[test]
fn what_was_suspended_or_over_before_a_room_started_again_is_so_after() {
    let mut rig = Rig::new();
    rig.change("(seated ann table1)");
    let over = rig.start("k3", "(grasp cola1 ann kitchen)");
    rig.run_until_end(&over);
    let kept = [
        ("k3", rig.start("k3", "(put-on-tray cola1 slot1 kitchen)")),
        ("k2", rig.start("k2", "(detect ann table2)")),
        ("k2", rig.start("k2", "(welcome ann table2)")),
        ("k2", rig.start("k2", "(move table2 table1 table1-table2)")),
    ];
    rig.run_s(3.0);
    for (vehicle, id) in &kept {
        // Speaking to a guest cannot be suspended in this domain.
        let answer = rig.suspend(vehicle, id);
        assert!(!matches!(answer, Answer::Rejected { .. }), "{answer:?}");
    }
    rig.run_to_rest();
    rig.restart_room(Room::new(&paper()).expect("a room"));
    assert!(matches!(rig.resume("k3", &over), Answer::Finished { .. }));
    for (vehicle, id) in &kept {
        let answer = rig.resume(vehicle, id);
        match rig.suspensions_of(id) {
            0 => assert!(matches!(answer, Answer::Finished { .. }), "{answer:?}"),
            _ => assert_eq!(answer, Answer::Accepted),
        }
        let end = rig.run_until_end(id);
        assert!(matches!(end, Some(Report::Success { .. })), "{end:?}");
    }
    assert!(rig.believes("k3", "(loaded cola1 slot1)") && rig.believes("k2", "(at table1)"));
}

#[test]
fn a_vehicle_that_has_lost_its_memory_and_was_not_missed_is_told_too() {
    let mut rig = before(4);
    let name = Symbol::from("k3");
    rig.beliefs
        .insert(name.clone(), agent_core::model::Belief::default());
    rig.tell(Input::Reborn { name });
    assert_true(&rig, "k3");
    assert!(rig.believes("k3", "(holding cola1)"));
}
