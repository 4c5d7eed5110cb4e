//! The one entrance: a domain and a problem in, a verdict out.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use agent_core::model::{Cost, Domain, Instance};

use crate::compile::{Compiled, Unfit};
use crate::improve;
use crate::plan::Solution;
use crate::portfolio::Run;

/// What is asked of the planner.
#[derive(Clone, Debug)]
pub struct Options {
    /// When to give up; never if there is none.
    pub time_limit: Option<Duration>,
    /// A plan of least cost and the proof that it is; every better plan on the way is reported.
    pub optimal: bool,
    /// What all searches together may use, roughly.
    pub memory_limit_bytes: u64,
    /// Where chance is used, it comes from here.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            time_limit: None,
            optimal: false,
            memory_limit_bytes: 6 << 30,
            seed: 0,
        }
    }
}

/// How planning goes; told several times a second while it lasts, and when something is found.
#[derive(Clone, Debug)]
pub struct Progress {
    /// Since planning began.
    pub elapsed: Duration,
    /// What runs: `depth first`, `informed`, `improving`, …
    pub phase: &'static str,
    /// Nodes expanded by all searches together.
    pub expanded: u64,
    /// The best plan until now: how many actions, and what they cost.
    pub best: Option<(usize, Cost)>,
}

/// What came out.
#[derive(Clone, Debug)]
pub enum Verdict {
    /// A plan.
    Plan(Box<Solution>),
    /// It is proved that there is none; how, in a few words.
    Unsolvable(&'static str),
    /// Nobody knows as yet; why planning ended.
    Unknown(&'static str),
}

/// Plans.
///
/// Ends early, with what it has, once `stop` is set, from whatever thread (or signal) that may be.
///
/// # Errors
/// If domain and problem do not fit each other; those that were read from text do.
pub fn solve(
    domain: &Domain,
    instance: &Instance,
    options: &Options,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&Progress),
) -> Result<Verdict, Unfit> {
    let begin = Instant::now();
    let compiled = Arc::new(Compiled::new(domain, instance)?);
    if compiled.task(compiled.top).methods.is_empty() {
        return Ok(Verdict::Unsolvable(
            "a task has no method that could ever be used",
        ));
    }
    let run = Run {
        compiled,
        options,
        begin,
        stop,
    };
    Ok(if options.optimal {
        improve::optimal(&run, progress)
    } else {
        run.verdict(progress)
    })
}
