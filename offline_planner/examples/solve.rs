//! Plans for one problem and says how it went: `solve DOMAIN PROBLEM [-o FILE] [--time-limit S]`.
#![expect(clippy::print_stdout, reason = "it is a command")]

use std::error::Error;
use std::fs::{self, File};
use std::io::BufWriter;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use agent_core::language::{LanguageError, parse_domain, parse_problem};
use offline_planner::{Options, Verdict, solve};

fn main() -> Result<(), Box<dyn Error>> {
    let begin = Instant::now();
    let mut files = Vec::new();
    let mut out = None;
    let mut options = Options::default();
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "-o" => out = args.next(),
            "--time-limit" => {
                let seconds: f64 = args.next().ok_or("how many seconds?")?.parse()?;
                options.time_limit = Some(Duration::from_secs_f64(seconds));
            }
            _ => files.push(arg),
        }
    }
    let [domain, problem] = &files[..] else {
        return Err("solve DOMAIN PROBLEM [-o FILE] [--time-limit S]".into());
    };
    let domain = parse_domain(&fs::read_to_string(domain)?).map_err(first)?;
    let problem = parse_problem(&fs::read_to_string(problem)?, &domain).map_err(first)?;
    let read = begin.elapsed().as_secs_f64();
    let verdict = solve(
        &domain,
        &problem,
        &options,
        &AtomicBool::new(false),
        &mut |_| {},
    )?;
    let solved = begin.elapsed().as_secs_f64();
    match verdict {
        Verdict::Plan(solution) => {
            if let Some(out) = out {
                solution.write(&mut BufWriter::new(File::create(out)?))?;
            }
            println!(
                "plan {} read {read:.3} solved {solved:.3} written {:.3}",
                solution.length(),
                begin.elapsed().as_secs_f64()
            );
        }
        Verdict::Unsolvable(why) => {
            println!("unsolvable ({why}) read {read:.3} solved {solved:.3}")
        }
        Verdict::Unknown(why) => println!("unknown ({why}) read {read:.3} solved {solved:.3}"),
    }
    Ok(())
}

fn first(errors: Vec<LanguageError>) -> String {
    errors
        .first()
        .map_or(String::new(), |error| error.to_string())
}
