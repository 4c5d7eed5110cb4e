//! The incremental planner against the one that plans from scratch, over histories made at random.
//!
//! `REPLANS=n` sets how often is planned (100,000 unless told otherwise), `REPLAN_SEED=s` repeats
//! the one history that a failure has named.

mod domains;
mod episode;
mod groups;
mod judged;
mod random;

use episode::{Episode, Tally};

/// So often is planned in an ordinary run.
const REPLANS: u64 = 100_000;

fn variable(name: &str) -> Option<u64> {
    std::env::var(name)
        .ok()
        .and_then(|value| value.parse().ok())
}

#[test]
#[expect(
    clippy::print_stderr,
    reason = "what was tried is worth seeing with --nocapture"
)]
fn what_is_kept_is_as_good_as_planning_from_scratch() {
    if let Some(seed) = variable("REPLAN_SEED") {
        Episode::new(seed).run(&mut Tally::default());
        return;
    }
    let wanted = variable("REPLANS").unwrap_or(REPLANS);
    let mut tally = Tally::default();
    let mut seed = 0;
    while tally.replans < wanted {
        Episode::new(seed).run(&mut tally);
        seed += 1;
    }
    eprintln!("{tally:?}");
    // The histories are worth something only if most goals can be reached and some cannot.
    assert!(10 * tally.plans > 3 * tally.replans, "{tally:?}");
    assert!(200 * tally.judged > tally.plans, "{tally:?}");
    assert!(50 * tally.proved_none > tally.replans, "{tally:?}");
}

/// I15.
#[test]
fn the_same_history_is_answered_in_the_same_way() {
    for seed in 0..30 {
        let [one, other] = [(); 2].map(|()| {
            let mut episode = Episode::new(seed);
            episode.run(&mut Tally::default());
            episode.trace
        });
        assert_eq!(one, other, "REPLAN_SEED={seed}");
    }
}

/// A planner that takes the first plan that it finds.
#[test]
fn an_impatient_planner_finds_a_plan_wherever_there_is_one() {
    let mut tally = Tally::default();
    for seed in 0..500 {
        Episode::new(seed).impatient().run(&mut tally);
    }
    assert!(tally.unproved > 20, "{tally:?}");
}

/// A planner that forgets what no goal leads to, all the time.
#[test]
fn what_is_forgotten_is_found_again() {
    for seed in 0..500 {
        Episode::new(seed).forgetful().run(&mut Tally::default());
    }
}
