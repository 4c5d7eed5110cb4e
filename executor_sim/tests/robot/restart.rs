//! A controller's process dies at some moment, and another one goes on.

use agent_core::protocol::{Answer, Instruction, Report};
use executor_sim::{Fault, FaultRates, Faults, Place, Ticket};

use crate::pair::{Pair, last};
use crate::rig::{id, is_success, is_suspended, reason, secs};

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
