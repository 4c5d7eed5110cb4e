//! Runs scenarios by the million, and tells the story of the first that goes wrong.
#![expect(clippy::print_stdout, reason = "it is what the program is for")]

use std::collections::BTreeMap;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use intermezzo_simulator::counts::Counts;
use intermezzo_simulator::fleet::Fleet;
use intermezzo_simulator::ground::Ground;
use intermezzo_simulator::mutant::{MUTANTS, Mutant};
use intermezzo_simulator::shrink::{keep_panics, run_safely, shrink};
use serde_json::json;

/// A scenario is hundreds of thousands of small things made and dropped.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

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
    /// Only scenarios of several robots; otherwise one in eight is.
    #[arg(long)]
    several: bool,
    /// A summary in JSON.
    #[arg(long)]
    json: bool,
}

impl Cli {
    fn fleet(&self, seed: u64) -> Fleet {
        if self.several {
            Fleet::of(seed)
        } else {
            Fleet::at(seed)
        }
    }
}

/// For how long this thread, which does all the work, has had a processor, where that can be known.
/// The time of the day says little on a machine that has other things to do.
fn processor_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = stat.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds / 1e9)
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
    let mut fleet = cli.fleet(seed);
    let outcome = run_safely(ground, &fleet, mutant, false);
    if outcome.broken.is_some() && !cli.whole {
        let many = fleet.happenings();
        fleet = shrink(ground, &fleet, mutant);
        let few = fleet.happenings();
        println!("of {many} happenings {few} are enough:");
    }
    let outcome = run_safely(ground, &fleet, mutant, true);
    println!("{fleet}");
    for line in &outcome.story {
        println!("{line}");
    }
    println!();
    for (what, times) in outcome.counts.named() {
        println!("{times:>12} {what}");
    }
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
    let mut counts = Counts::default();
    let mut wrong: Vec<(u64, String)> = Vec::new();
    let (mut ran, mut robots, mut fleets) = (0, 0, 0);
    for seed in cli.first..cli.first.saturating_add(cli.seeds) {
        let fleet = cli.fleet(seed);
        let outcome = run_safely(ground, &fleet, mutant, false);
        ran += 1;
        robots += fleet.robots.len();
        fleets += u64::from(fleet.robots.len() > 1);
        counts += &outcome.counts;
        if let Some(broken) = outcome.broken {
            wrong.push((seed, broken));
            if !cli.keep_going {
                break;
            }
        }
        if ran % 64 == 0 {
            bar.set_position(ran);
            let faults = counts.faults();
            bar.set_message(format!("{faults} faults, {} wrong", wrong.len()));
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
    let busy = processor_seconds().unwrap_or(seconds);
    let faults = counts.faults();
    if cli.json {
        let wrong: Vec<_> = wrong
            .iter()
            .map(|(seed, what)| json!({"seed": seed, "what": what}))
            .collect();
        println!(
            "{}",
            json!({
                "scenarios": ran, "of_several_robots": fleets, "robots": robots,
                "first": cli.first, "seconds": seconds, "processor_seconds": busy,
                "per_processor_second": ran as f64 / busy, "faults": faults,
                "counts": counts.named().collect::<BTreeMap<_, _>>(),
                "wrong": wrong,
            })
        );
    } else {
        println!(
            "{ran} scenarios, {fleets} of them of several robots ({robots} robots in all), in {seconds:.1} s ({:.0} a second of a processor), {faults} faults injected, {} wrong",
            ran as f64 / busy,
            wrong.len()
        );
        for (what, times) in counts.named() {
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

/// For each mutant the first seed that catches it.
fn hunt(cli: &Cli, ground: &Ground) -> ExitCode {
    let mut alive = 0;
    for mutant in MUTANTS {
        let seeds = cli.first..cli.first.saturating_add(cli.seeds);
        let caught = seeds.clone().find_map(|seed| {
            let outcome = run_safely(ground, &cli.fleet(seed), Some(mutant), false);
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
