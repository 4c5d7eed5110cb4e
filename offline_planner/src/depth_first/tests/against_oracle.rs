//! Random problems: what the searches say is what the oracle says.

use super::oracle::Oracle;
use super::random::problem;
use super::{Outcome, Restarts, compiled, depth_first, judged, read, run};
use crate::control::Halt;

/// How many dead ends a search may meet before it may say that it does not know.
const PATIENCE: u64 = 3000;

/// `INTERMEZZO_PLANNER_SEEDS=FROM..TO` for more, or for one again.
fn seeds() -> std::ops::Range<u64> {
    let given = std::env::var("INTERMEZZO_PLANNER_SEEDS").ok();
    let range = given.as_deref().and_then(|given| given.split_once(".."));
    let range = range.and_then(|(from, to)| Some(from.parse().ok()?..to.parse().ok()?));
    range.unwrap_or(0..400)
}

#[test]
fn depth_first_search_says_what_the_oracle_says() {
    let (mut plans, mut proofs, mut open) = (0, 0, 0);
    for seed in seeds() {
        let (domain, problem) = problem(seed);
        let (model, instance) = read(&domain, &problem);
        let Some(solvable) = Oracle::new(&model, &instance).solvable() else {
            continue;
        };
        let compiled = compiled(&domain, &problem);
        let outcome = depth_first(&compiled, PATIENCE);
        match &outcome {
            Outcome::Found(_) => {
                assert!(solvable, "seed {seed}: a plan where there is none");
                judged(&domain, &problem, &compiled, &outcome);
                plans += 1;
            }
            Outcome::Unsolvable => {
                assert!(
                    !solvable,
                    "seed {seed}: a proof that is wrong\n{domain}\n{problem}"
                );
                proofs += 1;
            }
            Outcome::Stopped(Halt::Incomplete | Halt::Memory) => open += 1,
            Outcome::Stopped(Halt::Told) => panic!("seed {seed}: nobody told it to stop"),
        }
    }
    if seeds().end - seeds().start >= 100 {
        assert!(plans > 50 && proofs > 50, "{plans} plans, {proofs} proofs");
        assert!(open * 10 < plans + proofs, "{open} open");
    }
}

#[test]
fn restarts_find_only_plans_that_are_right() {
    for seed in seeds() {
        let (domain, problem) = problem(seed);
        let compiled = compiled(&domain, &problem);
        let found = matches!(depth_first(&compiled, PATIENCE), Outcome::Found(_));
        if found {
            let outcome = run(|control| Restarts::new(&compiled, seed).run(control));
            judged(&domain, &problem, &compiled, &outcome);
        }
    }
}
