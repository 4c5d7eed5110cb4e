//! `experiment scaling`, and the processes whose memory it measures.

use std::process::{Command, Stdio};

use experiments::{ExperimentError, Onlooker, Report, Scaling};

use crate::cli::ScalingArgs;
use crate::exit::{Exit, Failure};

/// What `--quick` measures.
const QUICK: ([u32; 2], usize) = ([40, 400], 3);

pub(super) fn run(
    args: &ScalingArgs,
    onlooker: &mut dyn Onlooker,
) -> Result<Report, ExperimentError> {
    let what = match args.quick {
        true => Scaling {
            nodes: QUICK.0.to_vec(),
            repetitions: QUICK.1,
        },
        false => Scaling {
            nodes: args.nodes.clone(),
            repetitions: args.repetitions as usize,
        },
    };
    experiments::scaling(&what, &mut in_a_process, onlooker)
}

/// The memory of a process of its own, in bytes.
fn in_a_process(nodes: u32, planner: &str) -> Option<u64> {
    let program = std::env::current_exe().ok()?;
    let told = Command::new(program)
        .args(["experiment", "scaling", "--nodes", &nodes.to_string()])
        .args(["--memory-of", planner])
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .output()
        .ok()?;
    String::from_utf8(told.stdout).ok()?.trim().parse().ok()
}

/// Is such a process.
pub(super) fn memory(args: &ScalingArgs, planner: &str) -> Result<Exit, Failure> {
    let nodes = args.nodes.first().copied().unwrap_or(experiments::SIZES[0]);
    let bytes = experiments::memory_after_an_interruption(nodes, planner);
    anstream::println!("{}", bytes.map_err(Failure::failed)?);
    Ok(Exit::Done)
}
