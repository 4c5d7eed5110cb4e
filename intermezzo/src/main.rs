//! The command that users type: `intermezzo --help` says what there is.

use std::process::ExitCode;

use clap::Parser;
use intermezzo::{Cli, Failure, run};

fn main() -> ExitCode {
    let cli = Cli::parse();
    agent_link::log_to_stderr();
    let result = match agent_link::runtime() {
        Ok(runtime) => runtime.block_on(run(cli)),
        Err(error) => Err(Failure::failed(format_args!("cannot start: {error}"))),
    };
    match result {
        Ok(exit) => exit.into(),
        Err(failure) => {
            failure.print();
            failure.exit.into()
        }
    }
}
