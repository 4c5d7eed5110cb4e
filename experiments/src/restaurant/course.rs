//! What became of an evening in the restaurant: who did what when, and who waited for how long.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Action, FactChange, Symbol, Time};
use agent_core::protocol::{ActionId, Event, Happening};

/// An action that a vehicle has done.
#[derive(Clone, Debug, PartialEq)]
pub struct Deed {
    /// Who.
    pub vehicle: Symbol,
    /// What.
    pub action: Action,
    /// From when on.
    pub begun: Time,
    /// Until when; broken-off actions end when they are resumed and done.
    pub ended: Time,
}

/// What became of an evening.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// In the order in which they ended.
    pub deeds: Vec<Deed>,
    /// When each guest was served.
    pub served: BTreeMap<Symbol, Time>,
    /// How many layers were chosen with more than one action.
    pub combined: u64,
    /// What has failed, in words.
    pub failures: Vec<String>,
    running: BTreeMap<(Symbol, ActionId), (Action, Time)>,
}

impl Course {
    /// Takes note of what a vehicle has told.
    pub fn note(&mut self, vehicle: &Symbol, event: &Event) {
        let key = |id: &ActionId| (vehicle.clone(), id.clone());
        match &event.what {
            Happening::ActionStarted { id, action } => {
                let begun = (action.clone(), event.at);
                self.running.insert(key(id), begun);
            }
            Happening::ActionFinished {
                id,
                action,
                failure: None,
            } => {
                let begun = self.running.remove(&key(id));
                let (action, begun) = begun.unwrap_or_else(|| (action.clone(), event.at));
                self.deeds.push(Deed {
                    vehicle: vehicle.clone(),
                    action,
                    begun,
                    ended: event.at,
                });
            }
            Happening::ActionFinished {
                action,
                failure: Some(why),
                ..
            } => self.failures.push(format!("{vehicle}: {action}: {why}")),
            Happening::GoalFailed { reason } => {
                let goal = event.goal.as_ref().map_or("", Symbol::as_str);
                self.failures.push(format!("{vehicle}: {goal}: {reason}"));
            }
            Happening::ActionsCombined { actions, .. } if actions.len() > 1 => self.combined += 1,
            Happening::BeliefChanged { changes } => {
                for change in changes {
                    if let FactChange::Add(fact) = change
                        && fact.name == "served"
                        && let Some(guest) = fact.args.first()
                    {
                        self.served.entry(guest.clone()).or_insert(event.at);
                    }
                }
            }
            _ => {}
        }
    }

    /// What a vehicle has done, in the order in which it began.
    pub fn deeds_of(&self, vehicle: &str) -> Vec<&Deed> {
        let mut deeds: Vec<&Deed> = (self.deeds.iter())
            .filter(|deed| deed.vehicle == vehicle)
            .collect();
        deeds.sort_by_key(|deed| (deed.begun, deed.ended));
        deeds
    }

    /// A bottle that two guests were given, one after the other.
    pub fn handed_over_twice(&self) -> Option<&Symbol> {
        let mut seen = BTreeSet::new();
        let given = self
            .deeds
            .iter()
            .filter(|deed| deed.action.name == "put-drink");
        let mut bottles = given.filter_map(|deed| deed.action.args.first());
        bottles.find(|bottle| !seen.insert(*bottle))
    }

    /// When the last guest was served.
    pub fn end(&self) -> Time {
        self.served.values().copied().max().unwrap_or(Time::ZERO)
    }
}
