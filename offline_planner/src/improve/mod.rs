//! The cheapest plan, and better ones on the way to it.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use crate::control::{Control, Halt};
use crate::informed::search_for_the_cheapest;
use crate::plan::Solution;
use crate::portfolio::Run;
use crate::solve::{Options, Progress, Verdict};

/// Of the time there is, the search for any plan has this part, and no more than [`AT_MOST`].
const FIRST_PART: u32 = 4;
/// See [`FIRST_PART`].
const AT_MOST: Duration = Duration::from_secs(10);

/// Searches for the cheapest plan and for the proof that it is. Without time for that, the verdict
/// is the best plan that was found.
pub(crate) fn optimal(run: &Run<'_>, progress: &mut dyn FnMut(&Progress)) -> Verdict {
    let limit = run.options.time_limit;
    let first_options = Options {
        time_limit: Some(limit.map_or(AT_MOST, |limit| AT_MOST.min(limit / FIRST_PART))),
        optimal: false,
        ..run.options.clone()
    };
    let first = Run {
        compiled: run.compiled.clone(),
        options: &first_options,
        ..*run
    };
    let mut best = match first.verdict(progress) {
        Verdict::Plan(solution) => Some(solution),
        Verdict::Unsolvable(how) => return Verdict::Unsolvable(how),
        Verdict::Unknown(_) => None,
    };
    let expanded = AtomicU64::new(0);
    let mut tell = |best: &Solution, expanded: &AtomicU64| {
        progress(&Progress {
            elapsed: run.begin.elapsed(),
            phase: "improving",
            expanded: expanded.load(Ordering::Relaxed),
            best: Some((best.length(), best.cost())),
        });
    };
    if let Some(best) = &best {
        tell(best, &expanded);
    }
    let control = Control {
        stop: run.stop,
        deadline: limit.map(|limit| run.begin + limit),
        memory_limit_bytes: run.options.memory_limit_bytes,
        expanded: &expanded,
        seed: run.options.seed,
    };
    let bound = best.as_ref().map(|best| best.cost());
    let ended = search_for_the_cheapest(&run.compiled, bound, &control, &mut |choices| {
        if let Some(solution) = Solution::new(&run.compiled, &choices) {
            tell(&solution, &expanded);
            best = Some(Box::new(solution));
        }
    });
    match (ended, best) {
        (Ok(()), Some(mut best)) => {
            best.optimal = true;
            Verdict::Plan(best)
        }
        (Ok(()), None) => Verdict::Unsolvable("every way was tried, and none leads to a plan"),
        (Err(_), Some(best)) => Verdict::Plan(best),
        (Err(Halt::Told), None) => Verdict::Unknown("the time is over, or it was stopped"),
        (Err(Halt::Memory), None) => Verdict::Unknown("more memory is needed"),
        (Err(Halt::Incomplete), None) => Verdict::Unknown("the search has left something out"),
    }
}
