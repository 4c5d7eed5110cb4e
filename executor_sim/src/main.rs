//! Runs a simulated robot's controller or its world, or a room of vehicles: `executor_sim --help` says
//! with what.

use std::process::ExitCode;

use clap::Parser;
use executor_sim::program::{ExecutorArgs, run};

/// A simulated robot: its controller, or the world that it is in; or a room with several vehicles. All
/// end on Ctrl-C.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(flatten)]
    args: ExecutorArgs,
}

fn main() -> ExitCode {
    agent_link::run_role(run(Cli::parse().args))
}
