//! What goes down: to whom, with which map, and what is cleared.

use std::sync::Arc;

use super::excerpts::Excerpt;
use super::{Agent, Intention};
use crate::model::{Atom, Fact, FactChange, Map, Symbol};
use crate::planner::{self, Planner, Problem, Step};
use crate::protocol::{ActionId, Happening, Instruction, Output};

impl<P: Planner> Agent<P> {
    pub(super) fn instruct(&mut self, to: &Symbol, instruction: Instruction) {
        self.outputs.push_back(Output::Instruct {
            to: to.clone(),
            instruction,
        });
    }

    /// Everything that a plan for the running goal depends on, now.
    pub(super) fn problem(&self) -> Problem {
        let running = self.running.as_ref().map(|running| &running.intention);
        self.problem_of(running)
    }

    /// Everything that a plan for a goal depends on, now.
    pub(super) fn problem_of(&self, intention: Option<&Intention>) -> Problem {
        let attempts = self.configuration.policy.attempts;
        let failures = intention
            .into_iter()
            .flat_map(|intention| &intention.failures);
        Problem {
            domain: self.configuration.domain.clone(),
            model: self.configuration.model.clone(),
            map: intention
                .map_or(&self.map, |intention| &intention.goal.map)
                .clone(),
            belief: Arc::new(self.belief.clone()),
            forbidden: failures
                .filter(|(_, times)| **times >= attempts)
                .map(|(action, _)| action.clone())
                .collect(),
        }
    }

    /// The place that an action is about, if its model names one.
    fn place_of<'a>(&self, step: &'a Step) -> Option<&'a Symbol> {
        let action = step.purpose();
        let model = self.configuration.model.actions.get(&action.name)?;
        action.args.get(model.map_of?)
    }

    /// Who executes a step. Actions without a place go to whoever acted last.
    pub(super) fn executor_for(&self, step: &Step) -> Symbol {
        let executors = &self.configuration.executors;
        match self.place_of(step) {
            Some(place) => executors.of_place.get(place).unwrap_or(&executors.default),
            None => &self.last_executor,
        }
        .clone()
    }

    /// The map that goes with a step, with what is believed now of things in it that change.
    pub(super) fn map_for(&mut self, step: &Step) -> Option<Map> {
        let place = self.place_of(step)?.clone();
        let mut excerpts = std::mem::take(&mut self.excerpts);
        let excerpt = excerpts.of(&place, || self.excerpt(&place));
        let map = excerpt.map(|excerpt| {
            let mut map = excerpt.map.clone();
            let changing = excerpt.changing.iter();
            map.news
                .extend(changing.map(|fact| match self.belief.holds(fact) {
                    true => FactChange::Add(fact.clone()),
                    false => FactChange::Remove(fact.clone()),
                }));
            map
        });
        self.excerpts = excerpts;
        map
    }

    /// What goes down with everything that is about a place.
    fn excerpt(&self, place: &Symbol) -> Option<Excerpt> {
        let mut map = self.configuration.maps_below.map_of(place)?;
        // What the map says of changing things was true once; what is believed goes instead.
        let observable = &self.configuration.model.observable;
        map.take_changing(observable);
        let changing = observable
            .iter()
            .flat_map(|predicate| self.possible_facts(predicate, &map));
        Some(Excerpt {
            changing: changing.collect(),
            map,
        })
    }

    /// All facts of one of our predicates about objects on a map.
    fn possible_facts(&self, predicate: &Symbol, map: &Map) -> Vec<Fact> {
        let Some(parameters) = self.configuration.domain.predicates.get(predicate) else {
            return Vec::new();
        };
        let mut argument_lists: Vec<Vec<Symbol>> = vec![Vec::new()];
        for parameter in parameters {
            let objects: Vec<&Symbol> = map
                .objects
                .iter()
                .filter(|(_, kind)| self.configuration.domain.is_a(kind, &parameter.kind))
                .map(|(object, _)| object)
                .collect();
            argument_lists = argument_lists
                .into_iter()
                .flat_map(|args| {
                    objects.iter().map(move |object| {
                        let mut args = args.clone();
                        args.push((*object).clone());
                        args
                    })
                })
                .collect();
        }
        argument_lists
            .into_iter()
            .map(|args| Atom {
                name: predicate.clone(),
                args,
            })
            .collect()
    }

    /// Tells the executor to drop a record of the running goal, and forgets it.
    pub(super) fn clear(&mut self, id: &ActionId) {
        let Some(running) = &mut self.running else {
            return;
        };
        let goal = running.intention.goal.id.clone();
        let records = &mut running.intention.records;
        if let Some(place) = records.iter().position(|record| record.id == *id) {
            let record = records.remove(place);
            self.emit(
                Some(&goal),
                Happening::RecordCleared {
                    id: id.clone(),
                    action: record.step.purpose().clone(),
                },
            );
            self.instruct(&record.executor, Instruction::Clear { id: id.clone() });
        }
    }

    /// Tells executors to drop all records of a goal that is over.
    pub(super) fn clear_all(&mut self, intention: &Intention) {
        for record in &intention.records {
            self.emit(
                Some(&intention.goal.id),
                Happening::RecordCleared {
                    id: record.id.clone(),
                    action: record.step.purpose().clone(),
                },
            );
            let id = record.id.clone();
            self.instruct(&record.executor, Instruction::Clear { id });
        }
    }

    /// What superiors should believe now, in their words (the projection), and the values that
    /// executors have named since they were last told. All that holds is said again, as one of
    /// them may have missed it.
    pub(super) fn tell_superiors(&mut self) -> Vec<FactChange> {
        let now = planner::project(&self.problem());
        let gone = self.told.facts().filter(|fact| !now.holds(fact)).cloned();
        let mut facts: Vec<FactChange> = gone.map(FactChange::Remove).collect();
        facts.extend(now.facts().cloned().map(FactChange::Add));
        facts.append(&mut self.new_values);
        self.told = now;
        facts
    }
}
