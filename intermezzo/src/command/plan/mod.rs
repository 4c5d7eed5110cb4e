//! `plan`: from a domain and a problem to a plan, without a robot.

mod explain;
mod json;
mod output;
mod progress;

use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use agent_core::language::{LanguageError, Spelling, parse_domain, parse_problem, report};
use offline_planner::{Options, Solution, Verdict, solve};

use crate::cli::PlanArgs;
use crate::exit::{Exit, Failure};
use crate::style::{BAD, DIM, GOOD};
use output::Target;
use progress::Progress;

/// Plans, and says what came out.
pub(crate) fn run(args: &PlanArgs) -> Result<Exit, Failure> {
    let begin = Instant::now();
    let target = args.output.as_deref().map(Target::new).transpose()?;
    let domain_text = read(&args.domain)?;
    let problem_text = read(&args.problem)?;
    let domain =
        parse_domain(&domain_text).map_err(|errors| faults(&args.domain, &domain_text, &errors))?;
    let problem = parse_problem(&problem_text, &domain)
        .map_err(|errors| faults(&args.problem, &problem_text, &errors))?;
    let options = Options {
        time_limit: args.time_limit,
        optimal: args.optimal,
        ..Options::default()
    };
    let stop = stop_at_ctrl_c()?;
    let mut progress = Progress::new();
    let verdict = solve(&domain, &problem, &options, &stop, &mut |now| {
        progress.show(now);
    });
    progress.end();
    let verdict = verdict.map_err(Failure::bad_input)?;
    let seconds = begin.elapsed().as_secs_f64();
    match verdict {
        Verdict::Plan(mut solution) => {
            if [&domain_text, &problem_text]
                .into_iter()
                .any(|text| has_upper_case(text))
            {
                solution.spell(&Spelling::of(&[&domain_text, &problem_text]));
            }
            hand_over(args, target, &solution, seconds)?;
            tell(args, &solution, seconds);
            Ok(Exit::Done)
        }
        Verdict::Unsolvable(why) => {
            without_a_plan(args, ("unsolvable", why), seconds)?;
            anstream::eprintln!("{BAD}unsolvable:{BAD:#} {why} {DIM}({seconds:.2} s){DIM:#}");
            Ok(Exit::Unsolvable)
        }
        Verdict::Unknown(why) => {
            let why = if stop.load(Ordering::Relaxed) {
                "stopped by Ctrl-C"
            } else {
                why
            };
            without_a_plan(args, ("unknown", why), seconds)?;
            anstream::eprintln!("{BAD}no plan found:{BAD:#} {why} {DIM}({seconds:.2} s){DIM:#}");
            Ok(Exit::Unknown)
        }
    }
}

fn read(file: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(file).map_err(|error| {
        Failure::bad_input(format_args!("cannot read {}: {error}", file.display()))
            .advice("name a domain and a problem: intermezzo plan domain.hddl problem.hddl")
    })
}

fn faults(file: &Path, text: &str, errors: &[LanguageError]) -> Failure {
    let plural = if errors.len() == 1 { "" } else { "s" };
    let report = report(&file.display().to_string(), text, errors);
    Failure::bad_input(format_args!("{} fault{plural}\n{report}", errors.len()))
}

/// Names are printed as they are written, and only lower case is what the planner keeps anyway.
fn has_upper_case(text: &str) -> bool {
    text.chars().any(char::is_uppercase)
}

/// The first Ctrl-C asks the planner to stop, the second ends the process.
pub(crate) fn stop_at_ctrl_c() -> Result<Arc<AtomicBool>, Failure> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let stop = Arc::new(AtomicBool::new(false));
    let register = |signal| -> io::Result<()> {
        // In this order, or the first one would end it.
        signal_hook::flag::register_conditional_default(signal, Arc::clone(&stop))?;
        signal_hook::flag::register(signal, Arc::clone(&stop))?;
        Ok(())
    };
    register(SIGINT)
        .and_then(|()| register(SIGTERM))
        .map_err(|error| Failure::failed(format_args!("cannot listen for Ctrl-C: {error}")))?;
    Ok(stop)
}

/// Writes the plan where it is wanted: to the file, and what is to be seen to the standard output.
fn hand_over(
    args: &PlanArgs,
    target: Option<Target>,
    solution: &Solution,
    seconds: f64,
) -> Result<(), Failure> {
    let in_file = target.is_some();
    if let Some(target) = target {
        target.write(|out| solution.write(out))?;
    }
    if args.json {
        output::print(|out| json::plan(out, solution, seconds))
    } else if let Some(depth) = args.explain {
        output::print(|out| explain::tree(out, solution, depth))
    } else if in_file {
        Ok(())
    } else {
        output::print(|out| solution.write(out))
    }
}

/// With `--json`, programs are told on the standard output that there is no plan.
fn without_a_plan(
    args: &PlanArgs,
    (verdict, why): (&str, &str),
    seconds: f64,
) -> Result<(), Failure> {
    if args.json {
        output::print(|out| json::no_plan(out, verdict, why, seconds))
    } else {
        Ok(())
    }
}

fn tell(args: &PlanArgs, solution: &Solution, seconds: f64) {
    let length = solution.length();
    let plural = if length == 1 { "" } else { "s" };
    let proof = match (args.optimal, solution.optimal) {
        (_, true) => ", and none is cheaper",
        (true, false) => ", not proved to be the cheapest",
        (false, false) => "",
    };
    let cost = cost(solution);
    let file = args
        .output
        .as_ref()
        .map(|file| format!(", in {}", file.display()));
    let file = file.unwrap_or_default();
    anstream::eprintln!(
        "{GOOD}plan:{GOOD:#} {length} action{plural}, cost {cost}{proof}{file} {DIM}({seconds:.2} s){DIM:#}"
    );
}

/// Without decimals where there are none.
fn cost(solution: &Solution) -> f64 {
    solution.cost().units()
}
