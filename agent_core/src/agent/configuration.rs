//! What an agent is made with.

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::Arc;

use super::Repair;
use crate::model::{Domain, ExecutionModel, FactChange, Map, Symbol, Time};

/// What an agent is made with. Two agents that differ in nothing else are at different levels.
#[derive(Clone, Debug)]
pub struct Configuration {
    /// Its name, by which superiors and users know it.
    pub name: Symbol,
    /// New, and greater, at every start.
    pub epoch: u64,
    /// The domain of its level.
    pub domain: Arc<Domain>,
    /// The execution model of its level.
    pub model: Arc<ExecutionModel>,
    /// What it knows of its surroundings itself. A child agent has an empty one and is given a
    /// map with each instruction.
    pub map: Map,
    /// The maps that it hands down.
    pub maps_below: Arc<dyn MapsBelow>,
    /// What it holds to be true at the start.
    pub facts: Vec<FactChange>,
    /// Who executes its actions.
    pub executors: Executors,
    /// How it behaves.
    pub policy: Policy,
}

/// The maps that an agent hands down with its instructions: made when they are asked for, as there
/// can be twenty thousand of them.
pub trait MapsBelow: Debug + Send + Sync {
    /// The map that shows a place; `None` if there is none.
    fn map_of(&self, place: &Symbol) -> Option<Map>;
}

/// For an agent that hands down no maps.
impl MapsBelow for () {
    fn map_of(&self, _: &Symbol) -> Option<Map> {
        None
    }
}

/// Who executes which actions.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Executors {
    /// Whoever has no place of its own.
    pub default: Symbol,
    /// The executor of a place, for actions whose model names one (`map_of`).
    pub of_place: BTreeMap<Symbol, Symbol>,
}

impl Executors {
    /// One for everything.
    pub fn one(name: &str) -> Self {
        Self {
            default: Symbol::from(name),
            of_place: BTreeMap::new(),
        }
    }

    /// Everyone, without repetition.
    pub fn all(&self) -> Vec<Symbol> {
        let mut all: Vec<Symbol> = self.of_place.values().cloned().collect();
        all.push(self.default.clone());
        all.sort();
        all.dedup();
        all
    }
}

/// Settings of behaviour.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Policy {
    /// Decision 8: an action that the emergency's best plan begins with goes on. Off where the
    /// paper's tables are reproduced.
    pub keep_what_helps: bool,
    /// How many expansions may be spent to find that out before the action is stopped.
    pub expansions_before_stopping: u64,
    /// How many expansions are made between two looks at what has come in (decision 9).
    pub expansions_per_slice: u64,
    /// Which plan is followed after a failure.
    pub repair: Repair,
    /// How often an action may fail before it is no longer tried for a goal.
    pub attempts: u32,
    /// Whether it waits for leave before each action, and before it gives a goal up for want of a plan:
    /// several agents of one robot do ([`ParallelAgent`](crate::parallel::ParallelAgent)).
    pub asks_leave: bool,
    /// How many goals of users may wait (for their turn, suspended or set aside), emergencies and
    /// others counted apart: who fills one list leaves room in the other. What is kept for goals,
    /// in memory and on disk, is bounded by this.
    pub most_waiting: usize,
    /// How many goals that are over are remembered, so that late questions are still answered and
    /// none is done twice.
    pub ended_kept: usize,
    /// How long, on the world's clock.
    pub ended_kept_for: Time,
}

impl Default for Policy {
    fn default() -> Self {
        Self {
            keep_what_helps: true,
            // The museum's rough plans were seen to take from 19 to 155, alternatives included.
            expansions_before_stopping: 200,
            expansions_per_slice: 200,
            repair: Repair::Cheapest,
            attempts: 3,
            asks_leave: false,
            most_waiting: MOST_WAITING,
            ended_kept: 1000,
            ended_kept_for: ONE_HOUR,
        }
    }
}

/// More goals than anybody keeps in mind, and few enough to look through at every change.
const MOST_WAITING: usize = 64;

const ONE_HOUR: Time = Time(3_600_000_000);
