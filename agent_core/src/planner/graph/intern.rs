//! Small numbers in the place of names and sequences, so that equal things are compared at once.

use std::hash::BuildHasher;

use hashbrown::HashTable;
use rustc_hash::FxBuildHasher;
use smallvec::SmallVec;

use crate::model::Symbol;

/// A hash table whose order is the same in every run.
pub(super) type Map<K, V> = hashbrown::HashMap<K, V, FxBuildHasher>;

/// A few numbers: what is bound, an atom's words. Hardly ever so many that they need a place of their
/// own in memory, which takes longer than all that is done with them.
pub(super) type Words = SmallVec<[u32; 8]>;

/// No number: an unbound variable, a fact of nobody, an empty place.
pub(super) const NONE: u32 = u32::MAX;

/// Numbers for sequences of numbers: atoms, deltas, sets. The first is number 0.
#[derive(Clone, Debug, Default)]
pub(super) struct Slices {
    table: HashTable<u32>,
    /// Where the sequence of each number ends in `words`; it begins where the one before ends.
    ends: Vec<u32>,
    words: Vec<u32>,
}

impl Slices {
    /// The sequence with a number.
    pub fn get(&self, id: u32) -> &[u32] {
        slice(&self.ends, &self.words, id)
    }

    /// The number of a sequence, if it has one.
    pub fn find(&self, words: &[u32]) -> Option<u32> {
        let hash = FxBuildHasher.hash_one(words);
        let same = |id: &u32| slice(&self.ends, &self.words, *id) == words;
        self.table.find(hash, same).copied()
    }

    /// The number of a sequence.
    pub fn intern(&mut self, words: &[u32]) -> u32 {
        let hash = FxBuildHasher.hash_one(words);
        let same = |id: &u32| slice(&self.ends, &self.words, *id) == words;
        if let Some(id) = self.table.find(hash, same) {
            return *id;
        }
        let id = self.ends.len() as u32;
        self.words.extend_from_slice(words);
        self.ends.push(self.words.len() as u32);
        let (ends, all) = (&self.ends, &self.words);
        let rehash = |id: &u32| FxBuildHasher.hash_one(slice(ends, all, *id));
        self.table.insert_unique(hash, id, rehash);
        id
    }
}

fn slice<'a>(ends: &[u32], words: &'a [u32], id: u32) -> &'a [u32] {
    let from = match id {
        0 => 0,
        _ => ends[id as usize - 1],
    };
    &words[from as usize..ends[id as usize] as usize]
}

/// Numbers for names: of objects, predicates, tasks, types alike.
#[derive(Clone, Debug, Default)]
pub(super) struct Names {
    numbers: Map<Symbol, u32>,
    names: Vec<Symbol>,
}

impl Names {
    /// The number of a name.
    pub fn number(&mut self, name: &Symbol) -> u32 {
        if let Some(number) = self.numbers.get(name) {
            return *number;
        }
        let number = self.names.len() as u32;
        self.numbers.insert(name.clone(), number);
        self.names.push(name.clone());
        number
    }

    /// The number of a name, if it has one.
    pub fn find(&self, name: &Symbol) -> Option<u32> {
        self.numbers.get(name).copied()
    }

    /// The name with a number.
    pub fn name(&self, number: u32) -> &Symbol {
        &self.names[number as usize]
    }
}
