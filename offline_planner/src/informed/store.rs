//! States and stacks of tasks, each kept once.

use std::hash::{BuildHasher, BuildHasherDefault};

use hashbrown::HashTable;
use rustc_hash::FxHasher;

use crate::ground::model::NONE;

fn hash<T: std::hash::Hash>(value: T) -> u64 {
    BuildHasherDefault::<FxHasher>::default().hash_one(value)
}

/// States, as rows of bits.
pub(super) struct States {
    words: usize,
    bits: Vec<u64>,
    count: usize,
    known: HashTable<u32>,
}

impl States {
    /// Of so many words each.
    pub fn new(words: usize) -> Self {
        Self {
            words,
            bits: Vec::new(),
            count: 0,
            known: HashTable::new(),
        }
    }

    /// The state's number.
    pub fn insert(&mut self, state: &[u64]) -> u32 {
        let words = self.words;
        let bits = &self.bits;
        let row = |number: u32| &bits[number as usize * words..(number as usize + 1) * words];
        let key = hash(state);
        if let Some(number) = self.known.find(key, |number| row(*number) == state) {
            return *number;
        }
        let number = self.count as u32;
        self.count += 1;
        self.bits.extend_from_slice(state);
        let bits = &self.bits;
        self.known.insert_unique(key, number, |number| {
            hash(&bits[*number as usize * words..(*number as usize + 1) * words])
        });
        number
    }

    /// The state of that number.
    pub fn get(&self, number: u32) -> &[u64] {
        &self.bits[number as usize * self.words..(number as usize + 1) * self.words]
    }

    /// About how much memory this takes.
    pub fn bytes(&self) -> usize {
        self.bits.len() * 8 + self.count * 8
    }
}

/// Stacks of tasks: each is a task on top of another stack.
pub(super) struct Stacks {
    cells: Vec<(u32, u32)>,
    known: HashTable<u32>,
}

/// The stack without tasks.
pub(super) const EMPTY: u32 = NONE;

impl Stacks {
    /// None yet.
    pub fn new() -> Self {
        Self {
            cells: Vec::new(),
            known: HashTable::new(),
        }
    }

    /// `task` on top of `below`.
    pub fn push(&mut self, task: u32, below: u32) -> u32 {
        let cells = &self.cells;
        let key = hash((task, below));
        let found = self
            .known
            .find(key, |number| cells[*number as usize] == (task, below));
        if let Some(number) = found {
            return *number;
        }
        let number = self.cells.len() as u32;
        self.cells.push((task, below));
        let cells = &self.cells;
        self.known
            .insert_unique(key, number, |number| hash(cells[*number as usize]));
        number
    }

    /// The first task and what is below it; nothing if there is none.
    pub fn pop(&self, stack: u32) -> Option<(u32, u32)> {
        self.cells.get(stack as usize).copied()
    }

    /// The tasks of a stack, the first first.
    pub fn tasks(&self, mut stack: u32) -> impl Iterator<Item = u32> {
        std::iter::from_fn(move || {
            let (task, below) = self.pop(stack)?;
            stack = below;
            Some(task)
        })
    }

    /// About how much memory this takes.
    pub fn bytes(&self) -> usize {
        self.cells.len() * 16
    }
}
