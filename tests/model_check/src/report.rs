//! Looks at all states, and tells what it has found.

use std::time::Duration;

use stateright::{Checker, Model};

use crate::Protocol;

/// What was found.
#[derive(Clone, Debug)]
pub struct Found {
    /// States that were come by, repetitions included.
    pub states: usize,
    /// Different ones.
    pub unique: usize,
    /// Steps to the farthest.
    pub depth: usize,
    /// Whether there are no others.
    pub complete: bool,
    /// What does not hold, with the shortest story that leads there.
    pub violations: Vec<Vec<String>>,
}

/// Looks at all states that there are, or as many as fit in `limit`.
pub fn check(protocol: &Protocol, limit: Option<Duration>) -> Found {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut builder = protocol.clone().checker().threads(threads);
    if let Some(limit) = limit {
        builder = builder.timeout(limit);
    }
    let checker = builder.spawn_bfs().join();
    let violations = checker.discoveries().into_iter().map(|(property, path)| {
        let mut story = vec![format!("does not hold: {property}")];
        let path = path.into_vec();
        for (state, step) in &path {
            story.extend(step.iter().map(|step| protocol.tell(state, step)));
        }
        let last = path.last().and_then(|(state, _)| state.broken.clone());
        story.extend(last);
        story
    });
    let violations: Vec<_> = violations.collect();
    Found {
        states: checker.state_count(),
        unique: checker.unique_state_count(),
        depth: checker.max_depth(),
        complete: checker.is_done() && violations.is_empty(),
        violations,
    }
}
