//! Whoever dies between any two messages.

use agent_core::protocol::{Answer, Instruction, Report};
use executor_sim::{FaultRates, Faults};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::pair::{Pair, last};
use crate::rig::id;

/// Enough to see every deliberate fault that was tried.
const SEEDS: u64 = 600;

/// Moves of the superior, the wires and the reaper, in any order; `seed` is all it depends on.
fn live(seed: u64, world_dies: bool) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let rates = FaultRates {
        late_stop_per_mille: 50,
        failure_per_mille: 50,
        refused_suspension_per_mille: 50,
        slow_per_mille: 50,
    };
    let hindsight = rng.random_ratio(1, 2);
    let mut pair = Pair::with("n1", Faults::random(seed, rates), hindsight);
    let mut number = 0;
    for _ in 0..200 {
        match rng.random_range(0..24) {
            0..=3 => pair.sense(),
            4..=6 => pair.command(),
            7 | 8 => pair.hear(),
            9..=13 => pair.commit(),
            14 => pair.pass(rng.random_range(0.0..4.0)),
            15 => pair.live(rng.random_range(0.0..4.0)),
            16 if pair.instructions.len() < 3 => {
                number += 1;
                let action = some_action(&mut rng, number);
                pair.execute(number, &action);
            }
            17 if number > 0 && pair.instructions.len() < 3 => {
                let id = id(rng.random_range(1..=number));
                pair.instruct(match rng.random_range(0..5) {
                    0..=2 => Instruction::Suspend { id },
                    _ => Instruction::Resume { id, map: None },
                });
            }
            18 if rng.random_ratio(1, 2) => pair.die(rng.random_ratio(1, 2)),
            19 => pair.remember_reality(),
            20 if world_dies && rng.random_ratio(1, 4) => {
                pair.reality_ends();
            }
            21 if rng.random_ratio(1, 3) => {
                pair.superior_is_there(rng.random_ratio(1, 2));
            }
            _ => {}
        }
        check_numbers(&pair);
    }
    for there in [false, true] {
        pair.superior_is_there(there);
        pair.live(200.0);
        check_numbers(&pair);
    }
    check_ends(&pair);
    check_memory(&mut pair);
    check_ends(&pair);
}

/// Another start later nothing is begun again under its old name, and what is suspended goes on.
fn check_memory(pair: &mut Pair) {
    pair.die(false);
    pair.live(1.0);
    let numbers: Vec<u64> = pair.ends().into_keys().collect();
    for number in numbers {
        let ended = last(pair, number).is_end();
        let (name, map) = (id(number), None);
        let answer = if ended {
            pair.execute(number, "narrate n1");
            pair.settle();
            let answer = &pair.answers.last().expect("an answer").1;
            matches!(answer, Answer::Finished { .. })
        } else {
            pair.instruct(Instruction::Resume { id: name, map });
            pair.live(100.0);
            let answer = &pair.answers.last().expect("an answer").1;
            *answer == Answer::Accepted && last(pair, number).is_end()
        };
        assert!(answer, "{number} was forgotten");
    }
}

fn some_action(rng: &mut ChaCha8Rng, number: u64) -> String {
    let actions = [
        format!("hand-over cup{number}"),
        format!("hand-over cup{number}"),
        "narrate n1".to_owned(),
        "hail guest".to_owned(),
        "leave arc5 n6".to_owned(),
        "leave arc5 n1".to_owned(),
        "leave arc12 n10".to_owned(),
        "shut d3".to_owned(),
        "unlock d3".to_owned(),
    ];
    actions[rng.random_range(0..actions.len())].clone()
}

/// One thing at a time, and none twice.
fn check_numbers(pair: &Pair) {
    let numbers = pair.world.machine().done().map(|done| done.ticket);
    assert!(numbers.is_sorted_by(|one, next| one < next));
}

fn check_ends(pair: &Pair) {
    assert!(pair.world.machine().stands());
    for (number, end) in pair.ends() {
        let told = pair.told(number);
        let ends = told.iter().filter(|report| report.is_end()).count();
        let deeds = pair.deeds(&format!("hand-over cup{number}"));
        assert!(
            ends <= 1 && deeds <= 1,
            "{number} ends {ends} times, done {deeds} times"
        );
        // It was begun and suspended by turns, and the last word is an end or a suspension.
        let mut runs = false;
        for (place, report) in told.iter().enumerate() {
            match report {
                Report::Started => {
                    assert!(!runs, "{number} was begun twice: {told:?}");
                    runs = true;
                }
                Report::Suspended { .. } => runs = false,
                _ => {
                    assert_eq!(place + 1, told.len(), "after its end: {told:?}");
                    runs = false;
                }
            }
        }
        assert!(!runs, "nobody hears of the end of {number}: {told:?}");
        if pair.is_deed(number) {
            match end {
                Some(Report::Success { .. }) => assert_eq!(deeds, 1, "{number} was not done"),
                Some(Report::Failure { reason, .. }) => {
                    assert_eq!(deeds, 0, "{number} was done, but: {reason}");
                }
                Some(Report::Unknown { .. }) => {}
                other => unreachable!("a deed is not suspended: {other:?}"),
            }
        }
    }
}

#[test]
fn a_controller_may_die_between_any_two_messages() {
    for seed in 0..SEEDS {
        // The only thing to say on failure: with it, the life can be had again.
        let life = std::panic::catch_unwind(|| live(seed, false));
        assert!(life.is_ok(), "the life from seed {seed}");
    }
}

#[test]
fn and_so_may_the_world_s_process() {
    for seed in 0..SEEDS {
        let life = std::panic::catch_unwind(|| live(seed, true));
        assert!(
            life.is_ok(),
            "the life with a mortal world from seed {seed}"
        );
    }
}
