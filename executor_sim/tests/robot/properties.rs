//! Long random lives, with everything checked after every step.

use agent_core::protocol::{Answer, Report};
use executor_sim::{FaultRates, Faults, Place};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::rig::{Rig, floor};

const RATES: FaultRates = FaultRates {
    late_stop_per_mille: 100,
    refused_suspension_per_mille: 50,
    failure_per_mille: 100,
    slow_per_mille: 100,
};

/// An action that could be begun from where the robot stands, or a speech.
fn some_action(rng: &mut ChaCha8Rng, place: &Place) -> String {
    let floor = floor();
    let mut actions = vec!["narrate n1".to_owned(), "hail guest".to_owned()];
    for (arc, passage) in floor.passages() {
        if floor.offset_on(arc, place).is_some() {
            actions.extend(passage.ends.iter().map(|end| format!("leave {arc} {end}")));
        }
    }
    actions.swap_remove(rng.random_range(0..actions.len()))
}

/// One life; `seed` is all that it depends on.
fn live(seed: u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut rig = Rig::with("n6", Faults::random(seed, RATES));
    let mut number = 0;
    let mut open = true;
    for _ in 0..120 {
        rig.until(rig.now.secs() + rng.random_range(0.0..4.0));
        let some = rng.random_range(1..=number.max(1));
        match rng.random_range(0..6) {
            0 | 1 => {
                let action = some_action(&mut rng, &rig.place());
                if rig.execute(number + 1, &action) == Answer::Accepted {
                    number += 1;
                }
            }
            2 => drop(rig.suspend(number.max(1))),
            3 => drop(rig.resume(some)),
            4 if rng.random_ratio(1, 3) => drop(rig.clear(some)),
            // Whatever was running is suspended or over, and the rest is remembered.
            4 => rig.restart(true),
            _ => {
                open = !open;
                rig.door("d3", open);
            }
        }
        if rig.robot.world().stands() {
            rig.check_belief();
        }
    }
    rig.until(rig.now.secs() + 500.0);
    rig.check_belief();
    check_order(&rig, number);
}

/// Of every action: begun, then by turns suspended and begun again, and ended at most once.
fn check_order(rig: &Rig, number: u64) {
    for action in 1..=number {
        let reports: Vec<_> = rig
            .reports
            .iter()
            .filter(|(_, id, _)| id.number == action)
            .map(|(_, _, report)| report)
            .collect();
        assert_eq!(reports.first(), Some(&&Report::Started));
        let mut running = false;
        for (place, report) in reports.iter().enumerate() {
            let last = place + 1 == reports.len();
            match report {
                Report::Started => {
                    assert!(!running, "begun twice");
                    running = true;
                }
                Report::Suspended { .. } => running = false,
                Report::Success { .. } | Report::Failure { .. } | Report::Unknown { .. } => {
                    assert!(last, "after its end");
                }
                Report::Progress { .. } => {}
            }
        }
        assert!(!running || reports.last().is_some_and(|report| report.is_end()));
    }
}

#[test]
fn whatever_happens_superiors_believe_what_is_so() {
    for seed in 0..400 {
        // The only thing to say on failure: with it, the life can be had again.
        let life = std::panic::catch_unwind(|| live(seed));
        assert!(life.is_ok(), "the life from seed {seed}");
    }
}
