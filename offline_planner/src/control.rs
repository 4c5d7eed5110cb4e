//! How a running search is told to stop, and what it reports.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use crate::plan::Choices;

/// What a search must look at every now and then (every few hundred nodes).
#[derive(Clone, Copy, Debug)]
pub struct Control<'a> {
    /// Somebody else has found a plan, or the user has had enough.
    pub stop: &'a AtomicBool,
    /// When to give up.
    pub deadline: Option<Instant>,
    /// What the search may use for itself, roughly.
    pub memory_limit_bytes: u64,
    /// The search counts here what it has expanded, for whoever shows it.
    pub expanded: &'a AtomicU64,
    /// Where there is chance in a search, it comes from here: same seed, same search.
    pub seed: u64,
}

impl Control<'_> {
    /// Whether to stop now.
    pub fn is_over(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
            || self
                .deadline
                .is_some_and(|deadline| Instant::now() >= deadline)
    }
}

/// How a search ended.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Outcome {
    /// With a plan.
    Found(Choices),
    /// There is no plan: everything was searched, and nothing left out that could be one.
    Unsolvable,
    /// It was told to stop, or cannot go on.
    Stopped(Halt),
}

/// Why a search ended without an answer.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Halt {
    /// [`Control::is_over`].
    Told,
    /// It would need more memory than it may use.
    Memory,
    /// It has left out something in which a plan might be, and has nothing else to search.
    Incomplete,
}
