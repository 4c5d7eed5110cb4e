//! All states with one kind of fault, and mistakes that are found.

use intermezzo_model_check::{Budget, Found, Mutant, Protocol, check};

const LOSS: Budget = Budget {
    losses: 1,
    duplicates: 0,
    crashes: 0,
};
const DUPLICATE: Budget = Budget {
    losses: 0,
    duplicates: 1,
    crashes: 0,
};
const CRASH: Budget = Budget {
    losses: 0,
    duplicates: 0,
    crashes: 1,
};

fn all_states(goals: usize, budget: Budget, mutant: Option<Mutant>) -> Found {
    check(&Protocol::new(goals, budget, mutant), None)
}

fn holds(goals: usize, budget: Budget) {
    let found = all_states(goals, budget, None);
    assert!(found.violations.is_empty(), "{:#?}", found.violations);
    // A model in which nothing happens holds everything.
    assert!(found.unique > 100, "only {} states", found.unique);
}

fn is_found(mutant: Mutant, goals: usize, budget: Budget) {
    let found = all_states(goals, budget, Some(mutant));
    assert!(!found.violations.is_empty(), "{mutant:?} was not found");
}

#[test]
fn two_goals_end_once_whatever_answer_is_lost() {
    holds(2, LOSS);
}

#[test]
fn one_goal_ends_once_whatever_arrives_twice() {
    holds(1, DUPLICATE);
}

#[test]
fn one_goal_ends_once_whoever_dies() {
    holds(1, CRASH);
}

#[test]
fn effects_that_do_not_wait_for_the_disk_are_found() {
    is_found(Mutant::Hasty, 1, CRASH);
}

#[test]
fn an_inbox_that_is_not_written_down_is_found() {
    is_found(Mutant::NoInbox, 1, CRASH);
}
