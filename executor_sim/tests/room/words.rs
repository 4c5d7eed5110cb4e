//! Execution models and instructions that make no sense.

use agent_core::model::{Belief, ExecutionModel, Pattern, Symbol, Term, Time};
use agent_core::protocol::{Answer, Input, Instruction, Reply};
use executor_sim::PartsVocabulary;

use crate::rig::{Rig, paper, parse_action};

/// The words in which the model of the paper is refused with another `perform` for `grasp`.
fn refused(name: &str, args: &[&str]) -> String {
    with_grasp(|model| {
        let args = args.iter().map(|arg| match *arg {
            "?b" => Term::Variable(0),
            object => Term::Constant(object.into()),
        });
        let perform = Pattern {
            name: name.into(),
            args: args.collect(),
        };
        let grasp = model.actions.get_mut("grasp").expect("it is there");
        grasp.perform = Some(perform);
    })
}

fn with_grasp(change: impl FnOnce(&mut ExecutionModel)) -> String {
    let level = paper().level().clone();
    let mut model = level.model;
    change(&mut model);
    let vocabulary = PartsVocabulary::new(&level.domain, &model, Belief::default());
    vocabulary
        .err()
        .map_or_else(String::new, |error| error.to_string())
}

#[test]
fn nonsense_is_refused_in_the_modeller_s_words() {
    assert_eq!(refused("arm", &["grasp", "?b"]), "");
    for (name, args, words) in [
        (
            "arm",
            &["grab", "?b"][..],
            "no part of a vehicle can perform `(arm grab ?…)`; there are (drive",
        ),
        (
            "arm",
            &["?b"][..],
            "no part of a vehicle can perform `(arm ?…)`",
        ),
        (
            "arm",
            &["stow", "?b"][..],
            "`(arm stow ?…)` takes 2 argument(s), not 1",
        ),
        ("leg", &["?b"][..], "action `grasp`: no part of a vehicle"),
        (
            "watch",
            &["long"][..],
            "action `grasp`: `long` is not a number of seconds",
        ),
        ("watch", &["-1"][..], "`-1` is not a number of seconds"),
        ("ask", &[][..], "`(ask)` takes 1 argument(s), not 0"),
        ("drive", &["?b"][..], "`drive` takes 2 argument(s), not 1"),
    ] {
        let found = refused(name, args);
        assert!(found.contains(words), "{found}");
    }
    let found = with_grasp(|model| {
        let suspension = model.actions["grasp"].suspension.clone();
        let put_drink = model.actions.get_mut("put-drink").expect("it is there");
        put_drink.suspension = suspension;
    });
    assert!(found.contains("`put-drink` cannot be suspended"), "{found}");
}

#[test]
fn instructions_that_make_no_sense_are_rejected_and_change_nothing() {
    let mut rig = Rig::new();
    for (vehicle, action, words) in [
        (
            "k1",
            "(move entrance kitchen entrance-kitchen)",
            "k1 has no base",
        ),
        (
            "k2",
            "(grasp cola1 ann table2)",
            "k2 has no arm: (grasp cola1 ann table2) needs an arm",
        ),
        ("k3", "(dance)", "no part of a vehicle can do `dance`"),
        ("k3", "(grasp cola1)", "`grasp` takes 3 argument(s), not 1"),
        (
            "k3",
            "(resume-grasp cola1 ann kitchen)",
            "no part of a vehicle can do `resume-grasp`",
        ),
        (
            "k3",
            "(move table1 table2 table1-table2)",
            "not on `table1-table2`",
        ),
        (
            "k7",
            "(grasp cola1 ann kitchen)",
            "nothing here is driven by k7; there are k1, k2, k3",
        ),
    ] {
        let before = rig.rows.clone();
        let from = Symbol::from(vehicle);
        let instruction = Instruction::Execute {
            id: Rig::id(vehicle, 1),
            action: parse_action(action),
            map: None,
        };
        let reply = rig.tell(Input::Instruction { from, instruction });
        let Some(Reply::Instruction(Answer::Rejected { reason })) = reply else {
            unreachable!("{action}: {reply:?}");
        };
        assert!(reason.contains(words), "{reason}");
        assert_eq!(rig.rows, before, "{action} has changed something");
    }
    assert!(rig.reports.is_empty());
}

#[test]
fn what_nobody_knows_is_answered_as_the_table_says() {
    for vehicle in ["k1", "k3"] {
        let mut rig = Rig::new();
        let id = Rig::id(vehicle, 99);
        for answer in [rig.suspend(vehicle, &id), rig.resume(vehicle, &id)] {
            assert!(
                matches!(&answer, Answer::Rejected { reason } if reason.contains("nothing is known")),
                "{answer:?}"
            );
        }
        assert_eq!(rig.clear(vehicle, &id), Answer::Accepted);
    }
}

#[test]
fn what_was_cleared_is_not_begun_again() {
    let mut rig = Rig::new();
    let grasp = "(grasp cola1 ann kitchen)";
    let id = rig.start("k3", grasp);
    rig.run_s(5.0);
    rig.suspend("k3", &id);
    rig.run_to_rest();
    assert_eq!(rig.clear("k3", &id), Answer::Accepted);
    assert_eq!(
        rig.clear("k3", &id),
        Answer::Accepted,
        "there is nothing to drop"
    );
    for answer in [
        rig.execute("k3", &id, grasp),
        rig.resume("k3", &id),
        rig.suspend("k3", &id),
    ] {
        assert!(
            matches!(&answer, Answer::Rejected { reason } if reason.contains("was cleared")),
            "{answer:?}"
        );
    }
}

#[test]
fn an_instruction_that_comes_at_the_end_finds_it_done() {
    let mut rig = Rig::new();
    let id = rig.start("k3", "(grasp cola1 ann kitchen)");
    // Nobody has woken the room since.
    rig.now = Time::from_secs(31.0);
    let answer = rig.suspend("k3", &id);
    assert!(matches!(answer, Answer::Finished { .. }), "{answer:?}");
}

#[test]
fn what_is_over_stays_as_it_ended() {
    let mut rig = Rig::new();
    let grasp = "(grasp cola1 ann kitchen)";
    let id = rig.start("k3", grasp);
    assert_eq!(
        rig.execute("k3", &id, grasp),
        Answer::Accepted,
        "the same again"
    );
    assert!(
        matches!(rig.clear("k3", &id), Answer::Rejected { .. }),
        "it runs"
    );
    assert_eq!(rig.resume("k3", &id), Answer::Accepted, "it runs");
    rig.run_s(5.0);
    assert_eq!(rig.suspend("k3", &id), Answer::Suspending);
    assert_eq!(rig.suspend("k3", &id), Answer::Suspending);
    assert!(
        matches!(rig.clear("k3", &id), Answer::Rejected { .. }),
        "it is stopping"
    );
    assert!(
        matches!(rig.resume("k3", &id), Answer::Rejected { .. }),
        "it is stopping"
    );
    rig.run_to_rest();
    assert_eq!(rig.suspend("k3", &id), Answer::Suspending);
    assert_eq!(rig.suspensions_of(&id), 1, "reported once");
    assert!(matches!(
        rig.execute("k3", &id, grasp),
        Answer::Rejected { .. }
    ));
    assert_eq!(rig.resume("k3", &id), Answer::Accepted);
    rig.run_until_end(&id);
    for answer in [
        rig.execute("k3", &id, grasp),
        rig.suspend("k3", &id),
        rig.resume("k3", &id),
        rig.clear("k3", &id),
    ] {
        assert!(matches!(answer, Answer::Finished { .. }), "{answer:?}");
    }
    assert_eq!(
        rig.reports_of(&id).filter(|report| report.is_end()).count(),
        1
    );
}
