//! A controller's process dies at some moment, and another one goes on.

use agent_core::protocol::{Answer, Arrival, Input, Instruction, Report};
use executor_sim::{Fault, FaultRates, Faults, Place, Ticket, WORLD};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::pair::Pair;
use crate::rig::{id, is_success, is_suspended, reason, secs};

/// The last thing that was said of an action.
fn last(pair: &Pair, number: u64) -> &Report {
    pair.told(number).last().expect("something was said")
}

fn is_unknown(report: &Report) -> bool {
    matches!(report, Report::Unknown { .. })
}

#[test]
fn a_drive_that_was_cut_off_is_suspended_and_goes_on_when_told() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "move n1 n6 arc5");
    pair.live(3.0);
    pair.die(false);
    pair.live(60.0);
    assert!(is_suspended(last(&pair, 1)), "nobody has asked for it");
    // Half a metre of braking, and then it stands.
    let place = pair.world.machine().place(pair.now);
    assert!(matches!(place, Place::Arc { offset_m, .. } if (offset_m - 2.5).abs() < 1e-9));
    pair.instruct(Instruction::Resume {
        id: id(1),
        map: None,
    });
    pair.live(60.0);
    assert!(is_success(last(&pair, 1)));
    assert!((pair.world.machine().odometer_m(pair.now) - 6.0).abs() < 1e-9);
}

#[test]
fn a_speech_that_was_cut_off_goes_on_with_what_is_left() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "narrate n1");
    pair.live(10.0);
    pair.die(false);
    pair.live(5.0);
    assert!(is_suspended(last(&pair, 1)));
    pair.instruct(Instruction::Resume {
        id: id(1),
        map: None,
    });
    pair.live(19.9);
    assert!(!is_success(last(&pair, 1)));
    pair.live(0.2);
    assert!(is_success(last(&pair, 1)));
}

#[test]
fn what_has_ended_while_nobody_listened_has_ended() {
    for action in ["move n1 n6 arc5", "narrate n1", "shut d3", "hand-over cup"] {
        let mut pair = Pair::new("n1");
        pair.settle();
        pair.execute(1, action);
        pair.live(1.0);
        // It is done, and says so; the controller dies before it has heard, and before it has
        // written it down.
        pair.pass(60.0);
        pair.die(false);
        pair.sense();
        pair.robot_says();
        pair.die(false);
        pair.live(60.0);
        assert!(is_success(last(&pair, 1)), "{action}");
    }
}

#[test]
fn a_command_that_never_came_to_the_motors_has_done_nothing() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "hand-over cup");
    pair.hear();
    pair.commit();
    pair.die(false);
    pair.live(10.0);
    assert!(reason(last(&pair, 1)).contains("before it was begun"));
    assert_eq!(pair.deeds("hand-over cup"), 0);
}

#[test]
fn what_must_not_be_done_twice_and_was_cut_off_is_unknown_unless_a_sensor_can_tell() {
    for hindsight in [false, true] {
        let mut pair = Pair::with("n1", Faults::none(), hindsight);
        pair.settle();
        pair.execute(1, "hand-over cup");
        pair.live(1.0);
        pair.die(false);
        pair.live(60.0);
        assert_eq!(is_unknown(last(&pair, 1)), !hindsight);
        assert_eq!(pair.deeds("hand-over cup"), 0);
        // Asked again, it says the same.
        pair.execute(1, "hand-over cup");
        pair.settle();
        let again = &pair.answers.last().expect("an answer").1;
        assert!(matches!(again, Answer::Finished { outcome } if is_unknown(outcome) != hindsight));
    }
}

#[test]
fn a_door_tells_by_itself_whether_it_was_closed() {
    let mut pair = Pair::with("n1", Faults::none(), false);
    pair.settle();
    pair.execute(1, "shut d3");
    pair.live(1.0);
    pair.pass(10.0);
    // What the sensors had to say of it is lost.
    pair.remember_reality();
    pair.reality_ends();
    pair.live(10.0);
    assert!(is_success(last(&pair, 1)));
}

#[test]
fn an_action_of_before_is_known_by_its_name_before_the_robot_stands() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "move n1 n6 arc5");
    pair.live(3.0);
    pair.die(false);
    pair.commit();
    for instruction in [
        Instruction::Resume {
            id: id(1),
            map: None,
        },
        Instruction::Clear { id: id(1) },
        Instruction::Suspend { id: id(1) },
    ] {
        pair.instruct(instruction);
        pair.hear();
        pair.commit();
    }
    pair.execute(2, "hail guest");
    pair.hear();
    pair.commit();
    let answers: Vec<_> = pair.answers.iter().map(|(_, answer)| answer).collect();
    let not_yet = |answer: &Answer, words: &str| matches!(answer, Answer::Rejected { reason } if reason.contains(words));
    assert!(not_yet(answers[1], "has not stopped yet"));
    assert!(not_yet(answers[2], "has not stopped yet"));
    assert_eq!(*answers[3], Answer::Suspending);
    assert!(not_yet(answers[4], "has not said yet where it stands"));
    pair.live(60.0);
    assert_eq!(pair.told(1).len(), 2, "begun, and suspended once");
}

#[test]
fn what_comes_before_the_robot_has_said_where_it_stands_is_begun_then() {
    for (suspended, dies) in [(false, false), (true, false), (false, true)] {
        let mut pair = Pair::new("n1");
        pair.settle();
        pair.die(false);
        pair.execute(1, "narrate n1");
        pair.hear();
        pair.commit();
        assert_eq!(pair.answers[0].1, Answer::Accepted);
        if suspended {
            pair.instruct(Instruction::Suspend { id: id(1) });
            pair.hear();
            pair.commit();
        }
        if dies {
            pair.die(false);
        }
        pair.live(60.0);
        let said = pair.told(1);
        assert_eq!(is_suspended(said[0]), suspended);
        assert_eq!(is_success(said[said.len() - 1]), !suspended);
    }
}

#[test]
fn a_robot_whose_superior_is_gone_stands_still_and_remembers() {
    let there = |there| {
        Arrival::Input(Input::Neighbour {
            name: "child".into(),
            there,
        })
    };
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "move n1 n6 arc5");
    pair.live(3.0);
    pair.arrive(there(false), None);
    pair.live(20.0);
    assert!(is_suspended(last(&pair, 1)));
    // What it has sent before it died sets nothing going, and is not lost either.
    pair.execute(2, "narrate n1");
    pair.execute(3, "hail guest");
    pair.live(20.0);
    assert!(is_suspended(last(&pair, 2)));
    assert!(matches!(&pair.answers[2].1, Answer::Rejected { .. }));
    let driven_m = pair.world.machine().odometer_m(pair.now);
    assert!(driven_m < 3.0);
    pair.arrive(there(true), None);
    for number in [2, 1] {
        pair.instruct(Instruction::Resume {
            id: id(number),
            map: None,
        });
        pair.live(60.0);
        assert!(is_success(last(&pair, number)));
    }
}

#[test]
fn what_cannot_be_suspended_goes_on_to_its_end_without_a_superior() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "hand-over cup");
    pair.live(1.0);
    let gone = Input::Neighbour {
        name: "child".into(),
        there: false,
    };
    pair.arrive(Arrival::Input(gone), None);
    pair.live(60.0);
    assert!(is_success(last(&pair, 1)));
    assert_eq!(pair.deeds("hand-over cup"), 1);
}

#[test]
fn what_a_superior_has_forgotten_is_dropped_and_stopped() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "narrate n1");
    pair.live(3.0);
    pair.instruct(Instruction::Suspend { id: id(1) });
    pair.live(1.0);
    pair.execute(2, "move n1 n6 arc5");
    pair.live(3.0);
    let said = pair.reports.len();
    let reborn = Input::Reborn {
        name: "child".into(),
    };
    pair.arrive(Arrival::Input(reborn), None);
    pair.live(60.0);
    assert!(pair.world.machine().odometer_m(pair.now) < 3.0);
    assert_eq!(pair.reports.len(), said, "there is nobody to tell");
    assert!(!pair.observed.is_empty(), "but where it stands is news");
    for number in [1, 2] {
        pair.instruct(Instruction::Resume {
            id: id(number),
            map: None,
        });
        pair.settle();
        let answer = &pair.answers.last().expect("an answer").1;
        assert!(
            matches!(answer, Answer::Rejected { reason } if reason.contains("nothing is known"))
        );
    }
}

#[test]
fn a_world_that_starts_again_is_halted_and_says_where_the_robot_stands() {
    for remembers in [true, false] {
        let mut pair = Pair::new("n1");
        pair.settle();
        pair.execute(1, "move n1 n6 arc5");
        pair.live(3.0);
        if remembers {
            pair.remember_reality();
        }
        pair.reality_ends();
        pair.live(20.0);
        assert!(is_suspended(last(&pair, 1)));
        let place = pair.world.machine().place(pair.now);
        assert_eq!(place == Place::at("n1"), !remembers, "{place}");
        pair.instruct(Instruction::Resume {
            id: id(1),
            map: None,
        });
        pair.live(20.0);
        assert!(is_success(last(&pair, 1)));
    }
}

#[test]
fn without_motors_nothing_is_begun() {
    let mut pair = Pair::new("n1");
    pair.settle();
    for (there, number) in [(false, 1), (true, 2)] {
        let name = WORLD.into();
        pair.arrive(Arrival::Input(Input::Neighbour { name, there }), None);
        pair.execute(number, "hail guest");
        pair.live(10.0);
        let answer = &pair.answers.last().expect("an answer").1;
        assert_eq!(*answer == Answer::Accepted, there, "{answer:?}");
    }
}

#[test]
fn a_controller_without_a_memory_uses_no_number_twice() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "hand-over cup");
    pair.live(10.0);
    pair.forget();
    pair.live(1.0);
    pair.execute(1, "hand-over plate");
    pair.live(10.0);
    assert_eq!(pair.deeds("hand-over plate"), 1);
    let numbers: Vec<Ticket> = pair
        .world
        .machine()
        .done()
        .map(|done| done.ticket)
        .collect();
    assert!(numbers[0] < numbers[1]);
}

#[test]
fn numbers_go_on_though_controller_and_motors_were_started_anew() {
    let mut pair = Pair::new("n1");
    pair.settle();
    for number in 1..=5 {
        pair.execute(number, "hand-over cup");
        pair.live(10.0);
    }
    pair.die(false);
    pair.reality_ends();
    pair.live(1.0);
    pair.execute(6, "hand-over plate");
    pair.live(10.0);
    let numbers: Vec<Ticket> = pair.done.iter().map(|done| done.ticket).collect();
    assert_eq!(numbers.len(), 6);
    assert!(numbers.is_sorted_by(|one, next| one < next), "{numbers:?}");
}

#[test]
fn faults_by_chance_go_on_where_they_were() {
    let run = |dies: bool| {
        let rates = FaultRates {
            failure_per_mille: 500,
            ..FaultRates::default()
        };
        let mut pair = Pair::with("n1", Faults::random(5, rates), true);
        for number in 1..=20 {
            pair.live(1.0);
            pair.execute(number, "hail guest");
            pair.live(10.0);
            if dies {
                pair.die(false);
            }
        }
        let ends = pair.ends();
        let good = ends.values().map(|end| end.is_some_and(is_success));
        good.collect::<Vec<_>>()
    };
    let undisturbed = run(false);
    assert!(undisturbed.contains(&true) && undisturbed.contains(&false));
    assert_eq!(run(true), undisturbed);
}

#[test]
fn a_failure_that_was_to_come_comes_after_a_restart_too() {
    let mut pair = Pair::with(
        "n1",
        Faults::list([(1, Fault::Failure { fraction: 0.5 })]),
        true,
    );
    pair.settle();
    pair.execute(1, "move n1 n6 arc5");
    pair.live(4.0);
    pair.commit();
    pair.die(false);
    pair.live(60.0);
    assert!(
        reason(last(&pair, 1)).contains("failed on the way"),
        "{:?}",
        last(&pair, 1)
    );
    assert!(pair.now > secs(60.0));
}

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
                let name = "child".into();
                let there = rng.random_ratio(1, 2);
                pair.arrive(Arrival::Input(Input::Neighbour { name, there }), None);
            }
            _ => {}
        }
        check_numbers(&pair);
    }
    for there in [false, true] {
        let name = "child".into();
        pair.arrive(Arrival::Input(Input::Neighbour { name, there }), None);
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

/// Enough to see every deliberate fault that was tried.
const SEEDS: u64 = 600;
