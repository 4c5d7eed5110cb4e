//! What holds now, by the belief or the map, found by predicate and by each argument.

use super::intern::{Map, Slices};

/// Who says that a fact holds.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Source {
    Belief = 1,
    Map = 2,
}

/// The atoms that were ever named, which of them hold, and the values of functions.
#[derive(Clone, Debug, Default)]
pub(super) struct Facts {
    atoms: Slices,
    /// By atom, who says that it holds.
    held: Vec<u8>,
    /// How many facts the belief says.
    believed: usize,
    /// By predicate; by predicate, place of an argument (from 1) and object.
    index: Map<(u32, u32, u32), Vec<u32>>,
    /// By atom, where its places in the lists of `index` begin in `places`.
    first_place: Vec<u32>,
    places: Vec<u32>,
    values: Map<u32, f64>,
    map_values: Map<u32, f64>,
}

impl Facts {
    /// The number of an atom, name first.
    pub fn atom(&mut self, words: &[u32]) -> u32 {
        let atom = self.atoms.intern(words);
        if atom as usize == self.held.len() {
            self.held.push(0);
            self.first_place.push(self.places.len() as u32);
            self.places.resize(self.places.len() + words.len(), 0);
        }
        atom
    }

    /// The number of an atom, if it was ever named.
    pub fn find(&self, words: &[u32]) -> Option<u32> {
        self.atoms.find(words)
    }

    /// How many atoms there are.
    pub fn len(&self) -> usize {
        self.held.len()
    }

    /// Name and arguments.
    pub fn words(&self, atom: u32) -> &[u32] {
        self.atoms.get(atom)
    }

    pub fn name(&self, atom: u32) -> u32 {
        self.words(atom)[0]
    }

    pub fn args(&self, atom: u32) -> &[u32] {
        &self.words(atom)[1..]
    }

    pub fn holds(&self, atom: u32) -> bool {
        self.held[atom as usize] != 0
    }

    /// Whether this source says so.
    pub fn says(&self, source: Source, atom: u32) -> bool {
        self.held[atom as usize] & source as u8 != 0
    }

    pub fn believed(&self) -> usize {
        self.believed
    }

    /// The atoms that the belief says hold.
    pub fn each_believed(&self) -> impl Iterator<Item = u32> + '_ {
        let says = |atom: &u32| self.says(Source::Belief, *atom);
        (0..self.held.len() as u32).filter(says)
    }

    /// Lets a source say that a fact holds, or not. Returns whether it now holds otherwise than
    /// before.
    pub fn set(&mut self, source: Source, atom: u32, holds: bool) -> bool {
        let before = self.held[atom as usize];
        let after = match holds {
            true => before | source as u8,
            false => before & !(source as u8),
        };
        if source == Source::Belief && after != before {
            match holds {
                true => self.believed += 1,
                false => self.believed -= 1,
            }
        }
        self.held[atom as usize] = after;
        match (before != 0, after != 0) {
            (false, true) => self.enter(atom),
            (true, false) => self.leave(atom),
            _ => return false,
        }
        true
    }

    /// The key in `index` of the list that an atom is in by its word number `place`.
    fn key(&self, atom: u32, place: usize) -> (u32, u32, u32) {
        let words = self.words(atom);
        match place {
            0 => (words[0], 0, 0),
            _ => (words[0], place as u32, words[place]),
        }
    }

    fn enter(&mut self, atom: u32) {
        let first = self.first_place[atom as usize] as usize;
        for place in 0..self.words(atom).len() {
            let key = self.key(atom, place);
            let list = self.index.entry(key).or_default();
            self.places[first + place] = list.len() as u32;
            list.push(atom);
        }
    }

    fn leave(&mut self, atom: u32) {
        let first = self.first_place[atom as usize] as usize;
        for place in 0..self.words(atom).len() {
            let key = self.key(atom, place);
            let at = self.places[first + place] as usize;
            let Some(list) = self.index.get_mut(&key) else {
                continue;
            };
            list.swap_remove(at);
            if let Some(moved) = list.get(at) {
                self.places[self.first_place[*moved as usize] as usize + place] = at as u32;
            }
        }
    }

    /// Atoms that hold, among them all of a predicate with these arguments, where an unbound one
    /// ([`NONE`](super::intern::NONE)) may be any.
    pub fn candidates(&self, name: u32, args: &[u32]) -> &[u32] {
        let mut best = self.list((name, 0, 0));
        for (place, arg) in args.iter().enumerate() {
            if *arg != super::intern::NONE && !best.is_empty() {
                let list = self.list((name, place as u32 + 1, *arg));
                if list.len() < best.len() {
                    best = list;
                }
            }
        }
        best
    }

    fn list(&self, key: (u32, u32, u32)) -> &[u32] {
        self.index.get(&key).map_or(&[], Vec::as_slice)
    }

    /// The value of a function, if it has one; the belief goes before the map.
    pub fn value(&self, function: u32) -> Option<f64> {
        let believed = self.values.get(&function);
        believed.or_else(|| self.map_values.get(&function)).copied()
    }

    /// How many values the belief says.
    pub fn believed_values(&self) -> &Map<u32, f64> {
        &self.values
    }

    /// Lets a source give a function a value. Returns whether that is another one than before.
    pub fn set_value(&mut self, source: Source, function: u32, value: Option<f64>) -> bool {
        let before = self.value(function).map(f64::to_bits);
        let values = match source {
            Source::Belief => &mut self.values,
            Source::Map => &mut self.map_values,
        };
        match value {
            Some(value) => values.insert(function, value),
            None => values.remove(&function),
        };
        self.value(function).map(f64::to_bits) != before
    }
}
