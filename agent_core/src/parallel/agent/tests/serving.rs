//! Two guests, and what can come in between.

use super::bistro::fact;
use super::parallel;
use super::room::{Plot, Room, execute, order};
use crate::model::FactChange;
use crate::parallel::ParallelAgent;
use crate::planner::{AnyPlanner, PlannerKind};
use crate::protocol::{Command, Happening, Input, Instruction, Report, Urgency};

/// Guest 0 at table 1 has ordered, and guest 1 at table 2 orders while the first drink is put on the
/// tray.
fn two_guests(together: usize) -> Room<ParallelAgent<AnyPlanner>> {
    let mut room = parallel(together, PlannerKind::Graph);
    room.goal_at(0.0, "first", "(serve g0)", Urgency::Normal);
    room.goal_at(35.0, "second", "(serve g1)", Urgency::Normal);
    room
}

#[test]
fn two_guests_are_served_in_one_round() {
    let mut room = two_guests(3);
    room.play(1000.0);
    assert_eq!(
        room.begun(),
        [
            "(grasp b0 kitchen)",
            "(put-on-tray b0 slot1 kitchen)",
            "(grasp b1 kitchen)",
            "(put-on-tray b1 slot2 kitchen)",
            "(move kitchen table1)",
            "(take b0 slot1 table1)",
            "(put-drink b0 g0 table1)",
            "(move table1 table2)",
            "(take b1 slot2 table2)",
            "(put-drink b1 g1 table2)",
        ]
    );
    let ends = room.succeeded();
    assert_eq!((ends["first"], ends["second"]), (162, 217));
}

#[test]
fn one_after_the_other_takes_two_rounds() {
    let mut room = two_guests(1);
    room.play(1000.0);
    let begun = room.begun();
    let drives = begun.iter().filter(|it| it.starts_with("(move"));
    let drives: Vec<&String> = drives.collect();
    assert_eq!(
        drives,
        [
            "(move kitchen table1)",
            "(move table1 kitchen)",
            "(move kitchen table2)"
        ]
    );
    assert_eq!(room.succeeded()["first"], 117);
}

#[test]
fn while_one_hand_is_busy_the_mouth_is_not() {
    let mut room = parallel(3, PlannerKind::Graph);
    room.goal_at(0.0, "drink", "(serve g0)", Urgency::Normal);
    room.goal_at(0.0, "words", "(chat g0)", Urgency::Normal);
    room.play(1000.0);
    // Said while the bottle is taken from the tray.
    assert_eq!(room.succeeded()["words"], 45 + 40 + 10);
    assert_eq!(room.succeeded()["drink"], 45 + 40 + 32);
    let combined = |what: &Happening| matches!(what, Happening::ActionsCombined { saving_s, .. } if *saving_s == 10.0);
    assert_eq!(room.count(combined), 1);
}

#[test]
fn an_emergency_at_any_moment_stops_all_that_is_done_and_everything_is_done_in_the_end() {
    for moment in 0..=217 {
        let mut room = two_guests(3);
        room.goal_at(0.0, "words", "(chat g0)", Urgency::Normal);
        let spill = FactChange::Add(fact("(spill table3)"));
        let moment = f64::from(moment) + 0.5;
        room.at(moment, Plot::Fact(spill));
        room.goal_at(moment, "spill", "(clean table3)", Urgency::Emergency);
        room.play(3000.0);
        let ends = room.succeeded();
        assert_eq!(ends.len(), 4, "at {moment}: {ends:?}\n{:#?}", room.log);
        for guest in ["(served g0)", "(served g1)", "(told g0)"] {
            assert!(room.holds(guest), "at {moment}: {guest}");
        }
        let handed = room
            .begun()
            .into_iter()
            .filter(|it| it.starts_with("(put-drink"));
        assert_eq!(handed.count(), 2, "at {moment}: {:#?}", room.log);
        let suspended = room.count(|it| matches!(it, Happening::GoalSuspended { .. }));
        let resumed = room.count(|it| matches!(it, Happening::GoalResumed { .. }));
        assert_eq!(suspended, resumed, "at {moment}");
        let begun = room.begun();
        let wipe = begun.iter().position(|it| it.starts_with("(wipe"));
        assert!(wipe.is_some(), "at {moment}");
    }
}

#[test]
fn all_actions_of_a_clique_are_suspended_and_resumed() {
    // At 85 the carrier is at table 1, takes the bottle and talks.
    let mut room = parallel(3, PlannerKind::Graph);
    room.goal_at(0.0, "drink", "(serve g0)", Urgency::Normal);
    room.goal_at(0.0, "words", "(chat g0)", Urgency::Normal);
    room.at(88.0, Plot::Fact(FactChange::Add(fact("(spill table1)"))));
    room.goal_at(88.0, "spill", "(clean table1)", Urgency::Emergency);
    room.play(1000.0);
    let log = &room.log;
    let place = |line: &str| {
        let found = log.iter().position(|it| it == line);
        found.unwrap_or_else(|| panic!("{line}\n{log:#?}"))
    };
    let wiping = place("88 (wipe table1)");
    assert!(place("88 stop (take b0 slot1 table1)") < wiping);
    assert!(place("88 stop (talk g0 table1)") < wiping);
    let resumed = [
        "113 (resume-take b0 slot1 table1)",
        "113 (resume-talk g0 table1)",
    ];
    assert!(resumed.iter().all(|line| place(line) > wiping));
    assert_eq!(room.succeeded().len(), 3);
}

#[test]
fn a_restart_at_any_moment_changes_nothing() {
    let mut undisturbed = two_guests(3);
    undisturbed.goal_at(100.0, "spill", "(clean table2)", Urgency::Emergency);
    undisturbed.at(99.0, Plot::Fact(FactChange::Add(fact("(spill table2)"))));
    undisturbed.play(3000.0);
    for moment in (0..300).step_by(3) {
        let mut room = two_guests(3);
        room.goal_at(100.0, "spill", "(clean table2)", Urgency::Emergency);
        room.at(99.0, Plot::Fact(FactChange::Add(fact("(spill table2)"))));
        room.at(f64::from(moment) + 0.2, Plot::Restart);
        room.play(3000.0);
        assert_eq!(room.log, undisturbed.log, "at {moment}");
        assert_eq!(room.succeeded(), undisturbed.succeeded(), "at {moment}");
        let stops = |it: &Happening| {
            matches!(
                it,
                Happening::GoalSuspended { .. } | Happening::GoalResumed { .. }
            )
        };
        assert_eq!(room.count(stops), undisturbed.count(stops), "at {moment}");
    }
}

#[test]
fn what_is_blocked_makes_room_and_goes_on_when_it_can() {
    let mut room = parallel(1, PlannerKind::Graph);
    let blocked = fact("(blocked table1)");
    room.at(0.0, Plot::Fact(FactChange::Add(blocked.clone())));
    room.goal_at(1.0, "first", "(chat g0)", Urgency::Normal);
    room.goal_at(2.0, "second", "(chat g1)", Urgency::Normal);
    room.at(200.0, Plot::Fact(FactChange::Remove(blocked)));
    room.play(1000.0);
    let ends = room.succeeded();
    assert_eq!(ends["second"], 2 + 48 + 10);
    assert_eq!(ends["first"], 200 + 23 + 10);
}

#[test]
fn a_branch_without_a_plan_waits_while_others_work_and_gives_up_when_nobody_does() {
    let mut room = parallel(3, PlannerKind::Graph);
    // Bottle 1 is nowhere.
    room.at(
        0.0,
        Plot::Fact(FactChange::Remove(fact("(stands b1 kitchen)"))),
    );
    room.goal_at(1.0, "first", "(serve g0)", Urgency::Normal);
    room.goal_at(2.0, "second", "(serve g1)", Urgency::Normal);
    room.play(1000.0);
    let failed = room.events.iter().find(|event| {
        matches!(
            event.what,
            Happening::GoalFailed { .. } | Happening::GoalBlocked { .. }
        )
    });
    let failed = failed.expect("it is given up");
    assert_eq!(failed.goal, Some("second".into()));
    assert_eq!(failed.at.secs().round() as u64, room.succeeded()["first"]);
}

#[test]
fn a_goal_of_a_clique_can_be_suspended_resumed_and_cancelled_by_the_user() {
    let mut room = two_guests(3);
    room.at(50.0, Plot::Command(Command::Suspend("second".into())));
    room.at(60.0, Plot::Command(Command::Cancel("first".into())));
    room.at(300.0, Plot::Command(Command::Resume("second".into())));
    room.play(2000.0);
    let refused = room
        .replies
        .iter()
        .filter(|reply| format!("{reply:?}").contains("Err"));
    assert_eq!(refused.count(), 0, "{:?}", room.replies);
    assert_eq!(room.succeeded().len(), 1, "{:#?}", room.log);
    assert!(room.holds("(served g1)") && !room.holds("(served g0)"));
}

#[test]
fn what_others_instruct_is_worked_on_together_and_reported() {
    let mut room = parallel(3, PlannerKind::Graph);
    room.give(execute(1, "(serve g0)"));
    room.give(execute(2, "(serve g1)"));
    room.give(execute(2, "(serve g1)"));
    room.play(1000.0);
    let ends: Vec<_> = (room.reports.iter())
        .filter(|(_, _, report)| report.is_end())
        .map(|(to, id, report)| (to.to_string(), id.clone(), report.clone()))
        .collect();
    assert_eq!(ends.len(), 2, "{ends:?}");
    for (to, id, report) in ends {
        assert_eq!(to, "k2");
        assert!([order(1), order(2)].contains(&id));
        assert!(matches!(report, Report::Success { .. }), "{report:?}");
    }
    let drives = room
        .begun()
        .into_iter()
        .filter(|it| it.starts_with("(move"));
    assert_eq!(drives.count(), 2, "one round: {:#?}", room.log);
}

#[test]
fn a_superior_may_suspend_resume_and_clear_what_it_has_instructed() {
    let instruct = |instruction| Input::Instruction {
        from: "k2".into(),
        instruction,
    };
    let mut room = parallel(3, PlannerKind::Graph);
    room.give(execute(1, "(serve g0)"));
    room.give(execute(2, "(chat g1)"));
    room.play(10.0);
    room.give(instruct(Instruction::Suspend { id: order(1) }));
    let suspended = |room: &Room<_>| {
        let mut reports = room.reports.iter();
        reports.any(|(_, id, it)| *id == order(1) && matches!(it, Report::Suspended { .. }))
    };
    assert!(suspended(&room));
    room.play(100.0);
    assert!(
        room.holds("(told g1)"),
        "the other one goes on: {:#?}",
        room.log
    );
    assert!(room.holds("(edge b0 kitchen)"), "{:#?}", room.log);
    let id = order(1);
    room.give(instruct(Instruction::Resume { id, map: None }));
    room.play(1000.0);
    assert!(room.holds("(served g0)"));
    room.give(execute(3, "(serve g2)"));
    let soon = room.now.secs() + 10.0;
    room.play(soon);
    let id = order(3);
    room.give(instruct(Instruction::Suspend { id: id.clone() }));
    room.give(instruct(Instruction::Clear { id }));
    room.play(3000.0);
    assert!(!room.holds("(served g2)"));
    assert!(
        room.machine.intentions().next().is_none(),
        "nothing is left"
    );
}

#[test]
fn whoever_cannot_be_interrupted_does_not_move_and_the_others_go_on() {
    let mut room = parallel(3, PlannerKind::Graph);
    room.give(execute(1, "(serve g0)"));
    room.goal_at(0.0, "words", "(chat g1)", Urgency::Normal);
    room.play(5.0);
    let name = crate::model::Symbol::from("k2");
    room.give(Input::Neighbour {
        name: name.clone(),
        there: false,
    });
    room.play(500.0);
    assert!(room.holds("(told g1)") && !room.holds("(served g0)"));
    let lost = room.count(|it| matches!(it, Happening::NeighbourLost { .. }));
    assert_eq!(lost, 1, "it is said once");
    room.give(Input::Neighbour { name, there: true });
    room.play(1000.0);
    assert!(room.holds("(served g0)"));
}

#[test]
fn what_is_learned_is_said_once() {
    let mut room = two_guests(3);
    room.play(1000.0);
    let changes: Vec<String> = (room.events.iter())
        .filter_map(|event| match &event.what {
            Happening::BeliefChanged { changes } => Some(format!("{} {changes:?}", event.at)),
            _ => None,
        })
        .collect();
    let mut once = changes.clone();
    once.dedup();
    assert_eq!(changes, once);
    assert_eq!(changes.len(), 10, "once for each action");
}
