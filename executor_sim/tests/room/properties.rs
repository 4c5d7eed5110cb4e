//! Whatever several superiors say, and whatever happens to them and to the room.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{ActionId, Answer, Input, Report};
use executor_sim::{FaultRates, Room, RoomDoing, Whereabouts};
use maps::Restaurant;
use rand::prelude::*;
use rand_chacha::ChaCha8Rng;

use crate::death::assert_true;
use crate::rig::{Rig, paper};

const STEPS: usize = 400;
const SEEDS: u64 = 24;

const RATES: FaultRates = FaultRates {
    late_stop_per_mille: 60,
    refused_suspension_per_mille: 60,
    failure_per_mille: 60,
    slow_per_mille: 60,
};

/// A watcher, two that take orders and two that carry.
fn busy() -> Restaurant {
    let mut plan = paper().room().clone();
    for (new, like) in [("k4", "k2"), ("k5", "k3")] {
        let vehicle = plan.vehicles[like].clone();
        plan.vehicles.insert(new.into(), vehicle);
    }
    paper().with_room(plan).expect("five vehicles")
}

fn room(seed: u64) -> Room {
    let room = Room::new(&busy()).expect("a room");
    if seed.is_multiple_of(2) {
        room.with_chance(seed, RATES)
    } else {
        room
    }
}

fn any<'a>(rng: &mut ChaCha8Rng, of: &[&'a str]) -> &'a str {
    of.choose(rng).copied().unwrap_or_default()
}

/// What somebody would do who serves drinks.
fn sensible(rng: &mut ChaCha8Rng, rig: &Rig, vehicle: &str) -> Option<String> {
    let name = Symbol::from(vehicle);
    let things = rig.room.things();
    let mover = rig.room.mover(vehicle)?;
    let here = mover.stands_at(rig.now)?;
    let guest = things.guests().find(
        |(_, guest)| matches!(&guest.whereabouts, Whereabouts::Seated { table } if *table == here),
    );
    let slots = mover.slots().iter();
    let tray: Vec<_> = slots
        .map(|slot| (slot, things.in_slot(&name, slot)))
        .collect();
    let loaded = tray
        .iter()
        .find_map(|(slot, bottle)| Some((slot, (*bottle)?)));
    let empty = tray.iter().find(|(_, bottle)| bottle.is_none());
    let there = any(rng, &["kitchen", "table1", "table2", "table3"]);
    let mut ends = [here.as_str(), there];
    ends.sort_unstable();
    let drive = format!("(move {here} {there} {}-{})", ends[0], ends[1]);
    let stands = things
        .bottles()
        .find(|(_, bottle)| bottle.is_at(&here) && !bottle.used);
    Some(
        match (things.in_hand(&name), guest, loaded, empty, stands) {
            (Some(bottle), Some((guest, _)), ..) => {
                format!("(put-drink {bottle} cola {guest} {here})")
            }
            (Some(bottle), None, _, Some((slot, _)), _) => {
                format!("(put-on-tray {bottle} {slot} {here})")
            }
            (Some(bottle), ..) => format!("(put-down {bottle} {here})"),
            (None, Some(_), Some((slot, bottle)), ..) => {
                format!("(take-from-tray {bottle} {slot} {here})")
            }
            (None, None, None, _, Some((bottle, _))) => format!("(grasp {bottle} ann {here})"),
            _ => drive,
        },
    )
}

/// Some sense, and much nonsense.
fn any_action(rng: &mut ChaCha8Rng, rig: &Rig, vehicle: &str) -> String {
    let bottle = any(
        rng,
        &["cola1", "cola2", "juice1", "juice2", "water1", "glass"],
    );
    let slot = any(rng, &["slot1", "slot2", "slot3"]);
    let guest = any(rng, &["ann", "ben", "eva"]);
    let mover = rig.room.mover(vehicle).expect("it has a body");
    let here = mover.stands_at(rig.now);
    let here = here.as_ref().map_or("kitchen", Symbol::as_str);
    let places = ["entrance", "kitchen", "table1", "table2", "table3"];
    let there = any(rng, &places);
    let mut ends = [here, there];
    ends.sort_unstable();
    // Mostly what is in the hand or on the tray, so that something comes of it.
    let own = rig.room.things().bottles().find(|(_, bottle)| {
        let where_it_is = bottle.spot.to_string();
        where_it_is.contains(vehicle) && rng.random_bool(0.7)
    });
    let bottle = own.map_or(bottle, |(name, _)| name.as_str());
    let sits_here = rig.room.things().guests().find(
        |(_, guest)| matches!(&guest.whereabouts, Whereabouts::Seated { table } if *table == *here),
    );
    let guest = sits_here.map_or(guest, |(name, _)| name.as_str());
    match rng.random_range(0..17) {
        0..3 => format!("(grasp {bottle} {guest} {here})"),
        3 => format!("(put-on-tray {bottle} {slot} {here})"),
        4 => format!("(take-from-tray {bottle} {slot} {here})"),
        5..8 => format!("(put-drink {bottle} cola {guest} {here})"),
        8 => format!("(put-down {bottle} {here})"),
        9 => format!("(set-back {bottle} {here})"),
        10 => format!("(wipe {there})"),
        11 => format!("(ask {guest} {here})"),
        12 => format!("(recognise {guest} {here})"),
        13 => format!("(welcome {guest} {here})"),
        _ => format!("(move {here} {there} {}-{})", ends[0], ends[1]),
    }
}

fn any_change(rng: &mut ChaCha8Rng) -> String {
    let bottle = any(rng, &["cola1", "cola2", "juice1", "water1"]);
    let vehicle = any(rng, &["k3", "k5"]);
    let place = any(rng, &["kitchen", "table1", "table2", "table3", "moon"]);
    let guest = any(rng, &["ann", "ben", "eva"]);
    match rng.random_range(0..12) {
        0 => format!("(not (stands {bottle} {place}))"),
        1 => format!("(not (with {bottle} {vehicle}))"),
        2 => format!("(stands {bottle} {place})"),
        3 => format!("(spill {place})"),
        4 if rng.random_bool(0.3) => format!("(blocked {place})"),
        4 | 5 => format!("(not (blocked {place}))"),
        6 => format!("(arrived {guest})"),
        7 | 8 => format!("(seated {guest} {place})"),
        9 => format!("(gone {guest})"),
        10 => format!("(not (edge {bottle} {place}))"),
        _ => format!("(wants {guest} water)"),
    }
}

#[derive(Default)]
struct Known {
    accepted: BTreeMap<ActionId, String>,
    cleared: BTreeSet<ActionId>,
    forgotten: BTreeSet<ActionId>,
}

#[test]
fn no_instructions_and_no_accidents_break_a_law() {
    let (mut served, mut suspended, mut failed) = (0, 0, 0);
    for seed in 0..SEEDS {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let mut rig = Rig::of(room(seed));
        let mut known = Known::default();
        for step in 0..STEPS {
            let case = format!("seed {seed}, step {step}");
            do_anything(rng, &mut rig, &mut known, seed, &case);
        }
        for name in ["k1", "k2", "k3", "k4", "k5"] {
            let name = Symbol::from(name);
            rig.tell(Input::Neighbour { name, there: true });
        }
        rig.run_to_rest();
        check_reports(&rig, &known, &format!("seed {seed}"));
        check_ends(&rig, &known, &format!("seed {seed}, at rest"));
        for name in ["k1", "k2", "k3", "k4", "k5"] {
            assert_true(&rig, name);
        }
        check_chronicle(&rig, seed);
        served += rig.done_of(|doing| matches!(doing, RoomDoing::Served { .. }));
        let of_kind = |what: fn(&Report) -> bool| {
            let reports = rig.reports.iter();
            reports.filter(|(_, _, _, report)| what(report)).count()
        };
        suspended += of_kind(|report| matches!(report, Report::Suspended { .. }));
        failed += of_kind(|report| matches!(report, Report::Failure { .. }));
    }
    // What never happens has not been tried.
    assert!(
        served > 10 && suspended > 100 && failed > 400,
        "{served} served, {suspended} suspended, {failed} failed"
    );
}

fn do_anything(rng: &mut ChaCha8Rng, rig: &mut Rig, known: &mut Known, seed: u64, case: &str) {
    let vehicle = any(rng, &["k1", "k2", "k3", "k3", "k3", "k4", "k5", "k5", "k5"]);
    let ids: Vec<ActionId> = known
        .accepted
        .iter()
        .filter(|(_, whose)| *whose == vehicle)
        .map(|(id, _)| id.clone())
        .collect();
    // Mostly of what is not over.
    let open = ids.iter().filter(|id| !rig.over.contains(*id));
    let open = open.choose(rng).filter(|_| rng.random_bool(0.8));
    let id = open.or_else(|| ids.choose(rng)).cloned();
    match (rng.random_range(0..100), id) {
        (0..34, _) => {
            let sensible = sensible(rng, rig, vehicle).filter(|_| rng.random_bool(0.8));
            let action = sensible.unwrap_or_else(|| any_action(rng, rig, vehicle));
            let (id, answer) = rig.begin(vehicle, &action);
            if answer == Answer::Accepted {
                known.accepted.insert(id, vehicle.to_owned());
            }
        }
        (34..48, Some(id)) => {
            let answer = rig.suspend(vehicle, &id);
            if known.forgotten.contains(&id) {
                assert!(!matches!(answer, Answer::Accepted), "{case}");
            }
        }
        (48..60, Some(id)) => {
            rig.resume(vehicle, &id);
        }
        (60..65, Some(id)) => {
            if rig.clear(vehicle, &id) == Answer::Accepted {
                known.cleared.insert(id);
            }
        }
        (65..70, _) => {
            let change = any_change(rng);
            rig.change(&change);
        }
        (70..72, _) => {
            let there = rng.random_bool(0.7);
            let name = vehicle.into();
            rig.tell(Input::Neighbour { name, there });
        }
        (72, _) => {
            known.forgotten.extend(ids);
            let name = vehicle.into();
            rig.tell(Input::Reborn { name });
        }
        (73, _) if rng.random_bool(0.3) => rig.restart_room(room(seed)),
        _ => rig.run_until(rig.now + Time::from_secs(rng.random_range(0.0..40.0))),
    }
}

/// Reports of each execution come in an order that makes sense.
fn check_reports(rig: &Rig, known: &Known, case: &str) {
    for id in known.accepted.keys() {
        let mut runs = false;
        let mut over = false;
        for report in rig.reports_of(id) {
            assert!(!over, "{case}: {id} goes on after its end");
            match report {
                Report::Started => {
                    assert!(!runs, "{case}: {id} has begun twice");
                    runs = true;
                }
                // Given back before it has begun, too.
                Report::Suspended { .. } => runs = false,
                _ => over = true,
            }
        }
    }
}

/// Whatever was accepted has ended, is suspended, was cleared, or nobody knows of it any more.
fn check_ends(rig: &Rig, known: &Known, case: &str) {
    for id in known.accepted.keys() {
        if known.cleared.contains(id) || known.forgotten.contains(id) {
            continue;
        }
        let last = rig.reports_of(id).last();
        let still = matches!(last, Some(Report::Suspended { .. }));
        assert!(
            still || last.is_some_and(Report::is_end),
            "{case}: nobody hears how {id} ended, only {last:?}"
        );
    }
}

/// A bottle is given to somebody only by whoever has grasped it since it stood.
fn check_chronicle(rig: &Rig, seed: u64) {
    let mut hands: BTreeMap<Symbol, Symbol> = BTreeMap::new();
    for deed in rig.room.done() {
        match &deed.what {
            RoomDoing::Grasped { bottle } => {
                hands.insert(bottle.clone(), deed.vehicle.clone());
            }
            RoomDoing::Served { bottle, .. } | RoomDoing::PutDown { bottle, .. } => {
                let who = hands.remove(bottle);
                let set_back = matches!(deed.what, RoomDoing::PutDown { .. }) && who.is_none();
                assert!(
                    set_back || who.as_ref() == Some(&deed.vehicle),
                    "seed {seed}: {deed}, but {who:?} had it"
                );
            }
            _ => {}
        }
    }
}
