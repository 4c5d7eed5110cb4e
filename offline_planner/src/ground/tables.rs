//! Relations: tuples of objects, found by any of their columns.

use std::hash::{BuildHasher, BuildHasherDefault};

use hashbrown::HashTable;
use rustc_hash::{FxHashMap, FxHasher};

/// Which columns of a relation are given. Columns beyond the first 32 are never looked up by.
pub(super) type Mask = u32;

/// Columns that a mask can name.
pub(super) const MASKED: usize = 32;

fn hash(key: &[u32]) -> u64 {
    BuildHasherDefault::<FxHasher>::default().hash_one(key)
}

/// The tuples of one predicate, type or task.
pub(super) struct Relation {
    arity: usize,
    rows: Vec<u32>,
    count: usize,
    known: HashTable<u32>,
    /// Rows from here on are known but not yet part of joins.
    pub joined: usize,
    indexes: Vec<Index>,
}

struct Index {
    mask: Mask,
    slots: FxHashMap<Box<[u32]>, Vec<u32>>,
}

/// Rows that match a key.
#[derive(Clone, Copy)]
pub(super) struct Matches<'t> {
    rows: Option<&'t [u32]>,
    /// All rows below this, if there is no list.
    all: usize,
}

impl Matches<'_> {
    pub fn len(&self) -> usize {
        self.rows.map_or(self.all, <[u32]>::len)
    }

    pub fn get(&self, place: usize) -> usize {
        self.rows.map_or(place, |rows| rows[place] as usize)
    }
}

impl Relation {
    pub fn new(arity: usize) -> Self {
        Self {
            arity,
            rows: Vec::new(),
            count: 0,
            known: HashTable::new(),
            joined: 0,
            indexes: Vec::new(),
        }
    }

    /// How many rows are known.
    pub fn len(&self) -> usize {
        self.count
    }

    pub fn row(&self, row: usize) -> &[u32] {
        &self.rows[row * self.arity..(row + 1) * self.arity]
    }

    /// The row that holds `key`, and whether it is new.
    pub fn insert(&mut self, key: &[u32]) -> (usize, bool) {
        let arity = self.arity;
        let rows = &self.rows;
        let found = self.known.find(hash(key), |row| {
            let row = *row as usize;
            &rows[row * arity..(row + 1) * arity] == key
        });
        if let Some(row) = found {
            return (*row as usize, false);
        }
        let row = self.count;
        self.rows.extend_from_slice(key);
        self.count += 1;
        let rows = &self.rows;
        self.known.insert_unique(hash(key), row as u32, |row| {
            let row = *row as usize;
            hash(&rows[row * arity..(row + 1) * arity])
        });
        (row, true)
    }

    /// The row that holds `key`.
    pub fn find(&self, key: &[u32]) -> Option<usize> {
        self.known
            .find(hash(key), |row| self.row(*row as usize) == key)
            .map(|row| *row as usize)
    }

    /// Lets the next known row take part in joins.
    pub fn join_next(&mut self) {
        let row = self.joined;
        self.joined += 1;
        let Self {
            arity,
            rows,
            indexes,
            ..
        } = self;
        let values = &rows[row * *arity..(row + 1) * *arity];
        for index in indexes {
            index.add(row, values);
        }
    }

    /// Makes sure that rows can be found by the columns in `mask`.
    pub fn prepare(&mut self, mask: Mask) {
        if mask == 0 || self.indexes.iter().any(|index| index.mask == mask) {
            return;
        }
        let mut index = Index {
            mask,
            slots: FxHashMap::default(),
        };
        for row in 0..self.joined {
            index.add(row, self.row(row));
        }
        self.indexes.push(index);
    }

    /// Joined rows with `key` in the columns of `mask`, which must have been prepared.
    pub fn matches(&self, mask: Mask, key: &[u32]) -> Matches<'_> {
        if mask == 0 {
            return Matches {
                rows: None,
                all: self.joined,
            };
        }
        let rows = self
            .indexes
            .iter()
            .find(|index| index.mask == mask)
            .and_then(|index| index.slots.get(key))
            .map_or(&[][..], Vec::as_slice);
        Matches {
            rows: Some(rows),
            all: 0,
        }
    }

    /// About how much memory this takes.
    pub fn bytes(&self) -> usize {
        self.rows.len() * 4 + self.count * (6 + self.indexes.len() * 16)
    }
}

impl Index {
    fn add(&mut self, row: usize, values: &[u32]) {
        let key: Box<[u32]> = values
            .iter()
            .enumerate()
            .take(MASKED)
            .filter(|(column, _)| self.mask & (1 << column) != 0)
            .map(|(_, value)| *value)
            .collect();
        self.slots.entry(key).or_default().push(row as u32);
    }
}
