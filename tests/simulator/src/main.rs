//! Runs scenarios by the million, and tells the story of the first that goes wrong.
#![expect(clippy::print_stdout, reason = "it is what the program is for")]

use std::collections::BTreeMap;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use intermezzo_simulator::ground::Ground;
use intermezzo_simulator::mutant::{MUTANTS, Mutant};
use intermezzo_simulator::scenario::Scenario;
use intermezzo_simulator::shrink::{keep_panics, run_safely, shrink};
use serde_json::json;

/// Whole stacks in virtual time with everything going wrong: crashes, loss, partitions, full disks.
#[derive(Parser)]
struct Cli {
    /// How many scenarios are run.
    #[arg(long, default_value_t = 10_000)]
    seeds: u64,
    /// The seed of the first.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Only the one of this seed, and its whole story.
    #[arg(long)]
    seed: Option<u64>,
    /// No longer than this, in seconds.
    #[arg(long)]
    seconds: Option<u64>,
    /// With a deliberate mistake, by its name; `all`: each in turn, until it is caught.
    #[arg(long)]
    mutant: Option<String>,
    /// A failing scenario is told as it is, without cutting it down.
    #[arg(long)]
    whole: bool,
    /// Goes on after a failure, and names the seeds of all.
    #[arg(long)]
    keep_going: bool,
    /// A summary in JSON.
    #[arg(long)]
    json: bool,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let ground = Ground::new();
    keep_panics();
    let mutant = match cli.mutant.as_deref() {
        None => None,
        Some("all") => return hunt(&cli, &ground),
        Some(name) => match MUTANTS.iter().find(|mutant| mutant.to_string() == name) {
            Some(mutant) => Some(*mutant),
            None => {
                println!("there is no mutant `{name}`; there are:");
                for mutant in MUTANTS {
                    println!("  {mutant}");
                }
                return ExitCode::from(2);
            }
        },
    };
    match cli.seed {
        Some(seed) => tell(&cli, &ground, seed, mutant),
        None => run_many(&cli, &ground, mutant),
    }
}

/// The story of one scenario.
fn tell(cli: &Cli, ground: &Ground, seed: u64, mutant: Option<Mutant>) -> ExitCode {
    let mut scenario = Scenario::of(seed);
    let outcome = run_safely(ground, &scenario, mutant, false);
    if outcome.broken.is_some() && !cli.whole {
        let many = scenario.happenings.len();
        scenario = shrink(ground, &scenario, mutant);
        let few = scenario.happenings.len();
        println!("of {many} happenings {few} are enough:");
    }
    let outcome = run_safely(ground, &scenario, mutant, true);
    println!("{scenario}");
    for line in &outcome.story {
        println!("{line}");
    }
    println!("\n{:?}", outcome.counts);
    match outcome.broken {
        None => ExitCode::SUCCESS,
        Some(broken) => {
            println!("\nwrong: {broken}");
            ExitCode::FAILURE
        }
    }
}

fn run_many(cli: &Cli, ground: &Ground, mutant: Option<Mutant>) -> ExitCode {
    let over = Arc::new(AtomicBool::new(false));
    let _ = signal_hook::flag::register(signal_hook::consts::SIGINT, over.clone());
    let bar = if cli.json {
        ProgressBar::hidden()
    } else {
        ProgressBar::new(cli.seeds)
    };
    let style = "{elapsed_precise} {bar:30} {pos}/{len} {per_sec} {msg}";
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    let begun = Instant::now();
    let mut counts: BTreeMap<&'static str, u64> = BTreeMap::new();
    let mut wrong: Vec<(u64, String)> = Vec::new();
    let mut ran = 0;
    for seed in cli.first..cli.first.saturating_add(cli.seeds) {
        let outcome = run_safely(ground, &Scenario::of(seed), mutant, false);
        ran += 1;
        for (what, times) in outcome.counts {
            *counts.entry(what).or_default() += times;
        }
        if let Some(broken) = outcome.broken {
            wrong.push((seed, broken));
            if !cli.keep_going {
                break;
            }
        }
        if ran % 64 == 0 {
            bar.set_position(ran);
            let faults = FAULTS.iter().filter_map(|fault| counts.get(fault));
            bar.set_message(format!(
                "{} faults, {} wrong",
                faults.sum::<u64>(),
                wrong.len()
            ));
            let late = cli
                .seconds
                .is_some_and(|most| begun.elapsed() >= Duration::from_secs(most));
            if late || over.load(Ordering::Relaxed) {
                break;
            }
        }
    }
    bar.finish_and_clear();
    let seconds = begun.elapsed().as_secs_f64();
    let faults: u64 = FAULTS.iter().filter_map(|fault| counts.get(fault)).sum();
    if cli.json {
        let wrong: Vec<_> = wrong
            .iter()
            .map(|(seed, what)| json!({"seed": seed, "what": what}))
            .collect();
        println!(
            "{}",
            json!({
                "scenarios": ran, "first": cli.first, "seconds": seconds,
                "per_second": ran as f64 / seconds, "faults": faults, "counts": counts,
                "wrong": wrong,
            })
        );
    } else {
        println!(
            "{ran} scenarios in {seconds:.1} s ({:.0} a second), {faults} faults injected, {} wrong",
            ran as f64 / seconds,
            wrong.len()
        );
        for (what, times) in &counts {
            println!("{times:>12} {what}");
        }
        for (seed, what) in &wrong {
            println!("seed {seed}: {what}");
        }
    }
    match wrong.first() {
        None => ExitCode::SUCCESS,
        Some((seed, _)) if !cli.json && !cli.keep_going => tell(cli, ground, *seed, mutant),
        Some(_) => ExitCode::FAILURE,
    }
}

/// What of the counts was done to the stacks.
const FAULTS: [&str; 9] = [
    "processes killed",
    "lost journals",
    "freezes",
    "cuts",
    "full disks",
    "slow disks",
    "robot faults",
    "messages lost",
    "messages twice",
];

/// For each mutant the first seed that catches it.
fn hunt(cli: &Cli, ground: &Ground) -> ExitCode {
    let mut alive = 0;
    for mutant in MUTANTS {
        let seeds = cli.first..cli.first.saturating_add(cli.seeds);
        let caught = seeds.clone().find_map(|seed| {
            let outcome = run_safely(ground, &Scenario::of(seed), Some(mutant), false);
            Some((seed, outcome.broken?))
        });
        match caught {
            Some((seed, broken)) => {
                let broken: String = broken.chars().take(200).collect();
                println!(
                    "[[mutant]]\nname = \"{mutant}\"\nseed = {seed}\ncaught_by = {broken:?}\n"
                );
            }
            None => {
                alive += 1;
                println!("# {mutant} is not caught by seeds {seeds:?}\n");
            }
        }
    }
    if alive == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
