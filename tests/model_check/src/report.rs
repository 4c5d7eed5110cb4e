//! Looks at all states, and tells what it has found.

use std::thread::sleep;
use std::time::{Duration, Instant};

use stateright::{Checker, HasDiscoveries, Model};

use crate::Protocol;

/// How often it is told how far it is.
const PROGRESS_EVERY: Duration = Duration::from_secs(2);

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

/// Looks at all states that there are, or as many as fit in `limit`; `progress` is told now and then
/// how many different ones there were.
pub fn check(protocol: &Protocol, limit: Option<Duration>, progress: impl FnMut(usize)) -> Found {
    // Depth first needs no memory for what is still to be looked at.
    let builder = builder(protocol, limit);
    let found = wait(protocol, builder.spawn_dfs(), progress);
    if found.violations.is_empty() {
        return found;
    }
    // The story that is found first this way is a short one.
    let shortest = wait(protocol, self::builder(protocol, limit).spawn_bfs(), |_| {});
    match shortest.violations.is_empty() {
        true => found,
        false => shortest,
    }
}

fn builder(protocol: &Protocol, limit: Option<Duration>) -> stateright::CheckerBuilder<Protocol> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let builder = protocol.clone().checker().threads(threads);
    let builder = builder.finish_when(HasDiscoveries::AnyFailures);
    match limit {
        Some(limit) => builder.timeout(limit),
        None => builder,
    }
}

fn wait(
    protocol: &Protocol,
    mut checker: impl Checker<Protocol>,
    mut progress: impl FnMut(usize),
) -> Found {
    let handles = checker.handles();
    let mut told = Instant::now();
    while handles.iter().any(|handle| !handle.is_finished()) {
        sleep(Duration::from_millis(10));
        if told.elapsed() > PROGRESS_EVERY {
            told = Instant::now();
            progress(checker.unique_state_count());
        }
    }
    for handle in handles {
        handle.join().expect("the model does not panic");
    }
    let violations = checker.discoveries().into_iter().map(|(property, path)| {
        let mut story = vec![format!("does not hold: {property}")];
        let path = path.into_vec();
        for (state, step) in &path {
            story.extend(step.iter().map(|step| protocol.tell(state, step)));
        }
        let last = path.last().and_then(|(state, _)| state.broken);
        story.extend(last.map(|last| protocol.tables.fault_of(last).to_owned()));
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
