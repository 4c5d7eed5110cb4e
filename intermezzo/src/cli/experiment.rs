//! What can be measured.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Subcommand};

#[derive(Debug, Subcommand)]
pub(crate) enum ExperimentCommand {
    /// The paper's Tables 1 to 3: how long it takes to go on with what was interrupted, online and naive.
    Replanning(ReplanningArgs),
    /// The same on made-up museums of up to 100,000 nodes, with doors that close, and the memory that it takes.
    Scaling(ScalingArgs),
    /// How long it takes from the word "emergency" until the wheels are braked, with all processes of a robot.
    Latency(LatencyArgs),
    /// A restaurant: how long guests wait when several goals are worked on together, by vehicles that help each other.
    Restaurant(RestaurantArgs),
    /// Many robots at once: how often they can be interrupted, how fast they stop, what each of them costs.
    Fleet(FleetArgs),
}

impl ExperimentCommand {
    pub(crate) fn report_options(&self) -> &ReportOptions {
        match self {
            Self::Replanning(args) => &args.report,
            Self::Scaling(args) => &args.report,
            Self::Latency(args) => &args.report,
            Self::Restaurant(args) => &args.report,
            Self::Fleet(args) => &args.report,
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

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The paper's kinds of interruptions (in the same area, on the route, off it, there and back) and a door that closes on the
suspended route or elsewhere, on made-up museums of growing size, online and naive in turns; and the memory of a process of its
own for each size and planner.

Examples:
  intermezzo experiment scaling --quick
  intermezzo experiment scaling --nodes 40,4000 --out results

Exit status: 0 measured; 1 a museum cannot be made; 2 the folder cannot be written;
130 ended by Ctrl-C, and what there was until then is reported.")]
pub(crate) struct ScalingArgs {
    /// How many nodes the museums have.
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_values_t = experiments::SIZES, value_parser = clap::value_parser!(u32).range(40..=i64::from(maps::MOST_NODES)))]
    pub(crate) nodes: Vec<u32>,
    /// How often each interruption is measured, by each planner, unless that takes too long.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) repetitions: u32,
    /// Only museums of 40 and 400 nodes, three times each.
    #[arg(long, conflicts_with_all = ["nodes", "repetitions"])]
    pub(crate) quick: bool,
    /// Print the memory that this process takes for one interruption with this planner, and end.
    #[arg(long, value_name = "PLANNER", hide = true)]
    pub(crate) memory_of: Option<String>,
    #[command(flatten)]
    pub(crate) report: ReportOptions,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
A robot of four processes and a router, as `up` starts it, drives through the museum, with its journals. Another client
puts an emergency while it drives, again and again. What is measured, by one clock, is the time
  put_to_braking         until the controller tells its motors to brake
  put_to_motors          until the body brakes
  put_to_seen            until the client has seen that
  braking_to_still       from there to standstill: the robot's physics, in time of the world
  still_to_first_action  until the first action of the emergency's plan begins
  end_to_resumed         from the emergency's end until the interrupted goal goes on
and, between the interruptions, a bare round trip from client to router to client. Then the same again in a made-up museum,
with emergencies for which a large plan has to be made.

Examples:
  intermezzo experiment latency
  intermezzo experiment latency --interruptions 100 --nodes 4000 --out results

Exit status: 0 measured; 1 a robot did not do as it should; 2 the folder cannot be written; 130 ended by Ctrl-C, and what
there was until then is reported.")]
pub(crate) struct LatencyArgs {
    /// How often the robot is interrupted under each condition.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) interruptions: u32,
    /// How many nodes the museum has in which large plans are made.
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(1..=i64::from(maps::MOST_NODES)))]
    pub(crate) nodes: u32,
    /// How many seconds of the world pass in one.
    #[arg(long, value_name = "X", default_value_t = 20.0, value_parser = super::speed)]
    pub(crate) speed: f64,
    /// The same seed makes the same tours, emergencies and moments.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Where the journals are kept. Without it, in a temporary directory.
    #[arg(long, value_name = "DIR")]
    pub(crate) state: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) report: ReportOptions,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Each fleet tours the museum, and each of its robots is interrupted at random. The parents of all are in one process, the
children in another, controllers and worlds in a third; the router and whoever interrupts are in this one. There are no
journals.

Examples:
  intermezzo experiment fleet
  intermezzo experiment fleet --robots 1,20 --seconds 10 --out results

Exit status: 0 measured; 1 a fleet did not come up or a robot did not do as it should; 2 the folder cannot be written; 130
ended by Ctrl-C, and what there was until then is reported.")]
pub(crate) struct FleetArgs {
    /// How many robots, one fleet after the other.
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1, 10, 100, 1000], value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) robots: Vec<u32>,
    /// How long each fleet is interrupted.
    #[arg(long, value_name = "S", default_value = "30", value_parser = super::seconds)]
    pub(crate) seconds: Duration,
    /// How many seconds there are between two interruptions of a robot, on average.
    #[arg(long, value_name = "S", default_value = "10", value_parser = super::seconds)]
    pub(crate) every: Duration,
    /// How many seconds of the world pass in one.
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = super::speed)]
    pub(crate) speed: f64,
    /// The same seed makes the same tours and moments.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) report: ReportOptions,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Two guests served in the second paper's two cases: by vehicles in a network, several goals together, and by one alone, one goal
after the other. Then both again with every duration varied by 15 per cent, and evenings of more guests and more carriers.
Vehicles and room run in this process, in virtual time.

Examples:
  intermezzo experiment restaurant
  intermezzo experiment restaurant --quick
  intermezzo experiment restaurant --guests 10,30 --carriers 1,2 --out results

Exit status: 0 measured; 1 somebody was not served; 2 the folder cannot be written;
130 ended by Ctrl-C, and what there was until then is reported.")]
pub(crate) struct RestaurantArgs {
    /// How often both cases are run with durations varied.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) runs: u32,
    /// How many guests an evening has, one evening after the other.
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_values_t = [2, 5, 10, 20, 50], value_parser = clap::value_parser!(u32).range(1..=500))]
    pub(crate) guests: Vec<u32>,
    /// How many carriers serve them, beside a watcher and a waiter.
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_values_t = [1, 2, 3, 4, 5], value_parser = clap::value_parser!(u32).range(1..=20))]
    pub(crate) carriers: Vec<u32>,
    /// How many evenings of each kind.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) evenings: u32,
    /// The same seed has the same guests and durations.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Only ten runs, and evenings of two and five guests with one carrier and two.
    #[arg(long, conflicts_with_all = ["runs", "guests", "carriers", "evenings"])]
    pub(crate) quick: bool,
    #[command(flatten)]
    pub(crate) report: ReportOptions,
}
