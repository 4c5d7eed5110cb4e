//! From a scenario that goes wrong to the least that does.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};

use agent_core::model::Time;
use agent_core::planner::PlannerKind;

use crate::fleet::Fleet;
use crate::ground::Ground;
use crate::mutant::Mutant;
use crate::scenario::{Point, Scenario, What};
use crate::simulation::{Outcome, run_fleet};

thread_local! {
    static PANICKED: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// From now on a panic is kept for [`run_safely`] instead of being printed.
pub fn keep_panics() {
    std::panic::set_hook(Box::new(|panic| {
        let text = panic.to_string();
        PANICKED.with(|panicked| *panicked.borrow_mut() = Some(text));
    }));
}

/// Runs what there is of robots; a panic is something that was wrong, like all else.
pub fn run_safely(ground: &Ground, fleet: &Fleet, mutant: Option<Mutant>, tells: bool) -> Outcome {
    let ran = catch_unwind(AssertUnwindSafe(|| run_fleet(ground, fleet, mutant, tells)));
    ran.unwrap_or_else(|_| {
        let panicked = PANICKED.with(|panicked| panicked.borrow_mut().take());
        Outcome {
            broken: Some(panicked.unwrap_or_else(|| "a panic".to_owned())),
            ..Outcome::default()
        }
    })
}

/// Takes away whatever it goes wrong without. It must go wrong.
pub fn shrink(ground: &Ground, fleet: &Fleet, mutant: Option<Mutant>) -> Fleet {
    let breaks = |fleet: &Fleet| run_safely(ground, fleet, mutant, false).broken.is_some();
    let mut least = fleet.clone();
    for robot in (0..least.robots.len()).rev() {
        let mut less = least.clone();
        less.robots.remove(robot);
        if breaks(&less) {
            least = less;
        }
    }
    for robot in 0..least.robots.len() {
        let with = |scenario: &Scenario| {
            let mut less = least.clone();
            less.robots[robot] = scenario.clone();
            less
        };
        let shrunk = shrink_one(&least.robots[robot], |less| breaks(&with(less)));
        least.robots[robot] = shrunk;
    }
    least
}

fn shrink_one(scenario: &Scenario, breaks: impl Fn(&Scenario) -> bool) -> Scenario {
    let mut least = scenario.clone();
    loop {
        let before = least.clone();
        for n in (0..least.happenings.len()).rev() {
            let mut less = least.clone();
            less.happenings.remove(n);
            if breaks(&less) {
                least = less;
            }
        }
        for simpler in SIMPLER {
            let mut less = least.clone();
            simpler(&mut less);
            if less != least && breaks(&less) {
                least = less;
            }
        }
        for n in 0..least.happenings.len() {
            let mut less = least.clone();
            plainer(&mut less.happenings[n].1);
            if less != least && breaks(&less) {
                least = less;
            }
        }
        if least == before {
            return least;
        }
    }
}

const SIMPLER: [fn(&mut Scenario); 7] = [
    |scenario| scenario.two_children = false,
    |scenario| scenario.redb = false,
    |scenario| scenario.planner = PlannerKind::Naive,
    |scenario| scenario.hindsight = true,
    |scenario| scenario.spread = Time::ZERO,
    |scenario| scenario.writing = Time::ZERO,
    |scenario| {
        let first = scenario.happenings.first().map_or(0, |(at, _)| at.0);
        for (at, _) in &mut scenario.happenings {
            at.0 -= first;
        }
    },
];

/// The same, with fewer peculiarities.
fn plainer(what: &mut What) {
    match what {
        What::Goal { priority, .. } => *priority = 0,
        What::Crash { point, .. } => *point = Point::Now,
        What::Weather {
            lost, twice, late, ..
        } => {
            // One kind of weather at a time, if that will do.
            if *lost > 0 && (*twice > 0 || *late > 0) {
                (*twice, *late) = (0, 0);
            } else if *twice > 0 && *late > 0 {
                *late = 0;
            }
        }
        _ => {}
    }
}
