//! `experiment`: measures something, and reports it.

mod progress;
mod restaurant;
mod scaling;

use std::io::{self, Write};

use experiments::{ExperimentError, Report};

use crate::cli::{ExperimentCommand, ReportOptions};
use crate::exit::{Exit, Failure};
use crate::experiment::fleet::Fleet;
use crate::experiment::latency::Latency;
use crate::style::{ADVICE, BAD};
pub(crate) use progress::Progress;

/// Measures what needs neither processes nor a network; `None` if it is something else.
pub(crate) fn run_alone(what: &ExperimentCommand) -> Option<Result<Exit, Failure>> {
    let measure = |measure: &dyn Fn(&mut Progress) -> Result<Report, ExperimentError>| {
        let mut progress = begin(what.report_options())?;
        let report = measure(&mut progress);
        end(what.report_options(), progress, report)
    };
    match what {
        ExperimentCommand::Replanning(args) => Some(measure(&|progress| {
            experiments::replanning(args.repetitions, progress)
        })),
        ExperimentCommand::Scaling(args) => Some(match &args.memory_of {
            Some(planner) => scaling::memory(args, planner),
            None => measure(&|progress| scaling::run(args, progress)),
        }),
        ExperimentCommand::Restaurant(args) => {
            Some(measure(&|progress| restaurant::run(args, progress)))
        }
        ExperimentCommand::Latency(_) | ExperimentCommand::Fleet(_) => None,
    }
}

/// Measures with robots that run, each of several processes.
pub(crate) async fn run(what: ExperimentCommand) -> Result<Exit, Failure> {
    if let Some(result) = run_alone(&what) {
        return result;
    }
    let mut progress = begin(what.report_options())?;
    let stopped = progress.stopped();
    let report = match &what {
        ExperimentCommand::Latency(args) => Latency::of(args).run(&mut progress, stopped).await,
        ExperimentCommand::Fleet(args) => Fleet::of(args).run(&mut progress, stopped).await,
        ExperimentCommand::Replanning(_)
        | ExperimentCommand::Scaling(_)
        | ExperimentCommand::Restaurant(_) => Err(Failure::failed("it needs no robot")),
    };
    match report {
        Ok(report) => end(what.report_options(), progress, Ok::<_, String>(report)),
        Err(failure) => {
            progress.end();
            Err(failure)
        }
    }
}

/// To be called before anything is measured: finds out whether the report can be written, and listens
/// for Ctrl-C.
pub(crate) fn begin(options: &ReportOptions) -> Result<Progress, Failure> {
    if cfg!(debug_assertions) {
        anstream::eprintln!(
            "{BAD}warning:{BAD:#} this program was built without optimisation: its times say nothing\n\
             {ADVICE}  try:{ADVICE:#} cargo run --release -- experiment \u{2026}"
        );
    }
    if let Some(folder) = &options.out {
        // Not only when an hour has been spent on measuring.
        let writable = std::fs::create_dir_all(folder)
            .and_then(|()| tempfile::NamedTempFile::new_in(folder).map(drop));
        writable.map_err(|error| {
            Failure::bad_input(format_args!(
                "cannot write to {}: {error}",
                folder.display()
            ))
            .advice("name a folder that you may write to")
        })?;
    }
    Progress::new()
}

/// To be called with what was measured: takes the progress away, prints and writes the report.
pub(crate) fn end(
    options: &ReportOptions,
    progress: Progress,
    report: Result<Report, impl std::fmt::Display>,
) -> Result<Exit, Failure> {
    let stopped = progress.end();
    let mut report = report.map_err(Failure::failed)?;
    if stopped {
        report
            .remarks
            .push("Ended by Ctrl-C before all was measured.".to_owned());
    }
    if cfg!(debug_assertions) {
        report
            .remarks
            .push("Built without optimisation: the times say nothing.".to_owned());
    }
    let text = match options.json {
        true => format!("{:#}\n", report.json()),
        false => report.printed(),
    };
    match io::stdout().lock().write_all(text.as_bytes()) {
        // Whoever reads it may have seen enough: `\u{2026} | head`.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            return Err(Failure::failed(error));
        }
        _ => {}
    }
    if let Some(folder) = &options.out {
        let files = report.write(folder).map_err(Failure::bad_input)?;
        for file in files {
            anstream::eprintln!("written: {}", file.display());
        }
    }
    Ok(if stopped {
        Exit::Interrupted
    } else {
        Exit::Done
    })
}
