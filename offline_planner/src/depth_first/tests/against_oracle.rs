//! Random problems: what the searches say is what the oracle says.

use super::oracle::Oracle;
use super::random::problem;
use super::{Outcome, Restarts, compiled, depth_first, judged, read, run};
use crate::control::{Control, Halt};
use crate::informed;
use crate::plan::Solution;
use agent_core::model::Cost;

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
fn informed_search_says_what_the_oracle_says() {
    let (mut plans, mut proofs) = (0, 0);
    for seed in seeds() {
        let (domain, problem) = problem(seed);
        let (model, instance) = read(&domain, &problem);
        let Some(solvable) = Oracle::new(&model, &instance).solvable() else {
            continue;
        };
        let compiled = compiled(&domain, &problem);
        let outcome = run(|control| informed::search(&compiled, &little_memory(control)));
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
            Outcome::Stopped(Halt::Memory) => {}
            Outcome::Stopped(halt) => panic!("seed {seed}: {halt:?}"),
        }
    }
    if seeds().end - seeds().start >= 100 {
        assert!(plans > 50 && proofs > 50, "{plans} plans, {proofs} proofs");
    }
}

#[test]
fn the_cheapest_plan_is_never_longer_than_another() {
    for seed in seeds() {
        let (domain, problem) = problem(seed);
        let compiled = compiled(&domain, &problem);
        let any = depth_first(&compiled, PATIENCE);
        let mut found: Vec<Cost> = Vec::new();
        let mut ended = Ok(());
        run(|control| {
            let control = little_memory(control);
            ended = informed::search_for_the_cheapest(&compiled, None, &control, &mut |choices| {
                let outcome = Outcome::Found(choices);
                judged(&domain, &problem, &compiled, &outcome);
                if let Outcome::Found(choices) = &outcome {
                    found.extend(Solution::new(&compiled, choices).map(|plan| plan.cost()));
                }
            });
            Outcome::Unsolvable
        });
        assert!(
            found.is_sorted_by(|worse, better| better < worse),
            "seed {seed}: each plan is better than those before"
        );
        if let (Outcome::Found(choices), Ok(())) = (&any, ended) {
            let any = Solution::new(&compiled, choices).map(|plan| plan.cost());
            let best = found.last().copied();
            assert!(
                best.is_some() && best <= any,
                "seed {seed}: {best:?} and {any:?}\n{domain}\n{problem}"
            );
        }
    }
}

/// Searches without end are over soon.
fn little_memory<'a>(control: &Control<'a>) -> Control<'a> {
    Control {
        memory_limit_bytes: 1 << 20,
        ..*control
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
