//! Types as sets of objects.

use rustc_hash::FxHashMap;

use super::{KindId, ObjectId};

/// The objects that a variable may stand for.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Kind {
    /// In ascending order.
    pub members: Vec<ObjectId>,
    /// One bit for each object of the problem.
    bits: Vec<u64>,
}

impl Kind {
    fn new(members: Vec<ObjectId>) -> Self {
        let words = members.last().map_or(0, |last| last.index() / 64 + 1);
        let mut bits = vec![0; words];
        for member in &members {
            if let Some(word) = bits.get_mut(member.index() / 64) {
                *word |= 1 << (member.index() % 64);
            }
        }
        Self { members, bits }
    }

    /// Whether the object is one of these.
    pub fn contains(&self, object: ObjectId) -> bool {
        self.bits
            .get(object.index() / 64)
            .is_some_and(|word| word >> (object.index() % 64) & 1 == 1)
    }

    /// Whether no object is in both.
    pub fn is_disjoint(&self, other: &Self) -> bool {
        self.bits.iter().zip(&other.bits).all(|(a, b)| a & b == 0)
    }

    fn intersection(&self, other: &Self) -> Vec<ObjectId> {
        let both = self.members.iter().copied();
        both.filter(|member| other.contains(*member)).collect()
    }
}

/// All sets that are needed, each once.
#[derive(Clone, Debug, Default)]
pub struct Kinds {
    all: Vec<Kind>,
    known: FxHashMap<Vec<ObjectId>, KindId>,
}

impl Kinds {
    /// The set of these objects.
    pub fn of(&mut self, mut members: Vec<ObjectId>) -> KindId {
        members.sort_unstable();
        members.dedup();
        if let Some(id) = self.known.get(&members) {
            return *id;
        }
        let id = KindId::new(self.all.len());
        self.known.insert(members.clone(), id);
        self.all.push(Kind::new(members));
        id
    }

    /// What is in both.
    pub fn both(&mut self, one: KindId, other: KindId) -> KindId {
        if one == other {
            return one;
        }
        let members = self.get(one).intersection(self.get(other));
        self.of(members)
    }

    /// How many sets there are.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// The set of that number.
    pub fn get(&self, id: KindId) -> &Kind {
        &self.all[id.index()]
    }
}
