//! A number for each of many values, and back.

use std::hash::Hash;
use std::sync::{PoisonError, RwLock};

use rustc_hash::FxHashMap;

/// Values that are numbered in the order in which they come up. Two are the same if their keys are.
#[derive(Debug)]
pub struct Names<K, V> {
    numbers: RwLock<FxHashMap<K, u32>>,
    values: boxcar::Vec<V>,
}

impl<K, V> Default for Names<K, V> {
    fn default() -> Self {
        Self {
            numbers: RwLock::default(),
            values: boxcar::Vec::new(),
        }
    }
}

impl<K: Eq + Hash, V> Names<K, V> {
    /// The number of the value of that key, if it has one.
    pub fn find(&self, key: &K) -> Option<u32> {
        let numbers = self.numbers.read().unwrap_or_else(PoisonError::into_inner);
        numbers.get(key).copied()
    }

    /// The number of the value of that key; if it has none, of this one from now on.
    pub fn number(&self, key: K, value: impl FnOnce() -> V) -> u32 {
        if let Some(number) = self.find(&key) {
            return number;
        }
        // Made before anybody has to wait for it.
        let value = value();
        let mut numbers = self.numbers.write().unwrap_or_else(PoisonError::into_inner);
        *numbers.entry(key).or_insert_with(|| {
            let number = self.values.push(value);
            u32::try_from(number).expect("memory ends before numbers do")
        })
    }

    /// The value of that number.
    pub fn get(&self, number: u32) -> &V {
        let value = self.values.get(number as usize);
        value.expect("numbers come from here only")
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.values.count()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
