//! Looks at all states of the protocol within a budget of faults.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use intermezzo_model_check::{Budget, Protocol, check};

/// Checks the protocol in every order of events.
#[derive(Debug, Parser)]
struct Options {
    /// Goals: one normal, the others emergencies.
    #[arg(long, default_value_t = 2)]
    goals: usize,
    /// Letters that may be lost.
    #[arg(long, default_value_t = 1)]
    losses: u8,
    /// Letters that may arrive twice.
    #[arg(long, default_value_t = 1)]
    duplicates: u8,
    /// Processes that may die.
    #[arg(long, default_value_t = 1)]
    crashes: u8,
    /// Give up after this many seconds.
    #[arg(long)]
    seconds: Option<u64>,
}

#[expect(clippy::print_stdout, reason = "this is what it is for")]
fn main() -> ExitCode {
    let options = Options::parse();
    let budget = Budget {
        losses: options.losses,
        duplicates: options.duplicates,
        crashes: options.crashes,
    };
    let protocol = Protocol::new(options.goals, budget, None);
    let limit = options.seconds.map(Duration::from_secs);
    let begun = Instant::now();
    let found = check(&protocol, limit);
    let seconds = begun.elapsed().as_secs_f64();
    let whole = limit.is_none_or(|limit| begun.elapsed() < limit);
    println!(
        "{} states, {} unique, depth {}, {seconds:.1} s{}",
        found.states,
        found.unique,
        found.depth,
        if whole { "" } else { ", not all of them" },
    );
    for story in &found.violations {
        for line in story {
            println!("  {line}");
        }
    }
    match (found.violations.is_empty(), whole) {
        (true, true) => ExitCode::SUCCESS,
        (false, _) => ExitCode::from(1),
        (true, false) => ExitCode::from(2),
    }
}
