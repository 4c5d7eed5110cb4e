//! Tasks that come up by themselves.

use std::collections::BTreeSet;

use super::Problem;
use super::matching::for_each_binding;
use super::state::{Delta, View};
use crate::model::{Clause, Fact, Symbol, Task};

/// One way in which a rule of the execution model says that a task comes up.
#[derive(Clone, Debug, Eq, PartialEq, Ord, PartialOrd)]
pub struct Arisen {
    /// Which rule.
    pub rule: usize,
    /// What its variables stand for.
    pub objects: Vec<Symbol>,
    /// What is to be done.
    pub task: Task,
}

/// All that is to be done now, by the rules for tasks that come up by themselves.
pub fn arising(problem: &Problem) -> BTreeSet<Arisen> {
    let delta = Delta::new();
    let view = View {
        problem,
        delta: &delta,
    };
    let mut all = BTreeSet::new();
    for (rule, arising) in problem.model.arising.iter().enumerate() {
        for_each_binding(
            view,
            &arising.parameters,
            &arising.when,
            vec![None; arising.parameters.len()],
            &mut BTreeSet::new(),
            &mut |bindings| {
                let objects = bindings.iter().flatten().cloned().collect();
                all.extend(arising.task.ground(bindings).map(|task| Arisen {
                    rule,
                    objects,
                    task,
                }));
            },
        );
    }
    all
}

/// So many facts are asked for at once.
const MOST_ASKED_FOR: usize = 64;

/// What would have to be known before a task can be decomposed: facts of predicates that are asked for
/// (`asked` of the execution model), which a method of the task wants and none of which holds. Only
/// the methods of the task itself are looked at.
pub fn asks_for(problem: &Problem, task: &Task) -> BTreeSet<Fact> {
    let mut all = BTreeSet::new();
    let methods = problem.domain.methods.iter();
    for method in methods.filter(|method| method.task.name == task.name) {
        let mut bindings = vec![None; method.parameters.len()];
        let fits = method
            .task
            .args
            .iter()
            .zip(&task.args)
            .all(|(term, object)| match term {
                crate::model::Term::Variable(place) => match bindings.get_mut(*place) {
                    Some(bound @ None) => {
                        *bound = Some(object.clone());
                        true
                    }
                    Some(Some(bound)) => bound == object,
                    None => false,
                },
                crate::model::Term::Constant(constant) => constant == object,
            });
        if !fits {
            continue;
        }
        for clause in &method.precondition {
            if let Clause::Fact(true, pattern) = clause
                && problem.model.asked.contains(&pattern.name)
            {
                let candidates = instances(problem, &method.parameters, pattern, &bindings);
                if !candidates.iter().any(|fact| problem.belief.holds(fact)) {
                    all.extend(candidates);
                }
            }
        }
    }
    all
}

/// All facts that a pattern may stand for.
fn instances(
    problem: &Problem,
    parameters: &[crate::model::Parameter],
    pattern: &crate::model::Pattern,
    bindings: &[Option<Symbol>],
) -> Vec<Fact> {
    let mut all = vec![bindings.to_vec()];
    for term in &pattern.args {
        let crate::model::Term::Variable(place) = term else {
            continue;
        };
        let Some(parameter) = parameters.get(*place) else {
            return Vec::new();
        };
        let mut more = Vec::new();
        for bindings in all {
            if bindings.get(*place).is_some_and(Option::is_some) {
                more.push(bindings);
                continue;
            }
            for object in problem.objects_of(&parameter.kind) {
                let mut bindings = bindings.clone();
                if let Some(free) = bindings.get_mut(*place) {
                    *free = Some(object);
                }
                more.push(bindings);
            }
        }
        more.truncate(MOST_ASKED_FOR);
        all = more;
    }
    let facts = all.iter().filter_map(|bindings| pattern.ground(bindings));
    facts.collect()
}
