//! What a planner plans from.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::model::{Action, Belief, Domain, ExecutionModel, Map, Symbol};

/// Everything that a plan depends on, as it is at one moment.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The domain.
    pub domain: Arc<Domain>,
    /// Its execution model.
    pub model: Arc<ExecutionModel>,
    /// The map that the goal is pursued on.
    pub map: Arc<Map>,
    /// What holds now.
    pub belief: Arc<Belief>,
    /// Actions that have failed too often to be tried again for this goal.
    pub forbidden: BTreeSet<Action>,
}

impl Problem {
    /// The type of an object.
    pub fn kind(&self, object: &Symbol) -> Option<&Symbol> {
        self.map
            .objects
            .get(object)
            .or_else(|| self.domain.constants.get(object))
    }

    /// Whether an object may stand where `kind` is wanted. An object that no map shows may: a
    /// superior can name things of which its executor knows nothing else.
    pub fn fits(&self, object: &Symbol, kind: &Symbol) -> bool {
        self.kind(object)
            .is_none_or(|given| self.domain.is_a(given, kind))
    }

    /// All objects of a type, in order.
    pub fn objects_of(&self, kind: &Symbol) -> Vec<Symbol> {
        let all = self.map.objects.iter().chain(&self.domain.constants);
        let mut objects: Vec<Symbol> = all
            .filter(|(_, given)| self.domain.is_a(given, kind))
            .map(|(object, _)| object.clone())
            .collect();
        objects.sort();
        objects.dedup();
        objects
    }
}
