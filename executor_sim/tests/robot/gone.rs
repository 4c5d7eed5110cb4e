//! A superior, or the world, is gone, or has lost its memory.

use agent_core::protocol::{Answer, Arrival, Input, Instruction};
use executor_sim::WORLD;

use crate::pair::{Pair, last};
use crate::rig::{id, is_success, is_suspended};

#[test]
fn a_robot_whose_superior_is_gone_stands_still_and_remembers() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "move n1 n6 arc5");
    pair.live(3.0);
    pair.superior_is_there(false);
    pair.live(20.0);
    assert!(is_suspended(last(&pair, 1)));
    // What it has sent before it died sets nothing going, and is not lost either.
    pair.execute(2, "narrate n1");
    pair.execute(3, "hail guest");
    pair.live(20.0);
    assert_eq!(pair.answers[1].1, Answer::Accepted);
    assert!(matches!(&pair.answers[2].1, Answer::Rejected { .. }));
    assert!(pair.told(2).is_empty(), "nothing was begun");
    let driven_m = pair.world.machine().odometer_m(pair.now);
    assert!(driven_m < 3.0);
    pair.superior_is_there(true);
    pair.live(60.0);
    assert!(is_success(last(&pair, 2)));
    pair.instruct(Instruction::Resume {
        id: id(1),
        map: None,
    });
    pair.live(60.0);
    assert!(is_success(last(&pair, 1)));
}

#[test]
fn a_superior_that_is_there_but_not_seen_is_not_answered_over_and_over() {
    for action in ["move n1 n6 arc5", "hand-over cup"] {
        let mut pair = Pair::new("n1");
        pair.settle();
        pair.superior_is_there(false);
        pair.execute(1, action);
        let mut answered = 0;
        // It resumes at once whatever is suspended.
        for _ in 0..1000 {
            pair.live(0.01);
            let suspended = pair
                .told(1)
                .into_iter()
                .filter(|report| is_suspended(report));
            if suspended.count() > answered {
                answered += 1;
                pair.instruct(Instruction::Resume {
                    id: id(1),
                    map: None,
                });
            }
        }
        assert_eq!((answered, pair.reports.len()), (0, 0), "{action}");
        pair.superior_is_there(true);
        pair.live(60.0);
        assert_eq!(pair.told(1).len(), 2, "begun, and done");
        assert!(is_success(last(&pair, 1)));
    }
}

#[test]
fn what_waits_for_a_superior_can_be_taken_back_and_given_again() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "move n1 n6 arc5");
    pair.live(3.0);
    pair.superior_is_there(false);
    pair.live(3.0);
    let resume = || Instruction::Resume {
        id: id(1),
        map: None,
    };
    pair.instruct(resume());
    pair.live(3.0);
    assert_eq!(pair.told(1).len(), 2, "begun, and suspended");
    pair.instruct(Instruction::Suspend { id: id(1) });
    pair.live(3.0);
    assert_eq!(pair.told(1).len(), 3);
    assert!(is_suspended(last(&pair, 1)));
    pair.superior_is_there(true);
    pair.live(60.0);
    assert_eq!(pair.told(1).len(), 3, "nobody has asked for it again");
    pair.instruct(resume());
    pair.live(60.0);
    assert!(is_success(last(&pair, 1)));
}

#[test]
fn what_waits_for_a_superior_waits_for_it_after_a_restart_too() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.superior_is_there(false);
    pair.execute(1, "move n1 n6 arc5");
    pair.live(3.0);
    pair.die(false);
    pair.live(60.0);
    assert_eq!(pair.world.machine().odometer_m(pair.now), 0.0);
    pair.superior_is_there(true);
    pair.live(60.0);
    assert!(is_success(last(&pair, 1)));
}

#[test]
fn what_was_to_go_on_and_has_waited_is_suspended_again_by_a_restart() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "move n1 n6 arc5");
    pair.live(3.0);
    pair.superior_is_there(false);
    pair.live(3.0);
    let driven_m = pair.world.machine().odometer_m(pair.now);
    pair.instruct(Instruction::Resume {
        id: id(1),
        map: None,
    });
    pair.live(3.0);
    assert_eq!(pair.told(1).len(), 2, "begun, and suspended");
    pair.die(false);
    pair.superior_is_there(true);
    pair.live(60.0);
    assert_eq!(pair.told(1).len(), 3);
    assert!(is_suspended(last(&pair, 1)));
    assert_eq!(pair.world.machine().odometer_m(pair.now), driven_m);
}

#[test]
fn what_cannot_be_suspended_goes_on_to_its_end_without_a_superior() {
    let mut pair = Pair::new("n1");
    pair.settle();
    pair.execute(1, "hand-over cup");
    pair.live(1.0);
    pair.superior_is_there(false);
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
