//! Runs a parent agent: `parent_agent --help` says with what.

use std::process::ExitCode;

use clap::Parser;
use parent_agent::program::{ParentArgs, run};

/// A parent agent of a robot. It ends on Ctrl-C.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(flatten)]
    args: ParentArgs,
}

fn main() -> ExitCode {
    agent_link::run_role(run(Cli::parse().args))
}
