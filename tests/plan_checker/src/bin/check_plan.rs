//! `check_plan DOMAIN PROBLEM PLAN`: says whether a plan is right; exits with 0 if it is, with 1
//! if it is not, and with 2 if that cannot be told.
#![expect(clippy::print_stdout, reason = "the verdict is what it is for")]
#![expect(clippy::print_stderr, reason = "so that errors do not mix with it")]

use std::process::ExitCode;

use plan_checker::{Kind, check, check_sequence};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (judge, files): (fn(&str, &str, &str) -> _, _) = match arguments.as_slice() {
        ["--actions-only", files @ ..] => (check_sequence, files),
        files => (check, files),
    };
    let [domain, problem, plan] = files else {
        eprintln!("usage: check_plan [--actions-only] DOMAIN PROBLEM PLAN");
        return ExitCode::from(2);
    };
    let read = |file: &str| {
        std::fs::read_to_string(file).map_err(|error| eprintln!("cannot read {file}: {error}"))
    };
    let (Ok(domain), Ok(problem), Ok(plan)) = (read(domain), read(problem), read(plan)) else {
        return ExitCode::from(2);
    };
    match judge(&domain, &problem, &plan) {
        Ok(report) => {
            println!(
                "right: {} actions, {} decompositions, cost {}",
                report.actions, report.decompositions, report.cost
            );
            ExitCode::SUCCESS
        }
        Err(faults) => {
            let unjudgeable = faults.iter().any(|fault| fault.kind == Kind::Unjudgeable);
            for fault in &faults {
                println!("{fault}");
            }
            ExitCode::from(if unjudgeable { 2 } else { 1 })
        }
    }
}
