//! Looks at all states of the protocol within a budget of faults.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use intermezzo_model_check::{Budget, Mutant, Protocol, check};

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
    /// Make a mistake on purpose, which is to be found.
    #[arg(long)]
    mutant: Option<Mutant>,
    /// Compare processes that look the same in all that they do.
    #[arg(long)]
    doubt: bool,
    /// Give up after this many seconds.
    #[arg(long)]
    seconds: Option<u64>,
}

#[expect(clippy::print_stdout, reason = "this is what it is for")]
#[expect(clippy::print_stderr, reason = "how far it is goes past what it finds")]
fn main() -> ExitCode {
    let options = Options::parse();
    let budget = Budget {
        losses: options.losses,
        duplicates: options.duplicates,
        crashes: options.crashes,
    };
    let mut protocol = Protocol::new(options.goals, budget, options.mutant);
    if options.doubt {
        protocol = protocol.doubting();
    }
    let limit = options.seconds.map(Duration::from_secs);
    let begun = Instant::now();
    let found = check(&protocol, limit, |unique| {
        let seconds = begun.elapsed().as_secs_f64();
        eprintln!("{seconds:.0} s: {unique} unique, none wrong so far");
    });
    let seconds = begun.elapsed().as_secs_f64();
    let whole = limit.is_none_or(|limit| begun.elapsed() < limit);
    println!(
        "{} states, {} unique, depth {}, {seconds:.1} s{}",
        found.states,
        found.unique,
        found.depth,
        if whole { "" } else { ", not all of them" },
    );
    let [bosses, arms, letters, worlds] = protocol.tables.sizes();
    println!("{bosses} superiors, {arms} executors, {letters} letters, {worlds} worlds");
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
