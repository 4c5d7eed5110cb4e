//! The state of the search: what holds, with a way back.

use std::rc::Rc;

use rustc_hash::FxHashMap;

use super::table::{FactPlace, Table};
use crate::compile::{Compiled, KindId, ObjectId, PredicateId};

/// What holds now. Changes are remembered and can be taken back in reverse order; everything is
/// then as it was, the order in which matching facts are listed included.
#[derive(Debug)]
pub struct Facts {
    tables: Vec<Table>,
    hash: u64,
    trail: Vec<u32>,
}

impl Facts {
    /// Tables without any facts as yet, so that indexes can be asked for.
    pub fn new(compiled: &Compiled) -> Self {
        let mut known: FxHashMap<KindId, Rc<Vec<u32>>> = FxHashMap::default();
        let mut local = |kind: KindId| {
            let local = known.entry(kind).or_insert_with(|| {
                let mut local = vec![u32::MAX; compiled.objects.len()];
                for (place, object) in compiled.kind(kind).members.iter().enumerate() {
                    local[object.index()] = place as u32;
                }
                Rc::new(local)
            });
            Rc::clone(local)
        };
        Self {
            tables: (0..compiled.predicates.len())
                .map(|id| Table::new(compiled, PredicateId::new(id), &mut local))
                .collect(),
            hash: 0,
            trail: Vec::new(),
        }
    }

    /// Puts in what holds at first. Indexes must all have been asked for.
    pub fn fill(&mut self, compiled: &Compiled) {
        for index in 0..self.tables.len() {
            let predicate = PredicateId::new(index);
            for args in compiled.init_of(predicate) {
                if let Some(place) = self.tables[index].place_of(args) {
                    self.add(predicate, place);
                }
            }
        }
        self.trail.clear();
    }

    pub fn table(&self, predicate: PredicateId) -> &Table {
        &self.tables[predicate.index()]
    }

    pub fn table_mut(&mut self, predicate: PredicateId) -> &mut Table {
        &mut self.tables[predicate.index()]
    }

    /// Of what holds; the same for the same facts.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// Whether the fact holds.
    pub fn holds(
        &self,
        predicate: PredicateId,
        args: impl Iterator<Item = ObjectId> + Clone,
    ) -> bool {
        let table = self.table(predicate);
        table.find(args).is_some_and(|place| table.holds(place))
    }

    /// How far the way back is, to come back to here.
    pub fn mark(&self) -> usize {
        self.trail.len()
    }

    pub fn add(&mut self, predicate: PredicateId, place: FactPlace) {
        let table = &mut self.tables[predicate.index()];
        if !table.holds(place) {
            table.insert(place);
            self.hash ^= table.hash(place);
            self.trail.extend([place, predicate.0 << 1 | 1]);
        }
    }

    pub fn remove(&mut self, predicate: PredicateId, place: FactPlace) {
        let table = &mut self.tables[predicate.index()];
        if table.holds(place) {
            table.remove(place, &mut self.trail);
            self.hash ^= table.hash(place);
            self.trail.extend([place, predicate.0 << 1]);
        }
    }

    /// Takes back everything since the mark.
    pub fn undo_to(&mut self, mark: usize) {
        while self.trail.len() > mark {
            let (Some(tag), Some(place)) = (self.trail.pop(), self.trail.pop()) else {
                return;
            };
            let table = &mut self.tables[(tag >> 1) as usize];
            self.hash ^= table.hash(place);
            if tag & 1 == 1 {
                table.undo_insert(place);
            } else {
                table.undo_remove(place, &mut self.trail);
            }
        }
    }

    /// Memory taken by what grows.
    pub fn bytes(&self) -> usize {
        self.trail.capacity() * size_of::<u32>()
    }
}
