//! The present belief, as cliques are judged by it.

use std::collections::BTreeMap;

use super::clique::World;
use super::footprint::Footprint;
use crate::model::{Fact, Time};
use crate::planner::{Item, Problem, Step, TaskList, ways_to, with_changes};

/// What is believed now, and what actions there are.
#[derive(Clone, Debug)]
pub struct Present<'a>(pub &'a Problem);

impl World for Present<'_> {
    fn holds(&self, fact: &Fact) -> bool {
        self.0.belief.holds(fact) || self.0.map.facts.holds(fact)
    }

    fn mending(&self, changes: &BTreeMap<Fact, bool>, fact: &Fact, wanted: bool) -> Option<Time> {
        let then = with_changes(self.0, changes.iter().map(|(fact, holds)| (fact, *holds)));
        let ways = ways_to(&then, fact, wanted).into_iter().map(|action| {
            let step = Step {
                item: Item::Task(action),
                cost: crate::model::Cost::ZERO,
                frame: None,
                rest: TaskList::empty(),
            };
            Footprint::of(&then, &step).duration
        });
        ways.min()
    }
}
