//! Relations by number: predicates, then kinds of objects, then tasks, then actions, then tasks
//! that only the grounding knows.

use crate::compile::{ActionId, Compiled, KindId, PredicateId, Step, TaskId};

/// No object, relation or row has this number.
pub(crate) const UNKNOWN: u32 = u32::MAX;

/// Where each sort of relation begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Space {
    predicates: usize,
    kinds: usize,
    tasks: usize,
    actions: usize,
}

impl Space {
    pub fn new(compiled: &Compiled) -> Self {
        Self {
            predicates: compiled.predicates.len(),
            kinds: compiled.kinds.len(),
            tasks: compiled.tasks.len(),
            actions: compiled.actions.len(),
        }
    }

    pub fn predicate(self, id: PredicateId) -> u32 {
        id.0
    }

    pub fn kind(self, id: KindId) -> u32 {
        (self.predicates + id.index()) as u32
    }

    pub fn task(self, id: TaskId) -> u32 {
        (self.first_task() + id.index()) as u32
    }

    pub fn action(self, id: ActionId) -> u32 {
        (self.first_task() + self.tasks + id.index()) as u32
    }

    pub fn step(self, step: Step) -> u32 {
        match step {
            Step::Action(id) => self.action(id),
            Step::Task(id) => self.task(id),
        }
    }

    /// The kind that the relation is, if it is one.
    pub fn as_kind(self, relation: u32) -> Option<KindId> {
        let place = (relation as usize).checked_sub(self.predicates)?;
        (place < self.kinds).then(|| KindId::new(place))
    }

    pub fn predicates(self) -> usize {
        self.predicates
    }

    /// The first relation that is neither a predicate nor a kind.
    pub fn first_task(self) -> usize {
        self.predicates + self.kinds
    }

    /// The first relation that only the grounding knows.
    pub fn first_auxiliary(self) -> usize {
        self.first_task() + self.tasks + self.actions
    }
}
