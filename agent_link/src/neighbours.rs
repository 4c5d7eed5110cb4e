//! Who of this robot is there.

use std::collections::{BTreeMap, BTreeSet};

/// The starts of each neighbour that are alive. A process that takes the place of another may be
/// seen before that one is known to be gone.
#[derive(Debug, Default)]
pub(crate) struct Neighbours {
    alive: BTreeMap<String, BTreeSet<u64>>,
}

impl Neighbours {
    /// A start of a neighbour has appeared or vanished. Returns whether the neighbour is there, if
    /// that has changed.
    pub(crate) fn hear(&mut self, name: &str, epoch: u64, appeared: bool) -> Option<bool> {
        let starts = self.alive.entry(name.to_owned()).or_default();
        let before = !starts.is_empty();
        if appeared {
            starts.insert(epoch);
        } else {
            starts.remove(&epoch);
        }
        let there = !starts.is_empty();
        if !there {
            self.alive.remove(name);
        }
        (there != before).then_some(there)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_neighbour_is_gone_when_none_of_its_starts_is_left() {
        let mut neighbours = Neighbours::default();
        assert_eq!(neighbours.hear("child", 1, true), Some(true));
        assert_eq!(neighbours.hear("child", 2, true), None);
        assert_eq!(neighbours.hear("child", 1, false), None);
        assert_eq!(neighbours.hear("child", 2, false), Some(false));
        assert_eq!(neighbours.hear("child", 2, false), None);
        assert_eq!(neighbours.hear("child", 3, true), Some(true));
    }
}
