//! Everything at once, at random, from a seed: goals of both kinds, users who suspend, resume and
//! cancel, doors that open and close, faults, and messages that take their time. Whatever happens,
//! the agents' invariants hold after every input (the harness asserts them), and once all doors are
//! open and nobody interferes, every goal that was accepted ends, and nothing is left behind.
//!
//! Three times: with the planner that agents have, from scratch, and with both, which must come to the same
//! costs whenever an agent plans.
//!
//! `STORMS=10000 cargo test --release -p intermezzo_tests --test storm` weathers more of them;
//! `STORM=7` only the one of that seed, and tells its story.

use std::collections::BTreeMap;

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Command, Happening, Urgency};
use executor_sim::{Fault, Faults};
use intermezzo_tests::{Museum, Planning, Stack, Wire, museum};

/// How many are weathered when nobody asks for more.
const STORMS: u64 = 100;

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % sides
    }

    fn one_of<'a, T>(&mut self, things: &'a [T]) -> &'a T {
        &things[self.roll(things.len() as u64) as usize]
    }
}

const DOORS: [&str; 6] = [
    "door1_2", "door1_3", "door3_5", "door4_6", "door5_7", "door6_8",
];
const PLACES: [&str; 9] = ["n1", "n4", "n6", "n12", "n13", "n19", "n28", "n32", "n40"];
const TASKS: [&str; 5] = ["go", "show", "guide", "answer", "go"];

fn stack(museum: &Museum, dice: &mut Dice, seed: u64) -> Stack {
    let spread = [0.0, 0.02, 0.5][dice.roll(3) as usize];
    let wire = Wire::random(seed, Time::from_secs(0.001), Time::from_secs(spread));
    let faults = Faults::list([
        (dice.roll(6), Fault::Failure { fraction: 0.4 }),
        (6 + dice.roll(4), Fault::RefusedSuspension),
        (10 + dice.roll(4), Fault::Slow { pace: 0.4 }),
        (
            14 + dice.roll(4),
            Fault::LateStop {
                delay: Time::from_secs(2.0),
            },
        ),
        (18 + dice.roll(9), Fault::Failure { fraction: 0.9 }),
    ]);
    let keep_what_helps = dice.roll(2) == 0;
    let wings: BTreeMap<Symbol, Symbol> = match dice.roll(3) {
        0 => ["area2", "area4", "area6"]
            .map(|area| (area.into(), "east".into()))
            .into(),
        _ => BTreeMap::new(),
    };
    let mut stack = Stack::new(wire);
    let mut parent = museum.parent_of("n1", wings);
    parent.policy.keep_what_helps = keep_what_helps;
    stack.add_agent(museum.agent(parent), &["child", "east"]);
    for name in ["child", "east"] {
        stack.add_agent(
            museum.agent(museum.child("n1", name, "executor")),
            &["executor"],
        );
    }
    stack.add_robot("executor", museum.robot("n1", faults));
    stack
}

#[expect(
    clippy::print_stdout,
    reason = "whoever asks for one storm wants its story"
)]
fn storm(museum: &Museum, seed: u64) {
    let mut dice = Dice(seed);
    let mut stack = stack(museum, &mut dice, seed);
    let mut goals: Vec<String> = Vec::new();
    for number in 0..12 {
        stack.run_until(stack.now().secs() + dice.roll(15_000) as f64 / 1000.0);
        match dice.roll(10) {
            0..=4 => {
                let id = format!("goal{number}");
                let task = format!("({} {})", dice.one_of(&TASKS), dice.one_of(&PLACES));
                let urgency = *dice.one_of(&[Urgency::Normal, Urgency::Emergency]);
                let priority = dice.roll(3) as i32;
                let verdict = stack.ask("parent", &id, &task, urgency, priority);
                assert_eq!(verdict, Ok(id.as_str().into()));
                goals.push(id);
            }
            5..=7 => {
                let not = dice.roll(2) == 0;
                let fact = format!("(open {})", dice.one_of(&DOORS));
                stack.world(&if not { format!("(not {fact})") } else { fact });
            }
            _ if goals.is_empty() => {}
            _ => {
                let goal: Symbol = dice.one_of(&goals).as_str().into();
                let command = match dice.roll(3) {
                    0 => Command::Suspend(goal),
                    1 => Command::Resume(goal),
                    _ => Command::Cancel(goal),
                };
                // Refused with a reason or carried out; either is fine.
                let _ = stack.command(command);
            }
        }
    }
    // The storm is over.
    for door in DOORS {
        stack.world(&format!("(open {door})"));
    }
    stack.run();
    for goal in &goals {
        let _ = stack.command(Command::Resume(goal.as_str().into()));
    }
    stack.run();
    if std::env::var_os("STORM").is_some() {
        println!("{}", stack.story());
    }
    for goal in &goals {
        let ends = stack.about("parent", goal).filter(|event| {
            matches!(
                event.what,
                Happening::GoalSucceeded | Happening::GoalFailed { .. }
            )
        });
        assert_eq!(
            ends.count(),
            1,
            "seed {seed}: {goal} ends once\n{}",
            stack.story()
        );
    }
    for name in ["parent", "child", "east"] {
        let left: usize = stack.agent(name).counts().values().sum();
        assert_eq!(
            left,
            0,
            "seed {seed}: nothing is left at {name}\n{}",
            stack.story()
        );
    }
}

#[test]
fn after_a_storm_every_goal_has_ended_once_and_nothing_is_left() {
    storms(Planning::AsShipped);
}

#[test]
fn agents_that_plan_from_scratch_weather_storms_too() {
    storms(Planning::FromScratch);
}

#[test]
fn in_a_storm_no_plan_costs_more_than_one_from_scratch() {
    storms(Planning::Both);
}

fn storms(planning: Planning) {
    let mut museum = museum();
    museum.planning = planning;
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse().ok());
    if let Some(seed) = number("STORM") {
        return storm(&museum, seed);
    }
    for seed in 0..number("STORMS").unwrap_or(STORMS) {
        storm(&museum, seed);
    }
}
