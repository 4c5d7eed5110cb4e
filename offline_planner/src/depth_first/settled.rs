//! Goals that nothing left to do can help.

use super::facts::Facts;
use crate::compile::{Compiled, ObjectId, PredicateId};

/// For each task of the problem, in order, the facts that must be as the goal wants them when it
/// begins, as neither it nor a later task can bring that about.
#[derive(Debug)]
pub struct Settled {
    before: Vec<Vec<Goal>>,
}

/// A fact that must hold, or must not.
#[derive(Clone, Debug)]
struct Goal {
    holds: bool,
    predicate: PredicateId,
    args: Vec<ObjectId>,
}

impl Settled {
    pub fn new(compiled: &Compiled) -> Self {
        let methods = &compiled.task(compiled.top).methods;
        let count = methods
            .first()
            .map_or(0, |top| compiled.method(*top).subtasks.len());
        let mut before: Vec<Vec<Goal>> = vec![Vec::new(); count];
        for goal in &compiled.goals {
            let from = goal.last_help.map_or(0, |last| last + 1);
            for goals in before.iter_mut().skip(from) {
                goals.push(Goal {
                    holds: goal.holds,
                    predicate: goal.fact.predicate,
                    args: goal.fact.args.iter().map(|term| term.value(&[])).collect(),
                });
            }
        }
        Self { before }
    }

    /// How many tasks the problem has, the artificial one included.
    pub fn tasks(&self) -> usize {
        self.before.len()
    }

    /// Whether the task of that place may begin.
    pub fn allows(&self, place: usize, facts: &Facts) -> bool {
        self.before.get(place).is_none_or(|goals| {
            goals
                .iter()
                .all(|goal| facts.holds(goal.predicate, goal.args.iter().copied()) == goal.holds)
        })
    }
}
