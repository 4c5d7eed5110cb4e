//! The command that users type: `intermezzo --help` says what there is.

use std::process::ExitCode;

use clap::Parser;
use intermezzo::{Cli, Failure, run, run_alone};

fn main() -> ExitCode {
    let cli = Cli::parse();
    // What needs no robot is not kept waiting for what talks with robots.
    let result = match run_alone(&cli) {
        Some(result) => result,
        None => {
            agent_link::log_to_stderr();
            match agent_link::runtime() {
                Ok(runtime) => runtime.block_on(run(cli)),
                Err(error) => Err(Failure::failed(format_args!("cannot start: {error}"))),
            }
        }
    };
    match result {
        Ok(exit) => exit.into(),
        Err(failure) => {
            failure.print();
            failure.exit.into()
        }
    }
}
