//! All states within small budgets of faults, and mistakes that are found.

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
const EACH: Budget = Budget {
    losses: 1,
    duplicates: 1,
    crashes: 1,
};

fn holds(protocol: &Protocol) {
    let found = check(protocol, None, |_| {});
    assert!(found.violations.is_empty(), "{:#?}", found.violations);
    assert!(found.complete);
    // A model in which nothing happens holds everything.
    assert!(found.unique > 100, "only {} states", found.unique);
}

fn with(mutant: Mutant, goals: usize, budget: Budget) -> Found {
    check(&Protocol::new(goals, budget, Some(mutant)), None, |_| {})
}

fn is_found(mutant: Mutant, goals: usize, budget: Budget) {
    let found = with(mutant, goals, budget);
    assert!(!found.violations.is_empty(), "{mutant:?} was not found");
}

#[test]
fn one_goal_ends_once_whatever_happens_once_of_each_kind() {
    holds(&Protocol::new(1, EACH, None));
}

#[test]
fn two_goals_end_once_whatever_answer_is_lost() {
    holds(&Protocol::new(2, LOSS, None));
}

#[test]
fn two_goals_end_once_whatever_arrives_twice() {
    holds(&Protocol::new(2, DUPLICATE, None));
}

#[test]
fn processes_that_look_the_same_go_on_alike() {
    holds(&Protocol::new(1, EACH, None).doubting());
    holds(&Protocol::new(2, DUPLICATE, None).doubting());
}

#[test]
fn effects_that_do_not_wait_for_the_disk_are_found() {
    is_found(Mutant::Hasty, 1, CRASH);
}

#[test]
fn an_inbox_that_is_not_written_down_is_found() {
    is_found(Mutant::NoInbox, 1, CRASH);
}

#[test]
fn an_instruction_that_is_followed_again_when_it_comes_again_is_found() {
    is_found(Mutant::Afresh, 1, DUPLICATE);
}

#[test]
fn what_stops_something_and_is_not_heeded_as_that_has_not_begun_is_found() {
    is_found(Mutant::NoFence, 2, Budget::default());
}

#[test]
fn a_journal_that_does_not_write_is_found() {
    is_found(Mutant::Unwritten, 1, Budget::default());
}

#[test]
fn an_answer_that_does_not_say_how_something_ended_is_found() {
    is_found(Mutant::NoOutcome, 2, DUPLICATE);
}
