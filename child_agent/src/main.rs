//! Runs a child agent: `child_agent --help` says with what.

use std::process::ExitCode;

use child_agent::program::{ChildArgs, run};
use clap::Parser;

/// A child agent of a robot. It ends on Ctrl-C.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(flatten)]
    args: ChildArgs,
}

fn main() -> ExitCode {
    agent_link::run_role(run(Cli::parse().args))
}
