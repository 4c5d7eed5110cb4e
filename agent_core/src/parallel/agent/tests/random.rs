//! Random days: guests come and go, things are spilt, processes die.

use std::collections::BTreeSet;

use super::bistro::{GUESTS, PLACES, fact};
use super::room::{Driver, Plot, Room};
use super::{ordinary, parallel};
use crate::model::{FactChange, Symbol};
use crate::parallel::tests::Chance;
use crate::planner::PlannerKind;
use crate::protocol::{Command, Happening, Urgency};

const NAMES: [&str; 12] = ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l"];

fn kind(chance: &mut Chance) -> PlannerKind {
    match chance.below(4) {
        0 => PlannerKind::Naive,
        _ => PlannerKind::Graph,
    }
}

/// Goals and emergencies at random times. With `restless`, guests leave, users change their minds and
/// processes die.
fn day<M: Driver>(room: &mut Room<M>, chance: &mut Chance, restless: bool) -> BTreeSet<Symbol> {
    let mut goals = BTreeSet::new();
    let count = 1 + chance.below(8) as usize;
    room.tempo = (0..7).map(|_| 85 + chance.below(31)).collect();
    let at = |chance: &mut Chance, most: u64| chance.below(most * 10) as f64 / 10.0;
    for name in NAMES.iter().take(count) {
        let guest = chance.below(GUESTS as u64);
        let place = PLACES[1 + chance.below(3) as usize];
        let when = at(chance, 300);
        let priority = chance.below(3) as i32;
        let (task, urgency) = match chance.below(6) {
            0 => {
                let spill = fact(&format!("(spill {place})"));
                room.at(when, Plot::Fact(FactChange::Add(spill)));
                (format!("(clean {place})"), Urgency::Emergency)
            }
            1 => (format!("(chat g{guest})"), Urgency::Normal),
            2 => (format!("(clean {place})"), Urgency::Normal),
            _ => (format!("(serve g{guest})"), Urgency::Normal),
        };
        room.at(when, Plot::Goal(name, task, urgency, priority));
        goals.insert(Symbol::from(*name));
        if !restless {
            continue;
        }
        let goal = Symbol::from(*name);
        match chance.below(6) {
            0 => {
                let later = when + at(chance, 200);
                room.at(later, Plot::Command(Command::Cancel(goal)));
            }
            1 => {
                let later = when + at(chance, 100);
                room.at(later, Plot::Command(Command::Suspend(goal.clone())));
                let later = later + at(chance, 100);
                room.at(later, Plot::Command(Command::Resume(goal)));
            }
            2 => {
                // The guest leaves, and whoever has ordered for that guest takes it back.
                let table = PLACES[1 + guest as usize % 3];
                let seated = fact(&format!("(seated g{guest} {table})"));
                room.at(
                    when + at(chance, 200),
                    Plot::Fact(FactChange::Remove(seated)),
                );
            }
            3 => room.at(at(chance, 500), Plot::Restart),
            4 => {
                let blocked = fact(&format!("(blocked {place})"));
                let from = at(chance, 300);
                room.at(from, Plot::Fact(FactChange::Add(blocked.clone())));
                room.at(
                    from + at(chance, 300),
                    Plot::Fact(FactChange::Remove(blocked)),
                );
            }
            _ => {}
        }
    }
    goals
}

#[test]
fn one_at_a_time_does_exactly_what_an_ordinary_agent_does() {
    for seed in 0..150 {
        let mut chance = Chance(seed);
        let kind = kind(&mut chance);
        let begin = chance.0;
        let mut one = parallel(1, kind);
        day(&mut one, &mut Chance(begin), true);
        one.play(20_000.0);
        let mut other = ordinary(kind);
        day(&mut other, &mut Chance(begin), true);
        other.play(20_000.0);
        assert_eq!(one.log, other.log, "seed {seed}");
        assert_eq!(one.succeeded(), other.succeeded(), "seed {seed}");
    }
}

#[test]
fn whatever_comes_every_goal_ends_and_nothing_is_shared_that_cannot_be() {
    let (mut combined, mut lifted) = (0, 0);
    for seed in 0..400 {
        let mut chance = Chance(seed);
        let together = 2 + chance.below(3) as usize;
        let mut room = parallel(together, kind(&mut chance));
        let restless = chance.below(3) > 0;
        let goals = day(&mut room, &mut chance, restless);
        // The room itself watches over resources, needs and protected states, the tray's slots among
        // them.
        room.play(20_000.0);
        // Who has left will not come back.
        let open: Vec<Symbol> = (room.machine.intentions())
            .map(|it| it.goal.id.clone())
            .collect();
        for goal in &open {
            let of_guest = room.machine.wanted();
            let waits = of_guest.iter().find(|(id, _)| id == goal);
            let (_, wanted) =
                waits.unwrap_or_else(|| panic!("seed {seed}: {goal} is not over\n{:#?}", room.log));
            let gone = wanted.iter().any(|it| it.name == "seated");
            assert!(
                gone,
                "seed {seed}: {goal} waits for {wanted:?}\n{:#?}",
                room.log
            );
        }
        let over: BTreeSet<Symbol> = (goals.iter())
            .filter(|goal| room.machine.ended_goal(goal).is_some())
            .cloned()
            .collect();
        assert_eq!(over.len() + open.len(), goals.len(), "seed {seed}");
        let handed: Vec<String> = (room.log.iter())
            .filter(|line| line.contains("done (put-drink"))
            .filter_map(|line| line.split_whitespace().nth(3).map(str::to_owned))
            .collect();
        let once: BTreeSet<&String> = handed.iter().collect();
        assert_eq!(
            once.len(),
            handed.len(),
            "seed {seed}: served twice\n{:#?}",
            room.log
        );
        for event in &room.events {
            if let Happening::ActionsCombined { why, .. } = &event.what {
                combined += 1;
                lifted += usize::from(why.contains("taken back"));
            }
        }
    }
    assert!(
        combined > 100,
        "something was done together: {combined}, {lifted}"
    );
}
