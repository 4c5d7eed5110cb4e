//! Runs a planner on a folder of benchmark domains, checks every plan, and compares with what
//! other planners did.
//!
//! `cargo run --release -p plan_checker --bin bench_plans -- FOLDER --peers TSV`
#![expect(clippy::print_stdout, reason = "the tables are what it is for")]
#![expect(clippy::print_stderr, reason = "progress does not mix with them")]

mod instances;
mod outcome;
mod peers;
mod run;
mod summary;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;

use clap::Parser;

use instances::Instance;
use outcome::{Outcome, judged};
use peers::Peers;
use run::{Limits, Planner, RUNNER};

/// Runs a planner on a folder of benchmark domains and checks every plan.
///
/// Each folder inside FOLDER is a domain: `domain.hddl` and problems, or for each problem
/// `X.hddl` its own `X-domain.hddl`. Exits with 1 if a plan is wrong, or if a problem is called
/// unsolvable that another planner solved.
#[derive(Debug, Parser)]
struct Cli {
    /// Folder with one folder for each domain.
    folder: PathBuf,
    /// Command of the planner. `{domain}`, `{problem}`, `{out}` (file for the plan) and `{limit}`
    /// (seconds) are filled in. Default: `intermezzo plan` beside this program.
    #[arg(long, value_name = "COMMAND")]
    planner: Option<String>,
    /// What other planners did, as tab-separated columns: planner, domain, instance, status (`ok`
    /// if solved), `wall_s`, `cpu_s`, `plan_len`.
    #[arg(long, value_name = "TSV")]
    peers: Option<PathBuf>,
    /// The planner among the peers whose times are compared with.
    #[arg(long, default_value = "hypertension", value_name = "NAME")]
    reference: String,
    /// Seconds for each instance.
    #[arg(long, default_value_t = 60.0, value_name = "S")]
    time_limit: f64,
    /// Memory for each instance, in GiB of address space.
    #[arg(long, default_value_t = 8.0, value_name = "GIB")]
    memory_gib: f64,
    /// Only instances with this in `DOMAIN/INSTANCE`.
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Also write the table as CSV.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Keep the plans in this folder.
    #[arg(long, value_name = "FOLDER")]
    plans: Option<PathBuf>,
    /// How many instances to run at a time; more than one makes times worse than they are.
    #[arg(long, default_value_t = 1, value_name = "N")]
    jobs: usize,
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    if arguments.next().as_deref() == Some(RUNNER) {
        return run::run(&arguments.collect::<Vec<_>>());
    }
    match bench(&Cli::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Whether all that the planner said is right.
fn bench(cli: &Cli) -> Result<bool, String> {
    let peers = match &cli.peers {
        Some(file) => Peers::read(file)?,
        None => Peers::default(),
    };
    let mut instances = instances::find(&cli.folder)?;
    if let Some(only) = &cli.only {
        instances.retain(|instance| instance.name().contains(only));
    }
    if instances.is_empty() {
        return Err(format!("no instances in {}", cli.folder.display()));
    }
    let (folder, temporary) = match &cli.plans {
        Some(folder) => (folder.clone(), false),
        None => {
            let name = format!("bench_plans_{}", std::process::id());
            (std::env::temp_dir().join(name), true)
        }
    };
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let planner = Planner::new(cli.planner.as_deref())?;
    let limits = Limits {
        seconds: cli.time_limit,
        memory: (cli.memory_gib * f64::from(1 << 30)) as u64,
    };
    let queue = Mutex::new(instances.iter().enumerate());
    let outcomes = Mutex::new(vec![None; instances.len()]);
    std::thread::scope(|scope| {
        for _ in 0..cli.jobs.max(1) {
            scope.spawn(|| {
                // Locked only to take the next one.
                while let Some((index, instance)) = next(&queue) {
                    let plan = folder.join(instance.name().replace('/', "--") + ".plan");
                    let outcome = judged(&planner, instance, &plan, &limits, &peers);
                    if temporary {
                        // It may not be there.
                        let _ = fs::remove_file(&plan);
                    }
                    let number = index + 1;
                    let line = outcome.line();
                    eprintln!(
                        "[{number:3}/{}] {} {line}",
                        instances.len(),
                        instance.name()
                    );
                    if let Ok(mut outcomes) = outcomes.lock() {
                        outcomes[index] = Some(outcome);
                    }
                }
            });
        }
    });
    if temporary {
        // A folder left behind in the system's place for such is no failure.
        let _ = fs::remove_dir_all(&folder);
    }
    let outcomes = outcomes.into_inner().map_err(|error| error.to_string())?;
    let rows: Vec<(&Instance, Outcome)> = (instances.iter().zip(outcomes))
        .filter_map(|(instance, outcome)| Some((instance, outcome?)))
        .collect();
    print!("{}", summary::table(&rows, &peers, &cli.reference));
    print!(
        "{}",
        summary::summary(&rows, &peers, &cli.reference, &limits)
    );
    if let Some(out) = &cli.out {
        write(out, &summary::csv(&rows))?;
    }
    Ok(rows.iter().all(|(_, outcome)| !outcome.is_wrong()))
}

fn next<'a, T>(queue: &Mutex<impl Iterator<Item = T> + 'a>) -> Option<T> {
    queue.lock().ok()?.next()
}

fn write(file: &Path, text: &str) -> Result<(), String> {
    fs::write(file, text).map_err(|error| format!("{}: {error}", file.display()))
}
