//! Whatever goes wrong: a task is done once, and never by two at a time.
//!
//! `SEED=7` runs one seed, `RUNS=100000` so many. What fails says its seed and what happened.

use super::rig::{Faults, World};
use super::*;

/// When nothing has gone wrong for long.
const END: Time = Time(400_000_000);

fn seeds(ordinarily: u64) -> Vec<u64> {
    let number = |name: &str| std::env::var(name).ok()?.parse::<u64>().ok();
    match number("SEED") {
        Some(seed) => vec![seed],
        None => (0..number("RUNS").unwrap_or(ordinarily)).collect(),
    }
}

#[derive(Debug, Default)]
struct Sums {
    done: u32,
    failed: u32,
    stay_with_the_dead: u32,
    found_done: u32,
    begun: u32,
    given_up: u32,
}

fn run(seed: u64, faults: Faults, sums: &mut Sums) {
    let mut world = World::new(seed, faults);
    world.run(END);
    let log = || world.log.join("\n");
    for (task, publisher) in &world.publisher_of {
        let done = world.done.get(task).copied().unwrap_or_default();
        assert!(
            done <= 1,
            "seed {seed}: {task} was done {done} times\n{}",
            log()
        );
        let ended = world.ended.get(task);
        match ended {
            Some(Outcome::Done { .. }) => {
                assert_eq!(done, 1, "seed {seed}: {task} is said to be done\n{}", log());
                sums.done += 1;
            }
            Some(Outcome::Failed { .. }) if faults.work => {
                assert_eq!(
                    done,
                    0,
                    "seed {seed}: {task} is said to have failed\n{}",
                    log()
                );
                sums.failed += 1;
            }
            None if world.is_dead(*publisher) => sums.stay_with_the_dead += 1,
            // Whoever could do it, or has done it, may be dead for good.
            None if world.anybody_is_dead() => sums.stay_with_the_dead += 1,
            other => panic!(
                "seed {seed}: {task} is {other:?}, done {done} times\n{}",
                log()
            ),
        }
    }
    sums.found_done += world.found_done;
    sums.begun += world.begun;
    sums.given_up += world.given_up;
}

#[test]
fn messages_that_are_lost_late_or_repeated_have_nothing_done_twice_or_not_at_all() {
    let faults = Faults {
        messages: true,
        vehicles: false,
        work: false,
    };
    let mut sums = Sums::default();
    for seed in seeds(300) {
        run(seed, faults, &mut sums);
    }
    // Nobody had to look first whether there is anything left to do.
    assert_eq!(sums.found_done, 0);
    assert_eq!(sums.stay_with_the_dead, 0);
}

#[test]
fn a_task_is_done_once_and_never_by_two_at_a_time_whoever_dies_freezes_or_is_cut_off() {
    let faults = Faults {
        messages: true,
        vehicles: true,
        work: true,
    };
    let mut sums = Sums::default();
    for seed in seeds(600) {
        run(seed, faults, &mut sums);
    }
    if std::env::var("SEED").is_err() {
        assert!(
            sums.given_up > 100 && sums.done > 500,
            "nothing much has happened: {sums:?}"
        );
    }
}
