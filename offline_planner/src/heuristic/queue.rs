//! A queue by cost for costs that are mostly small.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Costs below this have lists of their own.
const SMALL: usize = 4096;

/// Numbers by cost, the least first.
pub(super) struct Queue {
    lists: Vec<Vec<u32>>,
    /// No list before this one has anything.
    least: usize,
    /// How many numbers the lists have.
    count: usize,
    large: BinaryHeap<(Reverse<u32>, u32)>,
}

impl Queue {
    /// Empty.
    pub fn new() -> Self {
        Self {
            lists: vec![Vec::new(); SMALL],
            least: 0,
            count: 0,
            large: BinaryHeap::new(),
        }
    }

    /// One more.
    pub fn push(&mut self, cost: u32, number: u32) {
        match self.lists.get_mut(cost as usize) {
            Some(list) => {
                list.push(number);
                self.count += 1;
                self.least = self.least.min(cost as usize);
            }
            None => self.large.push((Reverse(cost), number)),
        }
    }

    /// The cheapest.
    pub fn pop(&mut self) -> Option<(u32, u32)> {
        if self.count == 0 {
            self.least = 0;
            return self
                .large
                .pop()
                .map(|(Reverse(cost), number)| (cost, number));
        }
        while let Some(list) = self.lists.get_mut(self.least) {
            if let Some(number) = list.pop() {
                self.count -= 1;
                return Some((self.least as u32, number));
            }
            self.least += 1;
        }
        None
    }

    /// Empties it.
    pub fn clear(&mut self) {
        if self.count > 0 {
            self.lists.iter_mut().for_each(Vec::clear);
        }
        self.count = 0;
        self.least = 0;
        self.large.clear();
    }
}
