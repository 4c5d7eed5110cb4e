//! Runs a vehicle of a restaurant: `vehicle --help` says with what.

use std::process::ExitCode;

use clap::Parser;
use vehicle::program::{VehicleArgs, run};

/// A vehicle of a restaurant. It ends on Ctrl-C.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(flatten)]
    args: VehicleArgs,
}

fn main() -> ExitCode {
    agent_link::run_role(run(Cli::parse().args))
}
