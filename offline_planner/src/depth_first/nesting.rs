//! Tasks that are decomposed within themselves.

use rustc_hash::FxHashMap;

use super::hash::Numbers;

/// Which tasks are being decomposed, in which state that began, and which ever were.
///
/// A task in a state is a number here. Without a bound a task that begins with itself would make
/// the task list longer for ever.
#[derive(Debug, Default)]
pub struct Nesting {
    /// How many of each are open.
    open: FxHashMap<u64, u32>,
    begun: Numbers,
    done: Numbers,
    /// What was opened (`true`) and closed, to be taken back.
    trail: Vec<(u64, bool)>,
    /// How often a task may be begun within itself in one and the same state.
    most: u32,
}

impl Nesting {
    /// Nothing is open or ever was; so many are allowed.
    pub fn allowing(most: u32) -> Self {
        Self {
            most,
            ..Self::default()
        }
    }

    /// How often a task may be begun within itself.
    pub fn most(&self) -> u32 {
        self.most
    }

    /// Whether the task may be begun: within itself only so often; and at first not again if it was
    /// never brought to an end. (That may have been because it was tried within what it is now
    /// tried beside.)
    pub fn may_open(&self, number: u64) -> bool {
        match self.open.get(&number) {
            Some(open) => *open <= self.most,
            None => self.most > 0 || !self.begun.contains(number) || self.done.contains(number),
        }
    }

    /// The task is begun.
    pub fn open(&mut self, number: u64) {
        self.count_up(number);
        self.begun.insert(number);
        self.trail.push((number, true));
    }

    /// The task is done.
    pub fn close(&mut self, number: u64) {
        self.count_down(number);
        self.done.insert(number);
        self.trail.push((number, false));
    }

    /// How far it is back, to come back to here.
    pub fn mark(&self) -> u32 {
        self.trail.len() as u32
    }

    /// Takes back what was opened and closed since the mark. What was ever begun stays known.
    pub fn undo_to(&mut self, mark: u32) {
        while self.trail.len() > mark as usize {
            match self.trail.pop() {
                Some((number, true)) => self.count_down(number),
                Some((number, false)) => self.count_up(number),
                None => {}
            }
        }
    }

    /// Memory taken by what grows.
    pub fn bytes(&self) -> usize {
        self.open.capacity() * size_of::<(u64, u32)>()
            + self.trail.capacity() * size_of::<(u64, bool)>()
            + self.begun.bytes()
            + self.done.bytes()
    }

    fn count_up(&mut self, number: u64) {
        *self.open.entry(number).or_insert(0) += 1;
    }

    fn count_down(&mut self, number: u64) {
        if let Some(count) = self.open.get_mut(&number) {
            *count -= 1;
            if *count == 0 {
                self.open.remove(&number);
            }
        }
    }
}
