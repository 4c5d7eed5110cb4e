//! Which searches run, when, and whose answer counts.
//!
//! Depth-first search alone at first: most problems are done then, on one core. After that the
//! informed search has a thread of its own, and depth-first search takes turns with restarts that
//! let chance choose. The first plan counts.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use crate::compile::Compiled;
use crate::control::{Control, Halt, Outcome};
use crate::depth_first::{DepthFirst, Restarts};
use crate::informed;
use crate::plan::{Choices, Solution};
use crate::solve::{Options, Progress, Verdict};

/// Depth-first search is alone for so long.
const ALONE: Duration = Duration::from_millis(250);
/// Searches that take turns have turns of this length.
const TURN: Duration = Duration::from_millis(50);

/// One problem to be solved.
pub(crate) struct Run<'a> {
    pub compiled: Arc<Compiled>,
    pub options: &'a Options,
    pub begin: Instant,
    /// Set by the user.
    pub stop: &'a AtomicBool,
}

impl Run<'_> {
    /// Searches until there is an answer or no time.
    pub fn verdict(&self, progress: &mut dyn FnMut(&Progress)) -> Verdict {
        let expanded = Arc::new(AtomicU64::new(0));
        let mut depth_first = DepthFirst::new(&self.compiled);
        let alone = self.turn(self.begin + ALONE, &expanded);
        let mut first = match depth_first.run(&alone) {
            Outcome::Stopped(Halt::Told) if !self.is_over() => Some(depth_first),
            // What it has tried would have to be forgotten.
            Outcome::Stopped(Halt::Memory) if !self.is_over() => None,
            outcome => return self.answer(outcome),
        };
        self.tell(progress, "depth first", &expanded);
        let over = Arc::new(AtomicBool::new(false));
        let informed = self.begin_informed(&over, &expanded);
        let outcome = self.take_turns(&mut first, &informed, &expanded, progress);
        // It ends by itself; nobody waits for it, as it may be in the midst of something long.
        over.store(true, Ordering::Relaxed);
        self.answer(outcome)
    }

    /// Gives the informed search a thread of its own.
    fn begin_informed(
        &self,
        over: &Arc<AtomicBool>,
        expanded: &Arc<AtomicU64>,
    ) -> Receiver<Outcome> {
        let (sender, receiver) = mpsc::channel();
        let (over, expanded) = (Arc::clone(over), Arc::clone(expanded));
        let compiled = Arc::clone(&self.compiled);
        let deadline = self.deadline();
        let memory_limit_bytes = self.options.memory_limit_bytes / 3;
        let seed = self.options.seed;
        thread::spawn(move || {
            let control = Control {
                stop: &over,
                deadline,
                memory_limit_bytes,
                expanded: &expanded,
                seed,
            };
            // Nobody listens any more if another search was faster.
            let _ = sender.send(informed::search(&compiled, &control));
        });
        receiver
    }

    /// Depth-first search and restarts in turns, until they or the informed search have an answer.
    fn take_turns(
        &self,
        first: &mut Option<DepthFirst>,
        informed: &Receiver<Outcome>,
        expanded: &AtomicU64,
        progress: &mut dyn FnMut(&Progress),
    ) -> Outcome {
        let mut restarts = Restarts::new(&self.compiled, self.options.seed);
        let mut informed_is_on = true;
        loop {
            if let Some(search) = first {
                match search.run(&self.turn(Instant::now() + TURN, expanded)) {
                    Outcome::Stopped(Halt::Told) => {}
                    // What it has tried would have to be forgotten.
                    Outcome::Stopped(_) => *first = None,
                    outcome => return outcome,
                }
            }
            match restarts.run(&self.turn(Instant::now() + TURN, expanded)) {
                Outcome::Stopped(_) => {}
                outcome => return outcome,
            }
            if informed_is_on {
                match informed.recv_timeout(Duration::ZERO) {
                    Ok(Outcome::Stopped(_)) | Err(RecvTimeoutError::Disconnected) => {
                        informed_is_on = false;
                    }
                    Ok(outcome) => return outcome,
                    Err(RecvTimeoutError::Timeout) => {}
                }
            }
            if self.is_over() {
                return Outcome::Stopped(Halt::Told);
            }
            let phase = if informed_is_on {
                "depth first and informed"
            } else {
                "depth first"
            };
            self.tell(progress, phase, expanded);
        }
    }

    fn deadline(&self) -> Option<Instant> {
        self.options.time_limit.map(|limit| self.begin + limit)
    }

    /// Control over a search until then.
    fn turn<'a>(&'a self, until: Instant, expanded: &'a AtomicU64) -> Control<'a> {
        Control {
            stop: self.stop,
            deadline: Some(self.deadline().map_or(until, |end| end.min(until))),
            // Three may run at a time.
            memory_limit_bytes: self.options.memory_limit_bytes / 3,
            expanded,
            seed: self.options.seed,
        }
    }

    fn is_over(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
            || self.deadline().is_some_and(|end| Instant::now() >= end)
    }

    fn tell(&self, progress: &mut dyn FnMut(&Progress), phase: &'static str, expanded: &AtomicU64) {
        progress(&Progress {
            elapsed: self.begin.elapsed(),
            phase,
            expanded: expanded.load(Ordering::Relaxed),
            best: None,
        });
    }

    fn answer(&self, outcome: Outcome) -> Verdict {
        match outcome {
            Outcome::Found(choices) => self.plan(&choices),
            Outcome::Unsolvable => {
                Verdict::Unsolvable("every way was tried, and none leads to a plan")
            }
            Outcome::Stopped(Halt::Memory) => Verdict::Unknown("more memory is needed"),
            Outcome::Stopped(Halt::Incomplete) => {
                Verdict::Unknown("the search has left something out")
            }
            Outcome::Stopped(Halt::Told) if self.stop.load(Ordering::Relaxed) => {
                Verdict::Unknown("it was stopped")
            }
            Outcome::Stopped(Halt::Told) => Verdict::Unknown("the time is over"),
        }
    }

    fn plan(&self, choices: &Choices) -> Verdict {
        match Solution::new(&self.compiled, choices) {
            Some(solution) => Verdict::Plan(Box::new(solution)),
            None => Verdict::Unknown("a search made no sense; this is a bug"),
        }
    }
}
