//! What can be measured.

use std::path::PathBuf;

use clap::{Args, Subcommand};

#[derive(Debug, Subcommand)]
pub(crate) enum ExperimentCommand {
    /// The paper's Tables 1 to 3: how long it takes to go on with what was interrupted, online and naive.
    Replanning(ReplanningArgs),
}

impl ExperimentCommand {
    pub(crate) fn report_options(&self) -> &ReportOptions {
        match self {
            Self::Replanning(args) => &args.report,
        }
    }
}

/// What becomes of a report.
#[derive(Args, Clone, Debug)]
pub(crate) struct ReportOptions {
    /// Write everything to this folder too: tables as CSV, the whole as JSON and Markdown, pictures as SVG.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print the report as one JSON object.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Six drives through the museum, each interrupted by an emergency, as in the paper's Tables 1, 2 and 3. What is measured is the
time until the suspended plan goes on, in the parent, the child and both, by the incremental planner (online) and by the one
that plans from scratch (naive), in turns. The whole stack runs in this process, in virtual time.

Examples:
  intermezzo experiment replanning
  intermezzo experiment replanning --repetitions 1000 --out results

Exit status: 0 measured; 1 a drive went otherwise than in the paper; 2 the folder cannot be written;
130 ended by Ctrl-C, and what there was until then is reported.")]
pub(crate) struct ReplanningArgs {
    /// How often each drive is measured, by each planner.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) repetitions: u32,
    #[command(flatten)]
    pub(crate) report: ReportOptions,
}
