//! Groups that are found are never broken: against everything that can happen in random domains.

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use super::{Group, mutex_groups};
use crate::model::{Action, Belief, Fact, FactChange, Symbol};
use crate::planner::random_domain::{Choices, all_facts, can, ground, problem, some_domain};
use crate::planner::{Problem, effect_of, effect_of_suspension, instance};

/// How many facts of the group hold, for each choice of parameters.
fn weights(group: &Group, belief: &Belief) -> BTreeMap<Vec<Symbol>, usize> {
    let mut weights = BTreeMap::new();
    for parameters in belief.facts().filter_map(|fact| group.variable_of(fact)) {
        *weights.entry(parameters).or_default() += 1;
    }
    weights
}

/// A random belief in which the group holds, full of facts as far as it allows.
fn some_belief(choices: &mut Choices<'_>, facts: &[Fact], group: &Group) -> Belief {
    let mut taken = BTreeSet::new();
    let mut belief = Belief::default();
    // Another fact is the first to come each time.
    let first = choices.below(facts.len());
    for fact in facts[first..].iter().chain(&facts[..first]) {
        let is_free = |variable| taken.insert(variable);
        if choices.percent(60) && group.variable_of(fact).is_none_or(is_free) {
            belief.apply(&FactChange::Add(fact.clone()));
        }
    }
    belief
}

/// Everything that can happen in a belief, and what it changes.
fn happenings(problem: &Problem) -> Vec<(String, Vec<FactChange>)> {
    let mut found = Vec::new();
    for operator in problem.domain.operators.values() {
        for args in ground(&problem.domain, &operator.parameters) {
            let action = Action {
                name: operator.name.clone(),
                args,
            };
            let model = problem.model.actions.get(&operator.name);
            let suspension = model.and_then(|model| model.suspension.as_ref());
            let resuming = suspension.and_then(|of| instance(&of.resume, &action));
            if suspension.is_some()
                && (can(problem, &action) || resuming.is_some_and(|it| can(problem, &it)))
            {
                let changes = effect_of_suspension(problem, &action);
                found.push((format!("{action} is suspended"), changes));
            }
            if can(problem, &action) {
                found.push((action.to_string(), effect_of(problem, &action)));
            }
        }
    }
    found
}

#[test]
fn no_action_and_no_suspension_breaks_a_group() {
    let config = Config {
        // More of them with PROPTEST_CASES.
        cases: Config::default().cases.max(1_500),
        failure_persistence: None,
        ..Config::default()
    };
    let (with_groups, joint, steps) = (Cell::new(0), Cell::new(0), Cell::new(0));
    let mut runner = TestRunner::new(config);
    let tape = prop::collection::vec(any::<u16>(), 600);
    let result = runner.run(&tape, |tape| {
        let mut choices = Choices::new(&tape);
        let (domain, model) = some_domain(&mut choices);
        let groups = mutex_groups(&domain, &model);
        let facts = all_facts(&domain);
        let (domain, model) = (Arc::new(domain), Arc::new(model));
        with_groups.set(with_groups.get() + usize::from(!groups.is_empty()));
        for group in &groups {
            joint.set(joint.get() + usize::from(group.parts().len() > 1));
            for _ in 0..4 {
                let mut belief = some_belief(&mut choices, &facts, group);
                for _ in 0..3 {
                    let problem = problem(&domain, &model, &belief);
                    let all = happenings(&problem);
                    for (what, changes) in &all {
                        let mut after = belief.clone();
                        after.apply_all(changes);
                        prop_assert!(
                            weights(group, &after).values().all(|weight| *weight <= 1),
                            "{what} breaks {group}\nbefore: {belief:?}\nafter: {after:?}\n\
                             {:#?}\n{:#?}",
                            domain.operators,
                            model.actions,
                        );
                        steps.set(steps.get() + 1);
                    }
                    let Some((_, changes)) = choices.one_of(&all) else {
                        break;
                    };
                    belief.apply_all(changes);
                }
            }
        }
        Ok(())
    });
    if let Err(error) = result {
        panic!("{error}");
    }
    // A search that finds nothing would pass all of the above.
    let found = (with_groups.get(), joint.get(), steps.get());
    assert!(
        found.0 > 100 && found.1 > 20 && found.2 > 10_000,
        "{found:?}"
    );
}
