//! The facts of one predicate, with indexes.

use rustc_hash::FxHashMap;

use super::hash::{join, spread};
use crate::compile::{Compiled, ObjectId, PredicateId};

/// Up to so many possible facts (or keys) are looked up in a plain array.
const DENSE: u64 = 1 << 22;
const NONE: u32 = u32::MAX;

/// A fact that has been met, by its place in its table.
pub type FactPlace = u32;

/// From tuples of objects to numbers.
#[derive(Debug)]
enum Lookup {
    Dense(Vec<u32>),
    Sparse(FxHashMap<Box<[ObjectId]>, u32>),
}

/// Some argument places of a predicate, and how to find numbers by what stands there.
#[derive(Debug)]
struct Keyed {
    lookup: Lookup,
    /// For each object its place in the kind, for each argument place.
    locals: Vec<std::rc::Rc<Vec<u32>>>,
    radices: Vec<u32>,
}

impl Keyed {
    fn new(locals: Vec<std::rc::Rc<Vec<u32>>>, radices: Vec<u32>) -> Self {
        let product = radices.iter().try_fold(1_u64, |product, radix| {
            product.checked_mul(u64::from(*radix))
        });
        let lookup = match product {
            Some(product) if product <= DENSE => Lookup::Dense(vec![0; product as usize]),
            _ => Lookup::Sparse(FxHashMap::default()),
        };
        Self {
            lookup,
            locals,
            radices,
        }
    }

    /// Where in the array; `None` if an object is none that could stand there.
    fn position(&self, objects: impl Iterator<Item = ObjectId>) -> Option<usize> {
        let mut position = 0;
        for ((object, locals), radix) in objects.zip(&self.locals).zip(&self.radices) {
            let local = locals.get(object.index()).copied().unwrap_or(NONE);
            if local == NONE {
                return None;
            }
            position = position * *radix as usize + local as usize;
        }
        Some(position)
    }

    fn get(&self, objects: impl Iterator<Item = ObjectId> + Clone) -> Option<u32> {
        match &self.lookup {
            // Zero marks what is not there.
            Lookup::Dense(numbers) => numbers[self.position(objects)?].checked_sub(1),
            Lookup::Sparse(numbers) => {
                // Only for predicates with very many possible facts.
                let key: Vec<ObjectId> = objects.collect();
                numbers.get(&key[..]).copied()
            }
        }
    }

    /// The number known for these objects, or `new` from now on. `None` if they cannot stand there.
    fn get_or_insert(
        &mut self,
        objects: impl Iterator<Item = ObjectId> + Clone,
        new: u32,
    ) -> Option<u32> {
        let position = self.position(objects.clone())?;
        Some(match &mut self.lookup {
            Lookup::Dense(numbers) => {
                if numbers[position] == 0 {
                    numbers[position] = new + 1;
                }
                numbers[position] - 1
            }
            Lookup::Sparse(numbers) => *numbers.entry(objects.collect()).or_insert(new),
        })
    }
}

/// Facts by what stands at some places.
#[derive(Debug)]
struct Index {
    places: Vec<usize>,
    keyed: Keyed,
    buckets: Vec<Vec<FactPlace>>,
}

/// Where a fact stands in an index.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    bucket: u32,
    position: u32,
}

/// The facts of one predicate.
#[derive(Debug)]
pub struct Table {
    arity: usize,
    seed: u64,
    all: Keyed,
    indexes: Vec<Index>,
    args: Vec<ObjectId>,
    holds: Vec<bool>,
    hashes: Vec<u64>,
    /// As many as there are indexes for each fact.
    slots: Vec<Slot>,
    locals: Vec<std::rc::Rc<Vec<u32>>>,
    radices: Vec<u32>,
}

impl Table {
    pub fn new(
        compiled: &Compiled,
        id: PredicateId,
        local: &mut impl FnMut(crate::compile::KindId) -> std::rc::Rc<Vec<u32>>,
    ) -> Self {
        let kinds = &compiled.predicate(id).kinds;
        let locals: Vec<_> = kinds.iter().map(|kind| local(*kind)).collect();
        let radices: Vec<u32> = kinds
            .iter()
            .map(|kind| u32::try_from(compiled.kind(*kind).members.len()).unwrap_or(NONE))
            .collect();
        Self {
            arity: kinds.len(),
            seed: spread(id.index() as u64 + 1),
            all: Keyed::new(locals.clone(), radices.clone()),
            indexes: Vec::new(),
            args: Vec::new(),
            holds: Vec::new(),
            hashes: Vec::new(),
            slots: Vec::new(),
            locals,
            radices,
        }
    }

    /// The index by these argument places; made if there is none. Only before the first fact.
    pub fn index_by(&mut self, places: &[usize]) -> usize {
        debug_assert!(self.holds.is_empty());
        let known = self.indexes.iter().position(|index| index.places == places);
        known.unwrap_or_else(|| {
            let locals = places.iter().map(|place| self.locals[*place].clone());
            let radices = places.iter().map(|place| self.radices[*place]);
            self.indexes.push(Index {
                places: places.to_vec(),
                keyed: Keyed::new(locals.collect(), radices.collect()),
                buckets: Vec::new(),
            });
            self.indexes.len() - 1
        })
    }

    /// The place of a fact, if it has ever been met.
    pub fn find(&self, args: impl Iterator<Item = ObjectId> + Clone) -> Option<FactPlace> {
        self.all.get(args)
    }

    /// The place of a fact; `None` if it can never hold, as its objects are not of the kinds.
    pub fn place_of(&mut self, args: &[ObjectId]) -> Option<FactPlace> {
        let next = self.holds.len() as u32;
        let place = self.all.get_or_insert(args.iter().copied(), next)?;
        if place == next {
            self.args.extend_from_slice(args);
            self.holds.push(false);
            let numbers = args.iter().map(|object| u64::from(object.0) + 1);
            self.hashes.push(numbers.fold(self.seed, join));
            for index in &mut self.indexes {
                let new = index.buckets.len() as u32;
                let key = index.places.iter().map(|place| args[*place]);
                let bucket = index.keyed.get_or_insert(key, new).unwrap_or(new);
                if bucket == new {
                    index.buckets.push(Vec::new());
                }
                self.slots.push(Slot {
                    bucket,
                    position: 0,
                });
            }
        }
        Some(place)
    }

    pub fn holds(&self, place: FactPlace) -> bool {
        self.holds[place as usize]
    }

    pub fn hash(&self, place: FactPlace) -> u64 {
        self.hashes[place as usize]
    }

    pub fn args(&self, place: FactPlace) -> &[ObjectId] {
        let first = place as usize * self.arity;
        &self.args[first..first + self.arity]
    }

    /// The facts that hold and have these objects at the index's places.
    pub fn matching(
        &self,
        index: usize,
        key: impl Iterator<Item = ObjectId> + Clone,
    ) -> &[FactPlace] {
        let index = &self.indexes[index];
        match index.keyed.get(key) {
            Some(bucket) => &index.buckets[bucket as usize],
            None => &[],
        }
    }

    /// It did not hold and does now.
    pub fn insert(&mut self, place: FactPlace) {
        self.holds[place as usize] = true;
        let first = place as usize * self.indexes.len();
        for (index, slot) in self.indexes.iter_mut().zip(&mut self.slots[first..]) {
            let bucket = &mut index.buckets[slot.bucket as usize];
            slot.position = bucket.len() as u32;
            bucket.push(place);
        }
    }

    /// It held and does no more. Where it stood in each index is put on `trail`.
    pub fn remove(&mut self, place: FactPlace, trail: &mut Vec<u32>) {
        self.holds[place as usize] = false;
        let count = self.indexes.len();
        for number in 0..count {
            let slot = self.slots[place as usize * count + number];
            let bucket = &mut self.indexes[number].buckets[slot.bucket as usize];
            bucket.swap_remove(slot.position as usize);
            if let Some(moved) = bucket.get(slot.position as usize) {
                self.slots[*moved as usize * count + number].position = slot.position;
            }
            trail.push(slot.position);
        }
    }

    /// Takes back an insertion; everything since then has been taken back already.
    pub fn undo_insert(&mut self, place: FactPlace) {
        self.holds[place as usize] = false;
        let first = place as usize * self.indexes.len();
        for (index, slot) in self.indexes.iter_mut().zip(&self.slots[first..]) {
            let last = index.buckets[slot.bucket as usize].pop();
            debug_assert_eq!(last, Some(place));
        }
    }

    /// Takes back a removal, so that every bucket is in the order in which it was.
    pub fn undo_remove(&mut self, place: FactPlace, trail: &mut Vec<u32>) {
        self.holds[place as usize] = true;
        let count = self.indexes.len();
        for number in (0..count).rev() {
            let position = trail.pop().unwrap_or(0);
            let slot = &mut self.slots[place as usize * count + number];
            slot.position = position;
            let bucket = &mut self.indexes[number].buckets[slot.bucket as usize];
            let end = bucket.len() as u32;
            bucket.push(place);
            if position < end {
                bucket.swap(position as usize, end as usize);
                let moved = bucket[end as usize];
                self.slots[moved as usize * count + number].position = end;
            }
        }
    }
}
