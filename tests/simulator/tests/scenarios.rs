//! Some thousand scenarios, and the mutants that they catch.

use intermezzo_simulator::fleet::Fleet;
use intermezzo_simulator::ground::Ground;
use intermezzo_simulator::mutant::{MUTANTS, Mutant};
use intermezzo_simulator::shrink::{run_safely, shrink};
use serde::Deserialize;

/// How many are run when nobody asks for more (`SCENARIOS=100000`).
const SCENARIOS: u64 = 1000;

#[test]
fn whatever_goes_wrong_every_acknowledged_goal_ends_and_nothing_is_done_twice() {
    let asked = std::env::var("SCENARIOS").ok();
    let scenarios = asked
        .and_then(|text| text.parse().ok())
        .unwrap_or(SCENARIOS);
    let ground = Ground::new();
    for seed in 0..scenarios {
        let fleet = Fleet::at(seed);
        if let Some(broken) = run_safely(&ground, &fleet, None, false).broken {
            let least = shrink(&ground, &fleet, None);
            let story = run_safely(&ground, &least, None, true);
            panic!(
                "seed {seed}: {broken}\n{least}\n{}\n{:?}",
                story.story.join("\n"),
                story.broken
            );
        }
    }
}

#[derive(Deserialize)]
struct Listed {
    mutant: Vec<Caught>,
}

#[derive(Deserialize)]
struct Caught {
    name: Mutant,
    seed: u64,
}

#[test]
fn every_mutant_on_the_list_is_caught_by_its_seed() {
    let text = include_str!("../mutants.toml");
    let listed: Listed = toml::from_str(text).expect("the list is TOML");
    let ground = Ground::new();
    assert!(listed.mutant.len() >= 20);
    for Caught { name, seed } in listed.mutant {
        assert!(MUTANTS.contains(&name));
        let outcome = run_safely(&ground, &Fleet::at(seed), Some(name), false);
        assert!(outcome.broken.is_some(), "{name} survives seed {seed}");
    }
}

#[test]
fn a_failing_scenario_shrinks_to_one_that_fails_and_has_no_more_in_it() {
    let ground = Ground::new();
    let mutant = Some(Mutant::SuspendedTooSoon);
    let fleet = (0..50)
        .map(Fleet::at)
        .find(|fleet| run_safely(&ground, fleet, mutant, false).broken.is_some())
        .expect("it is caught soon");
    let least = shrink(&ground, &fleet, mutant);
    assert!(run_safely(&ground, &least, mutant, false).broken.is_some());
    assert!(least.happenings() < fleet.happenings());
}
