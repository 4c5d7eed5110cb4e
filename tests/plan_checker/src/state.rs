//! What is true at one point of a plan.

use rustc_hash::FxHashMap;

use crate::model::{Change, Formula, Id, Model, Task};
use crate::solve::{Solver, Values, World, value};

/// The facts that are true.
#[derive(Debug, Default)]
pub(crate) struct State {
    /// Where each of them stands among those of its predicate.
    places: FxHashMap<Box<[Id]>, usize>,
    facts: Vec<Vec<Box<[Id]>>>,
}

impl World for State {
    fn holds(&self, fact: &[Id]) -> bool {
        self.places.contains_key(fact)
    }

    fn candidates(&self, predicate: Id) -> &[Box<[Id]>] {
        &self.facts[predicate as usize]
    }
}

impl State {
    pub(crate) fn initial(model: &Model) -> Self {
        let mut state = Self {
            places: FxHashMap::default(),
            facts: vec![Vec::new(); model.predicates.len()],
        };
        for fact in &model.initially {
            state.set(fact, true);
        }
        state
    }

    /// Makes a fact true or not; says whether it was otherwise before.
    pub(crate) fn set(&mut self, fact: &[Id], truth: bool) -> bool {
        let facts = &mut self.facts[fact[0] as usize];
        if !truth {
            let Some(place) = self.places.remove(fact) else {
                return false;
            };
            facts.swap_remove(place);
            if let Some(moved) = facts.get(place)
                && let Some(moved) = self.places.get_mut(moved)
            {
                *moved = place;
            }
            return true;
        }
        if self.places.contains_key(fact) {
            return false;
        }
        self.places.insert(fact.into(), facts.len());
        facts.push(fact.into());
        true
    }

    /// What an action changes here: facts that become false, then facts that become true, so that
    /// what is both stays true. `Err` is the part of its precondition that does not hold.
    pub(crate) fn changes(
        &self,
        model: &Model,
        task: &Task,
        arguments: &[Id],
    ) -> Result<Vec<(Vec<Id>, bool)>, String> {
        let Some(action) = &task.action else {
            return Ok(Vec::new());
        };
        let mut values: Values = arguments.iter().map(|each| Some(*each)).collect();
        values.resize(action.variables.len(), None);
        let solver = Solver {
            model,
            world: self,
            variables: &action.variables,
        };
        if let Some(part) = solver.first_false(&action.condition, &mut values) {
            return Err(model.formula(part, &action.variables, &values));
        }
        let mut changes = Vec::new();
        for change in &action.changes {
            let plain = matches!(&change.when, Formula::And(parts) if parts.is_empty());
            if plain && change.over.is_empty() {
                changes.push((fact(change, &values), change.add));
            } else {
                solver.solutions(&change.when, &change.over, &mut values, &mut |values| {
                    changes.push((fact(change, values), change.add));
                    false
                });
            }
        }
        changes.sort_by_key(|(_, add)| *add);
        Ok(changes)
    }
}

fn fact(change: &Change, values: &Values) -> Vec<Id> {
    let objects = (change.atom.terms.iter()).filter_map(|term| value(term, values));
    std::iter::once(change.atom.name).chain(objects).collect()
}

/// What an action adds to the cost of the plan. Without a value for a function it adds nothing.
pub(crate) fn cost(model: &Model, task: &Task, arguments: &[Id]) -> f64 {
    use crate::model::Cost;
    let Some(action) = &task.action else {
        return 0.0;
    };
    if !model.costs {
        return 1.0;
    }
    let values: Values = arguments.iter().map(|each| Some(*each)).collect();
    let each = |cost: &Cost| match cost {
        Cost::Number(number) => *number,
        Cost::Function(atom) => {
            let objects = (atom.terms.iter()).filter_map(|term| value(term, &values));
            let key: Vec<Id> = std::iter::once(atom.name).chain(objects).collect();
            model.values.get(&key).copied().unwrap_or(0.0)
        }
    };
    action.costs.iter().map(each).sum()
}
