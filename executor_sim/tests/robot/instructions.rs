//! What is answered: repeated, untimely and senseless instructions.

use agent_core::model::{Domain, ExecutionModel, Time};
use agent_core::protocol::{
    Answer, Durable, GoalRequest, Happening, Input, Instruction, Machine, Reply, Report, Urgency,
};
use executor_sim::{Controller, Faults, VocabularyError};

use crate::rig::{Rig, atom, domain, domain_of, floor, id, is_success, is_suspended, write_rows};

fn words(answer: &Answer) -> &str {
    match answer {
        Answer::Rejected { reason } => reason,
        _ => "",
    }
}

#[test]
fn what_cannot_be_done_is_rejected_in_words_and_nothing_moves() {
    let mut rig = Rig::new("n1");
    for (action, why) in [
        ("fly n1", "a robot cannot do `fly`"),
        ("move n1 n6", "`move` takes 3 argument(s), not 2"),
        ("move n1 n6 arc99", "there is no arc `arc99`"),
        ("move n1 n4 arc5", "`n4` is not an end of `arc5`"),
        (
            "move n6 n10 arc12",
            "the robot stands at n1, not on `arc12`",
        ),
        ("shut d9", "there is no door `d9`"),
    ] {
        let answer = rig.execute(1, action);
        assert_eq!(words(&answer), why);
    }
    assert!(rig.reports.is_empty() && rig.robot.wake_at().is_none());
}

#[test]
fn a_robot_does_one_thing_at_a_time() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(1.0);
    let busy = "the robot is busy with (move n1 n6 arc5)";
    assert_eq!(words(&rig.execute(2, "narrate n1")), busy);
    rig.until(4.0);
    rig.suspend(1);
    // It still rolls.
    assert_eq!(words(&rig.execute(2, "narrate n1")), busy);
    assert_eq!(words(&rig.resume(1)), "child.1.1 has not stopped yet");
    assert_eq!(words(&rig.clear(1)), "child.1.1 has not stopped yet");
    rig.until(10.0);
    assert_eq!(rig.execute(2, "narrate n1"), Answer::Accepted);
    assert_eq!(words(&rig.resume(1)), "the robot is busy with (narrate n1)");
    assert_eq!(
        words(&rig.clear(2)),
        "child.1.2 is running: suspend it first"
    );
}

#[test]
fn an_execution_is_begun_once_however_often_it_is_asked_for() {
    let mut rig = Rig::new("n1");
    let action = "move n1 n6 arc5";
    assert_eq!(rig.execute(1, action), Answer::Accepted);
    rig.until(3.0);
    assert_eq!(rig.execute(1, action), Answer::Accepted);
    rig.suspend(1);
    rig.until(10.0);
    assert_eq!(
        words(&rig.execute(1, action)),
        "child.1.1 is suspended: resume it or clear it"
    );
    rig.resume(1);
    assert_eq!(rig.resume(1), Answer::Accepted);
    rig.until(30.0);
    let Answer::Finished { outcome } = rig.execute(1, action) else {
        unreachable!("it is over");
    };
    assert!(is_success(&outcome));
    let started = rig
        .reports
        .iter()
        .filter(|(_, _, report)| *report == Report::Started);
    assert_eq!(started.count(), 2);
    assert!((rig.odometer_m() - 6.0).abs() < 1e-9);
}

#[test]
fn a_suspension_asked_for_twice_while_it_rolls_is_reported_once() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(3.0);
    assert_eq!(rig.suspend(1), Answer::Suspending);
    rig.until(3.5);
    assert_eq!(rig.suspend(1), Answer::Suspending);
    rig.until(20.0);
    assert!(is_suspended(rig.only(1).1));
}

#[test]
fn a_suspension_asked_for_again_is_answered_again_and_reported_once() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(3.0);
    rig.suspend(1);
    rig.until(20.0);
    assert_eq!(rig.suspend(1), Answer::Suspending);
    let answer = rig.instruct_as("operator", Instruction::Suspend { id: id(1) });
    assert_eq!(answer, Answer::Suspending);
    assert_eq!(rig.told(1).len(), 1);
    assert!(rig.elsewhere.is_empty());
    rig.check_belief();
}

#[test]
fn anybody_may_stop_a_robot_and_its_own_superior_hears_of_it() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(3.0);
    rig.instruct_as("operator", Instruction::Suspend { id: id(1) });
    rig.until(20.0);
    assert!(is_suspended(rig.only(1).1));
    assert!(rig.elsewhere.is_empty());
}

#[test]
fn a_superior_that_did_not_act_is_told_by_observation() {
    let mut rig = Rig::new("n1");
    rig.instruct_as(
        "operator",
        Instruction::Execute {
            id: id(9),
            action: atom("move n1 n6 arc5"),
            map: None,
        },
    );
    rig.until(20.0);
    assert_eq!(rig.elsewhere.len(), 2);
    assert!(rig.reports.is_empty());
    rig.check_belief();
}

#[test]
fn a_record_is_dropped_once_and_dropping_it_again_is_no_error() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "narrate n1");
    rig.until(3.0);
    rig.suspend(1);
    assert_eq!(rig.clear(1), Answer::Accepted);
    assert_eq!(rig.clear(1), Answer::Accepted);
    assert_eq!(rig.clear(77), Answer::Accepted);
    let cleared = rig
        .events
        .iter()
        .filter(|event| matches!(event.what, Happening::RecordCleared { .. }));
    assert_eq!(cleared.count(), 1);
    for answer in [rig.resume(1), rig.suspend(1), rig.execute(1, "narrate n1")] {
        assert_eq!(words(&answer), "child.1.1 was cleared");
    }
    for answer in [rig.resume(77), rig.suspend(77)] {
        assert_eq!(words(&answer), "nothing is known of child.1.77");
    }
}

#[test]
fn what_is_over_is_answered_with_its_outcome_and_with_what_is_true_now() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "move n1 n6 arc5");
    rig.until(20.0);
    let expected = rig.only(1).1.clone();
    for answer in [rig.suspend(1), rig.resume(1), rig.clear(1)] {
        assert_eq!(
            answer,
            Answer::Finished {
                outcome: expected.clone()
            }
        );
    }
    rig.execute(2, "move n6 n10 arc12");
    rig.until(25.0);
    // On the way to elsewhere nothing is said of the place.
    assert_eq!(
        rig.suspend(1),
        Answer::Finished {
            outcome: Report::Success { facts: Vec::new() }
        }
    );
    rig.until(60.0);
    let Answer::Finished {
        outcome: Report::Success { facts },
    } = rig.suspend(1)
    else {
        unreachable!("it was a success");
    };
    rig.belief.apply_all(&facts);
    rig.check_belief();
}

#[test]
fn outcomes_are_remembered_for_a_thousand_actions() {
    let mut rig = Rig::new("n1");
    for number in 1..=1001 {
        rig.execute(number, "leave arc5 n1");
    }
    assert_eq!(words(&rig.suspend(1)), "nothing is known of child.1.1");
    assert!(matches!(rig.suspend(2), Answer::Finished { .. }));
}

#[test]
fn what_cannot_be_suspended_says_when_it_ends() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "hail guest");
    rig.until(0.5);
    let finishes_in = Time::from_secs(1.5);
    assert_eq!(rig.suspend(1), Answer::Refused { finishes_in });
    rig.until(2.0);
    assert!(is_success(rig.only(1).1));
}

#[test]
fn goals_and_commands_are_for_agents() {
    let mut rig = Rig::new("n1");
    let goal = GoalRequest {
        id: None,
        tasks: vec![atom("go n1")],
        urgency: Urgency::Normal,
        priority: 0,
        deadline: None,
    };
    let reply = rig.robot.handle(rig.now, Input::Goal(goal));
    let Some(Reply::Goal(Err(rejection))) = reply else {
        unreachable!("{reply:?}");
    };
    assert_eq!(
        rejection.to_string(),
        "unknown task `go`; this agent knows no tasks at all; a robot is not an agent"
    );
}

#[test]
fn a_robot_whose_controller_is_new_stops_and_waits_to_be_told() {
    for keep_memory in [false, true] {
        let mut rig = Rig::new("n1");
        rig.execute(1, "narrate n1");
        rig.until(10.0);
        rig.suspend(1);
        rig.execute(2, "move n1 n6 arc5");
        rig.until(13.0);
        rig.restart(keep_memory);
        // It rolls: it does not know yet where it will stand. One that knows of nothing begins then
        // what it is told.
        let answer = rig.execute(3, "hail guest");
        if keep_memory {
            assert_eq!(words(&answer), "the robot has not said yet where it stands");
        } else {
            assert_eq!(answer, Answer::Accepted);
            assert!(rig.told(3).is_empty());
        }
        rig.until(100.0);
        assert!((rig.odometer_m() - 2.5).abs() < 1e-9);
        if keep_memory {
            assert!(is_suspended(rig.only(2).1));
            rig.check_belief();
            assert_eq!(rig.resume(1), Answer::Accepted);
            rig.until(200.0);
            let (at, ..) = rig.reports.last().expect("an end");
            assert!((at.secs() - 120.0).abs() < 1e-5);
            assert_eq!(rig.resume(2), Answer::Accepted);
            rig.until(300.0);
            assert!(is_success(rig.told(2)[1]));
            assert!((rig.odometer_m() - 6.0).abs() < 1e-9);
        } else {
            assert!(rig.told(2).is_empty());
            let facts = rig.robot.announcement();
            rig.belief.apply_all(&facts);
            rig.bystander.apply_all(&facts);
            rig.check_belief();
            assert_eq!(words(&rig.resume(1)), "nothing is known of child.1.1");
        }
    }
}

#[test]
fn what_is_written_down_can_be_read_again() {
    let mut rig = Rig::new("n1");
    rig.execute(1, "narrate n1");
    rig.until(10.5);
    rig.suspend(1);
    rig.execute(2, "hail guest");
    rig.until(20.0);
    rig.execute(3, "move n1 n6 arc5");
    write_rows(&mut rig.journal, rig.robot.write_down());
    let (domain, model) = domain();
    let mut again = Controller::new(&domain, &model, floor(), Faults::none()).expect("a sound one");
    again.recall(&rig.journal).expect("as written");
    // It has halted, and knows that it was not there for a while.
    let different: Vec<_> = again.write_down().into_iter().map(|row| row.key).collect();
    assert_eq!(different, ["m/running", "m/ticket"]);
    // Nothing is written twice.
    assert!(again.write_down().is_empty());
}

#[test]
fn a_model_that_a_robot_cannot_follow_is_refused_in_the_modellers_words() {
    let refused = |perform: &'static [&'static str], suspendable| {
        let (domain, model) = domain_of(&[("act", &["?x"], perform, suspendable)]);
        Controller::new(&domain, &model, floor(), Faults::none())
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default()
    };
    assert_eq!(refused(&["speak", "?x"], false), "");
    assert!(refused(&["fly", "?x"], false).contains("a robot cannot perform `fly`"));
    assert_eq!(
        refused(&["speak", "?x", "5"], false),
        "action `act`: `speak` takes 1 argument(s), not 2"
    );
    assert_eq!(
        refused(&["speak", "long"], false),
        "action `act`: `long` is not a number of seconds"
    );
    assert_eq!(
        refused(&["set-door", "?x", "ajar"], false),
        "action `act`: `ajar` is not `open` or `closed`"
    );
    assert!(refused(&["set-door", "?x", "open"], true).contains("cannot be suspended"));
    let (_, model) = domain_of(&[("act", &["?x"], &["speak", "5"], false)]);
    let error = Controller::new(&Domain::default(), &model, floor(), Faults::none()).err();
    assert_eq!(error, Some(VocabularyError::UnknownAction("act".into())));
    let empty = ExecutionModel::default();
    assert!(Controller::new(&Domain::default(), &empty, floor(), Faults::none()).is_ok());
}
