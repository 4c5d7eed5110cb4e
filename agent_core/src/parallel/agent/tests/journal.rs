//! A journal is a file, and files are damaged.

use super::bistro::fact;
use super::parallel;
use super::room::{Driver, Plot, Room};
use crate::model::FactChange;
use crate::parallel::ParallelAgent;
use crate::planner::{AnyPlanner, PlannerKind};
use crate::protocol::{Durable, Machine, Urgency};

/// Two branches at work when an emergency has come.
fn busy() -> Room<ParallelAgent<AnyPlanner>> {
    let mut room = parallel(3, PlannerKind::Graph);
    room.goal_at(0.0, "drink", "(serve g0)", Urgency::Normal);
    room.goal_at(0.0, "words", "(chat g0)", Urgency::Normal);
    room.goal_at(0.0, "later", "(serve g4)", Urgency::Normal);
    room.goal_at(0.0, "last", "(serve g5)", Urgency::Normal);
    room.at(20.0, Plot::Fact(FactChange::Add(fact("(spill table1)"))));
    room.goal_at(20.0, "spill", "(clean table1)", Urgency::Emergency);
    room.play(25.0);
    room
}

#[test]
fn a_row_that_is_missing_or_damaged_is_refused_or_does_no_harm() {
    let room = busy();
    let rows = room.rows();
    assert!(rows.len() > 20, "there is something to damage");
    let mut refused = 0;
    for key in rows.keys() {
        for damage in 0..3 {
            let mut rows = rows.clone();
            match damage {
                0 => drop(rows.remove(key)),
                1 => drop(rows.insert(key.clone(), Vec::new())),
                _ => {
                    let row = rows.get_mut(key).expect("it is there");
                    let last = row.len() - 1;
                    row[last] ^= 0x55;
                }
            }
            let mut again = room.made();
            match again.recall(&rows) {
                Err(_) => refused += 1,
                Ok(()) => again.check_all(),
            }
        }
    }
    assert!(refused > rows.len(), "{refused} of {}", 3 * rows.len());
}

#[test]
fn a_row_of_nobodys_is_refused_and_so_are_more_branches_than_anybody_has() {
    let room = busy();
    let mut rows = room.rows().clone();
    rows.insert("m/x".to_owned(), vec![0]);
    assert!(room.made().recall(&rows).is_err());
    let mut rows = room.rows().clone();
    let own = rows.get_mut("m/parallel").expect("it is there");
    own.splice(0..1, [0xff, 0xff, 0xff, 0xff, 0x0f]);
    assert!(room.made().recall(&rows).is_err());
}

#[test]
fn with_fewer_or_more_branches_than_before_every_goal_goes_on() {
    for together in [1, 2, 5] {
        let before = busy();
        let mut other = parallel(together, PlannerKind::Graph);
        let mut again = other.made();
        again.recall(before.rows()).expect("it can be read");
        again.check();
        let goals = |machine: &ParallelAgent<AnyPlanner>| machine.intentions().count();
        assert_eq!(goals(&again), goals(&before.machine), "{together}");
        other.go_on_from(before, again);
        other.play(5000.0);
        assert_eq!(other.succeeded().len(), 5, "{together}: {:#?}", other.log);
        assert_eq!(other.machine.wake_at(), None);
    }
}
