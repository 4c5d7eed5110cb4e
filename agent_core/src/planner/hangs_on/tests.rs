//! What is said to break a plan does, and nothing else.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::sync::Arc;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use super::*;
use crate::language::{parse_domain, parse_literal};
use crate::model::{ActionModel, Atom, ExecutionModel};
use crate::planner::effect_of;
use crate::planner::random_domain::{Choices, all_facts, possible, problem, some_domain, step};

fn said(reliances: &[Reliance]) -> Vec<String> {
    let words = |it: &Reliance| {
        let not = if it.wanted { "" } else { "not " };
        let given = if it.given { "" } else { ", which is not so" };
        let alone = if it.changes_alone { "!" } else { "" };
        format!("{}: {not}{}{alone}{given}", it.step, it.fact)
    };
    reliances.iter().map(words).collect()
}

/// Rooms in a row, with doors that others open and close.
fn rooms(facts: &[&[&str]]) -> Problem {
    let text = "(define (domain d) (:requirements :typing :hierarchy :negative-preconditions)
        (:types room door)
        (:predicates (in ?r - room) (joins ?r ?s - room ?d - door) (open ?d - door) (wet ?r - room))
        (:action enter :parameters (?r ?s - room ?d - door)
          :precondition (and (in ?r) (joins ?r ?s ?d) (open ?d) (not (wet ?s)))
          :effect (and (not (in ?r)) (in ?s)))
        (:action mop :parameters (?r - room) :precondition (in ?r) :effect (wet ?r)))";
    let domain = parse_domain(text).expect("the rooms are in order");
    let parameters = &domain.operators["enter"].parameters;
    let protected = parse_literal("(open ?d)", parameters).expect("the condition is in order");
    let mut model = ExecutionModel {
        observable: vec![Symbol::from("open")],
        ..ExecutionModel::default()
    };
    let entry = ActionModel {
        protected: vec![protected],
        ..ActionModel::default()
    };
    model.actions.insert(Symbol::from("enter"), entry);
    let fact = |words: &&[&str]| Atom::new(words[0], words[1..].iter().copied());
    let belief = facts.iter().map(fact).collect();
    let mut problem = problem(&Arc::new(domain), &Arc::new(model), &belief);
    let map = Arc::make_mut(&mut problem.map);
    map.facts = [["joins", "a", "b", "d1"], ["joins", "b", "c", "d2"]]
        .map(|words| Atom::new(words[0], words[1..].iter().copied()))
        .into_iter()
        .collect();
    problem
}

fn steps(actions: &[&[&str]]) -> Vec<Step> {
    let step = |words: &&[&str]| step(&Atom::new(words[0], words[1..].iter().copied()));
    actions.iter().map(step).collect()
}

const THROUGH: [&[&str]; 2] = [&["enter", "a", "b", "d1"], &["enter", "b", "c", "d2"]];

#[test]
fn a_plan_hangs_on_what_no_earlier_step_brings_about() {
    let problem = rooms(&[&["in", "a"], &["open", "d1"], &["open", "d2"]]);
    assert_eq!(
        said(&hangs_on(&problem, &steps(&THROUGH), false)),
        [
            "0: (in a)",
            "0: (open d1)!",
            "0: not (wet b)",
            "1: (open d2)!",
            "1: not (wet c)"
        ]
    );
}

#[test]
fn a_step_that_runs_has_begun_but_goes_on_needing_what_is_protected() {
    let problem = rooms(&[&["open", "d1"], &["open", "d2"]]);
    assert_eq!(
        said(&hangs_on(&problem, &steps(&THROUGH), true)),
        ["0: (open d1)!", "1: (open d2)!", "1: not (wet c)"]
    );
}

#[test]
fn what_is_missing_is_named_too() {
    let problem = rooms(&[&["in", "a"], &["open", "d1"], &["wet", "c"]]);
    let said = said(&hangs_on(&problem, &steps(&THROUGH), false));
    assert_eq!(
        said[3..],
        [
            "1: (open d2)!, which is not so",
            "1: not (wet c), which is not so"
        ]
    );
}

#[test]
fn a_plan_breaks_if_what_it_hangs_on_changes_and_by_nothing_else() {
    let config = Config {
        // More of them with PROPTEST_CASES.
        cases: Config::default().cases.max(1_500),
        failure_persistence: None,
        ..Config::default()
    };
    let (hanging, free) = (Cell::new(0), Cell::new(0));
    let tape = prop::collection::vec(any::<u16>(), 600);
    let result = TestRunner::new(config).run(&tape, |tape| {
        let mut choices = Choices::new(&tape);
        let (domain, model) = some_domain(&mut choices);
        let facts = all_facts(&domain);
        let (domain, model) = (Arc::new(domain), Arc::new(model));
        let first: Belief = (facts.iter())
            .filter(|_| choices.percent(50))
            .cloned()
            .collect();
        let mut belief = first.clone();
        let mut steps = Vec::new();
        for _ in 0..5 {
            let now = problem(&domain, &model, &belief);
            let all = possible(&now);
            let Some(action) = choices.one_of(&all) else {
                break;
            };
            steps.push(step(action));
            belief.apply_all(&effect_of(&now, action));
        }
        let start = problem(&domain, &model, &first);
        prop_assert!(simulate(&start, &steps, false).is_ok());
        let said: BTreeSet<Fact> = hangs_on(&start, &steps, false)
            .into_iter()
            .map(|reliance| reliance.fact)
            .collect();
        let changing = changing(&start);
        for fact in facts.iter().filter(|fact| changing.contains(&fact.name)) {
            let otherwise = with_changes(&start, [(fact, !first.holds(fact))]);
            let breaks = simulate(&otherwise, &steps, false).is_err();
            prop_assert_eq!(
                breaks,
                said.contains(fact),
                "{} in {:?}\n{:?}\n{:#?}",
                fact,
                first,
                steps.iter().map(Step::action).collect::<Vec<_>>(),
                domain.operators
            );
            let count = if breaks { &hanging } else { &free };
            count.set(count.get() + 1);
        }
        Ok(())
    });
    if let Err(error) = result {
        panic!("{error}");
    }
    let counted = (hanging.get(), free.get());
    assert!(counted.0 > 500 && counted.1 > 5_000, "{counted:?}");
}
