//! What remains to be done, in numbers: lists whose tails are shared.

use std::collections::BTreeMap;

use super::intern::{Map, NONE, Slices};
use crate::planner::Item;

/// The empty list.
pub(super) const NIL: u32 = 0;

/// One thing to be done.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// The task or action.
    pub atom: u32,
    /// What it brings the robot forward by.
    pub purpose: u32,
}

#[derive(Clone, Debug)]
struct Cell {
    entry: u32,
    rest: u32,
    length: u32,
    /// The set of what may be asked for on the way to the end of the list.
    reads: u32,
}

/// Lists, the things in them, and sets of kinds of variables.
#[derive(Clone, Debug)]
pub(super) struct Lists {
    entries: Vec<Entry>,
    tasks: Map<u32, u32>,
    others: BTreeMap<Item, u32>,
    cells: Vec<Cell>,
    table: Map<(u32, u32), u32>,
    sets: Slices,
    unions: Map<(u32, u32), u32>,
}

impl Lists {
    pub fn new() -> Self {
        let mut sets = Slices::default();
        let empty = sets.intern(&[]);
        let nil = Cell {
            entry: NONE,
            rest: NIL,
            length: 0,
            reads: empty,
        };
        Self {
            entries: Vec::new(),
            tasks: Map::default(),
            others: BTreeMap::new(),
            cells: vec![nil],
            table: Map::default(),
            sets,
            unions: Map::default(),
        }
    }

    /// The number of a task as a thing to be done.
    pub fn task(&mut self, atom: u32) -> u32 {
        let entries = &mut self.entries;
        *self.tasks.entry(atom).or_insert_with(|| {
            entries.push(Entry {
                atom,
                purpose: atom,
            });
            entries.len() as u32 - 1
        })
    }

    /// The number of what resumes or undoes an action.
    pub fn other(&mut self, item: &Item, atom: u32, purpose: u32) -> u32 {
        if let Some(number) = self.others.get(item) {
            return *number;
        }
        let number = self.entries.len() as u32;
        self.others.insert(item.clone(), number);
        self.entries.push(Entry { atom, purpose });
        number
    }

    pub fn entry(&self, number: u32) -> &Entry {
        &self.entries[number as usize]
    }

    /// `entry` first, then `rest`; `reads` is what doing the entry may ask for.
    pub fn prepend(&mut self, entry: u32, reads: u32, rest: u32) -> u32 {
        if let Some(list) = self.table.get(&(entry, rest)) {
            return *list;
        }
        let reads = self.union(reads, self.reads(rest));
        let list = self.cells.len() as u32;
        self.cells.push(Cell {
            entry,
            rest,
            length: self.len(rest) + 1,
            reads,
        });
        self.table.insert((entry, rest), list);
        list
    }

    /// The list of an item, whose atom has this number, and then `rest`, if it has a number.
    pub fn find(&self, item: &Item, atom: u32, rest: u32) -> Option<u32> {
        let entry = match item {
            Item::Task(_) => self.tasks.get(&atom),
            _ => self.others.get(item),
        };
        self.table.get(&(*entry?, rest)).copied()
    }

    /// The first entry and what follows; `None` if nothing is left to do.
    pub fn first(&self, list: u32) -> Option<(u32, u32)> {
        let cell = &self.cells[list as usize];
        (list != NIL).then_some((cell.entry, cell.rest))
    }

    pub fn len(&self, list: u32) -> u32 {
        self.cells[list as usize].length
    }

    /// The set of kinds of variables that may be asked for until the list is done.
    pub fn reads(&self, list: u32) -> u32 {
        self.cells[list as usize].reads
    }

    /// Keeps these lists and what follows on them alone. Returns their new numbers.
    pub fn compact(&mut self, used: impl Iterator<Item = u32>) -> Map<u32, u32> {
        let mut kept = vec![false; self.cells.len()];
        for mut list in used {
            while !std::mem::replace(&mut kept[list as usize], true) {
                list = self.cells[list as usize].rest;
            }
        }
        kept[NIL as usize] = true;
        let mut numbers = Map::default();
        let cells = std::mem::take(&mut self.cells);
        self.table.clear();
        let mut entries = vec![false; self.entries.len()];
        // What follows on a list has a smaller number.
        for (old, mut cell) in cells.into_iter().enumerate().filter(|(old, _)| kept[*old]) {
            let new = self.cells.len() as u32;
            numbers.insert(old as u32, new);
            if new != NIL {
                cell.rest = numbers.get(&cell.rest).copied().unwrap_or(NIL);
                self.table.insert((cell.entry, cell.rest), new);
                entries[cell.entry as usize] = true;
            }
            self.cells.push(cell);
        }
        self.others.retain(|_, entry| entries[*entry as usize]);
        numbers
    }

    /// The number of a set of numbers.
    pub fn set(&mut self, members: impl IntoIterator<Item = u32>) -> u32 {
        let mut words: Vec<u32> = Vec::new();
        for member in members {
            let word = member as usize / 32;
            if words.len() <= word {
                words.resize(word + 1, 0);
            }
            words[word] |= 1 << (member % 32);
        }
        self.sets.intern(&words)
    }

    /// Whether a number is in a set.
    pub fn contains(&self, set: u32, member: u32) -> bool {
        let words = self.sets.get(set);
        let word = words.get(member as usize / 32);
        word.is_some_and(|word| word & (1 << (member % 32)) != 0)
    }

    fn union(&mut self, a: u32, b: u32) -> u32 {
        if a == b {
            return a;
        }
        if let Some(known) = self.unions.get(&(a, b)) {
            return *known;
        }
        let (x, y) = (self.sets.get(a), self.sets.get(b));
        let word = |words: &[u32], at: usize| words.get(at).copied().unwrap_or_default();
        let both: Vec<u32> = (0..x.len().max(y.len()))
            .map(|at| word(x, at) | word(y, at))
            .collect();
        let union = self.sets.intern(&both);
        self.unions.insert((a, b), union);
        union
    }
}
