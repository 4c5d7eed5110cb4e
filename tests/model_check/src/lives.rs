//! Everything that one of the two can come to be, and what it does there: each found out once, by the
//! real station with the real machine in it.
//!
//! What a process does depends on what it is and on what happens to it and on nothing else, and it comes
//! to be far fewer things than there are moments of the whole.

use std::sync::{Mutex, OnceLock, PoisonError, RwLock};

use crate::happen::Left;
use crate::names::Names;
use crate::node::Node;
use crate::role::Role;
use crate::seen::Seen;

/// How many that look the same are kept to be compared.
const TWINS: usize = 2;

/// Something that happens to one of the two, by numbers.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Cue {
    /// A user asks for that goal.
    Ask(usize),
    /// That letter arrives.
    Arrives(u32),
    /// What was being written is on the disk.
    Written,
    /// The world says that.
    Hears(u32),
    /// Its neighbour is there, or is not.
    Neighbour(bool),
    /// Its neighbour was gone and is there again.
    Again,
    /// It dies and starts again.
    Dies(Left),
    /// Nobody dies any more.
    Spared,
}

/// What becomes of it.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Then {
    /// What it is then.
    pub next: u32,
    /// What it has said, all in one.
    pub said: u32,
}

/// What one of the two can be.
#[derive(Debug)]
pub struct Life<M: Role> {
    /// It.
    pub node: Node<M>,
    /// What is looked at of it.
    pub seen: Seen,
    then: RwLock<Vec<(Cue, Then)>>,
    released: OnceLock<u8>,
    /// Others that came to be the same in another way.
    twins: Mutex<Vec<Node<M>>>,
}

impl<M: Role> Life<M> {
    fn new(node: Node<M>, seen: Seen) -> Self {
        Self {
            node,
            seen,
            then: RwLock::default(),
            released: OnceLock::new(),
            twins: Mutex::default(),
        }
    }

    /// What becomes of it then, if that is known.
    pub fn known(&self, cue: Cue) -> Option<Then> {
        let known = self.then.read().unwrap_or_else(PoisonError::into_inner);
        let mut known = known.iter();
        known.find(|(at, _)| *at == cue).map(|(_, then)| *then)
    }

    /// What becomes of it then.
    pub fn learn(&self, cue: Cue, then: Then) {
        let mut known = self.then.write().unwrap_or_else(PoisonError::into_inner);
        if !known.iter().any(|(at, _)| *at == cue) {
            known.push((cue, then));
        }
    }

    /// All that is known to become of it.
    pub fn all_known(&self) -> Vec<(Cue, Then)> {
        let known = self.then.read().unwrap_or_else(PoisonError::into_inner);
        known.clone()
    }

    /// How many effects wait for the writing that is under way, found out once.
    pub fn released(&self, find_out: impl FnOnce(&Node<M>) -> u8) -> u8 {
        *self.released.get_or_init(|| find_out(&self.node))
    }

    /// Another that looks the same. Whether it is kept.
    pub fn add_twin(&self, twin: &Node<M>) -> bool {
        let mut twins = self.twins.lock().unwrap_or_else(PoisonError::into_inner);
        let room = twins.len() < TWINS;
        if room {
            twins.push(twin.clone());
        }
        room
    }

    /// Others that look the same.
    pub fn twins(&self) -> Vec<Node<M>> {
        let twins = self.twins.lock().unwrap_or_else(PoisonError::into_inner);
        twins.clone()
    }
}

/// What one of the two has come to be so far, anywhere.
#[derive(Debug)]
pub struct Lives<M: Role> {
    all: Names<u128, Life<M>>,
}

impl<M: Role> Default for Lives<M> {
    fn default() -> Self {
        Self {
            all: Names::default(),
        }
    }
}

impl<M: Role> Lives<M> {
    /// That one.
    pub fn get(&self, number: u32) -> &Life<M> {
        self.all.get(number)
    }

    /// The number of the one of that fingerprint; if there is none, of this one from now on.
    pub fn number(&self, print: u128, node: Node<M>, look: impl FnOnce(&Node<M>) -> Seen) -> u32 {
        self.all.number(print, || {
            let seen = look(&node);
            Life::new(node, seen)
        })
    }

    /// The number of the one of that fingerprint, if there is one.
    pub fn find(&self, print: u128) -> Option<u32> {
        self.all.find(&print)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }
}
