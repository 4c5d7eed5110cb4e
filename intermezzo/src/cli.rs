//! What can be typed.

mod experiment;
mod map;
mod secure;

pub(crate) use experiment::{
    ExperimentCommand, FleetArgs, LatencyArgs, ReportOptions, RestaurantArgs, ScalingArgs,
};
pub(crate) use map::{AreasBy, FromRmfArgs, MapCommand, ScaleArgs, SvgArgs};
pub(crate) use secure::{CertsArgs, PasswordsArgs};

use std::path::PathBuf;
use std::time::Duration;

use agent_link::options::{DEFAULT_ROBOT, LimitOptions, PlannerOptions};
use clap::{Args, Parser, Subcommand};

/// Where a robot begins unless it is said.
pub(crate) const USUAL_START: &str = "n1";

/// Robots that can be interrupted: they stop in the middle of an action, do what is more urgent,
/// and take up the interrupted work where that still makes sense.
#[derive(Debug, Parser)]
#[command(
    name = "intermezzo",
    version,
    arg_required_else_help = true,
    propagate_version = true,
    after_help = "\
Begin with:
  intermezzo demo                            a tour with two emergencies, in half a minute
  intermezzo demo restaurant                 two guests, three vehicles and a spill, in a minute
  intermezzo up                              a robot in the museum, until Ctrl-C; then, elsewhere:
  intermezzo goal '(guide n40)'              give it something to do
  intermezzo goal '(go n28)' --emergency     and something more urgent
  intermezzo status                          see what it has set aside

Exit status:
  0  all went as it should
  1  a goal failed or was rejected, a role cannot be started, or a file has faults
  2  the command cannot be carried out as it was typed
  3  no robot is running, or none answers: not reachable, or you are not permitted to ask
  4  `plan`: it is proved that there is no plan
  5  `plan`: no plan was found, and there may be one
  130  `experiment`: ended by Ctrl-C; what was measured until then is reported

Goals and facts are HDDL: (go n4), (and (show n2) (show n12)), (not (open door3_5))."
)]
pub struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// A story, played by real processes: a guided tour with two emergencies, or an evening in a restaurant.
    Demo(DemoArgs),
    /// Start a robot and show what it does, until Ctrl-C.
    Up(Box<UpArgs>),
    /// Ask a robot to do something.
    Goal(GoalArgs),
    /// Set a goal aside until it is resumed.
    Suspend(CommandArgs),
    /// Let a goal that was suspended go on.
    Resume(CommandArgs),
    /// End a goal; what was half done is undone where the domain says how.
    Cancel(CommandArgs),
    /// Tell a robot what is different in the world.
    Fact(FactArgs),
    /// Open or close a door of a simulated world.
    Door(DoorArgs),
    /// What a robot is doing, has set aside, waits for and believes.
    Status(StatusArgs),
    /// What happens from now on, until Ctrl-C.
    Watch(WatchArgs),
    /// Find a plan for a problem in HDDL; no robot is needed.
    Plan(PlanArgs),
    /// Make certificates, so that a robot does what it is told by those who may.
    Certs(CertsArgs),
    /// Make passwords, to the same end, for robots that are reached from one machine only.
    Passwords(PasswordsArgs),
    /// Look after maps.
    #[command(subcommand)]
    Map(MapCommand),
    /// Look after planning domains.
    #[command(subcommand)]
    Domain(DomainCommand),
    /// Measure: replanning, how fast a robot stops, and more. No robot needs to run.
    #[command(subcommand)]
    Experiment(ExperimentCommand),
    /// One role of a robot, as `up` starts it.
    #[command(subcommand, hide = true)]
    Role(RoleCommand),
}

/// Which robot is meant.
#[derive(Args, Clone, Debug)]
pub(crate) struct Target {
    /// The robot; not needed if one is running on this machine.
    #[arg(long, value_name = "NAME", env = "INTERMEZZO_ROBOT")]
    pub(crate) robot: Option<String>,
    /// Where the robot's router listens, if that is on another machine: tcp/192.168.1.7:7447.
    #[arg(long, value_name = "ENDPOINT")]
    pub(crate) connect: Vec<String>,
    /// Zenoh settings (JSON5) for TLS and passwords.
    #[arg(long, value_name = "FILE")]
    pub(crate) zenoh_config: Option<PathBuf>,
    /// The folder that `intermezzo certs` or `intermezzo passwords` has made, or what one was given
    /// of it.
    #[arg(
        long,
        value_name = "DIR",
        env = "INTERMEZZO_SECURITY",
        conflicts_with = "zenoh_config"
    )]
    pub(crate) security: Option<PathBuf>,
    /// Who asks: that name's file in the folder is used. Without it, the operator's if it is there,
    /// else the viewer's.
    #[arg(long = "as", value_name = "NAME", env = "INTERMEZZO_USER")]
    pub(crate) user: Option<String>,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum DemoOf {
    /// Four processes: world, controller, child and parent.
    Museum,
    /// Four processes: the room, a watcher, a waiter and a carrier.
    Restaurant,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The story: a robot guides a visitor from the entrance (n1) to the main hall (n40). In the middle of
a corridor somebody needs the toilet, and on the way there a child feels ill. While the tour waits, a
door on its way closes. The robot comes back to the tour with another plan, and arrives.

In the restaurant one vehicle sees who comes in, one takes orders, and one serves. Two guests at two tables
order, and are served in one round. While the first drink is being taken from the tray, somebody knocks over
a vase: that is wiped up first.

They are the scenario files demo.toml and restaurant.toml in intermezzo/scenarios, which `intermezzo up --scenario` reads too.

Examples:
  intermezzo demo restaurant    three vehicles, side by side: a minute
  intermezzo demo --speed 5     slower, to watch the robot stop and turn
  intermezzo demo --json        one event a line, for programs")]
pub(crate) struct DemoArgs {
    /// A guided tour with two emergencies, or two guests in a restaurant with three vehicles and a spill.
    #[arg(value_enum, value_name = "WHAT", default_value_t = DemoOf::Museum)]
    pub(crate) what: DemoOf,
    /// How many seconds of the world pass in one.
    #[arg(long, value_name = "X", default_value_t = 8.0, value_parser = speed)]
    pub(crate) speed: f64,
    #[command(flatten)]
    pub(crate) planner: PlannerOptions,
    /// One JSON object a line instead of the timeline.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  intermezzo up                                     the museum, in real time
  intermezzo up --speed 10 --start n40              ten times as fast, from the main hall
  intermezzo up my/place --robot anna               a place of one's own, a robot of that name
  intermezzo up maps/restaurant --speed 5           a room and its vehicles, as room.toml says
  intermezzo up --state robot-state                 keep goals and places there: go on where it was
  intermezzo up --scenario story.toml --until-done  play a story, then end

A role that dies or hangs is started again; `intermezzo status` shows it.

A scenario is TOML, one event after the other:
  [[event]]
  at_s = 2.0                  # seconds after the robot is ready, or
  while_on = \"arc5\"           # when the robot is well on that arc; or at once, or, of a team,
                              # while_doing = \"k3 grasp\" or once = \"(served ann cola)\"
  say = \"Somebody is in need.\"
  emergency = \"(go n28)\"      # or goal = …; with id, priority, deadline_s, and to = \"k3\"
                              # or door = \"door4_6\" and state = \"closed\"
                              # or fact = \"(not (open door4_6))\"
                              # or suspend, resume, cancel = \"tour\"

Exit status: 0 after Ctrl-C; with --until-done, 0 if all goals of the scenario succeeded, else 1;
1 if a role ends whenever it is started; 2 if the place or the scenario is not in order.")]
pub(crate) struct UpArgs {
    /// A folder with map, domains and execution models, or `museum` or `restaurant`, which are built in.
    #[arg(value_name = "PLACE", default_value = "museum")]
    pub(crate) place: PathBuf,
    /// The robot's name. Two robots of different names can run side by side.
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT, env = "INTERMEZZO_ROBOT")]
    pub(crate) robot: String,
    /// The node where the robot stands at first. In a restaurant room.toml says that of each vehicle.
    #[arg(long, value_name = "NODE", default_value = USUAL_START)]
    pub(crate) start: String,
    /// How many seconds of the world pass in one.
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = speed)]
    pub(crate) speed: f64,
    /// Play a story.
    #[arg(long, value_name = "FILE")]
    pub(crate) scenario: Option<PathBuf>,
    /// End when all goals of the scenario have ended.
    #[arg(long, requires = "scenario")]
    pub(crate) until_done: bool,
    #[command(flatten)]
    pub(crate) planner: PlannerOptions,
    /// Where the roles keep their journals: the next `up` with the same goes on where this one was.
    /// Without it, in a temporary directory that is removed at the end, or by the next one.
    #[arg(long, value_name = "DIR")]
    pub(crate) state: Option<PathBuf>,
    /// Start no world: it runs elsewhere, as motors and sensors of a real robot do.
    #[arg(long)]
    pub(crate) no_world: bool,
    /// Kill a role that has not answered for so many seconds, and start it again.
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = at_least_a_second)]
    pub(crate) hang_limit: Duration,
    #[command(flatten)]
    pub(crate) limits: LimitOptions,
    /// In a restaurant: so many goals each vehicle works on at once; 1 is one after another.
    #[arg(long, value_name = "N")]
    pub(crate) together: Option<std::num::NonZeroUsize>,
    /// Have some actions fail, stop late, refuse to stop or be slow: which ones, this seed decides.
    #[arg(long, value_name = "SEED")]
    pub(crate) faults: Option<u64>,
    /// Where to listen, such as tcp/0.0.0.0:7447 for other machines. Without it, on a free port
    /// that only this machine can reach.
    #[arg(long, value_name = "ENDPOINT")]
    pub(crate) listen: Vec<String>,
    /// Use the zenoh router there instead of one in this process.
    #[arg(long, value_name = "ENDPOINT", conflicts_with = "listen")]
    pub(crate) connect: Vec<String>,
    /// Zenoh settings (JSON5) for TLS, passwords, access control.
    #[arg(long, value_name = "FILE")]
    pub(crate) zenoh_config: Option<PathBuf>,
    /// Lock the doors: the folder that `intermezzo certs` or `intermezzo passwords` has made. The
    /// router and every role take their own file from it.
    #[arg(
        long,
        value_name = "DIR",
        env = "INTERMEZZO_SECURITY",
        conflicts_with = "zenoh_config"
    )]
    pub(crate) security: Option<PathBuf>,
    /// One JSON object a line instead of the timeline.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  intermezzo goal '(go n40)'
  intermezzo goal '(and (show n2) (show n12))' --id morning --wait
  intermezzo goal '(go n28)' --emergency --priority 5 --deadline 120
  intermezzo goal '(serve cola ann)'                               in a restaurant: for whoever can do it
  intermezzo goal '(clean table3)' --emergency --vehicle k3        … and for one vehicle

Exit status: 0 accepted, with --wait: reached; 1 rejected or failed; 2 not a goal; 3 no robot, or with
--wait: none for as long as --patience says.")]
pub(crate) struct GoalArgs {
    /// One task, or several to be done in this order.
    #[arg(value_name = "TASK")]
    pub(crate) task: String,
    /// Interrupt what is going on; otherwise the goal waits for its turn.
    #[arg(long, short)]
    pub(crate) emergency: bool,
    /// Higher goes first among goals of the same urgency.
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    pub(crate) priority: i32,
    /// After this many seconds of the world the goal has failed.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(crate) deadline: Option<f64>,
    /// A name for it, for suspend, resume and cancel. Without one the robot makes one.
    #[arg(long, value_name = "ID")]
    pub(crate) id: Option<String>,
    /// Return when the goal has ended.
    #[arg(long, short)]
    pub(crate) wait: bool,
    /// In a restaurant: which vehicle is to do it. Without, whoever can do it best.
    #[arg(long, value_name = "NAME")]
    pub(crate) vehicle: Option<String>,
    /// With --wait: for how many seconds to wait for a robot that is down.
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = seconds)]
    pub(crate) patience: Duration,
    /// Answer with JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args, Clone, Debug)]
pub(crate) struct CommandArgs {
    /// The goal's name, as `intermezzo goal` has answered and `intermezzo status` shows.
    pub(crate) goal: String,
    /// In a restaurant: the vehicle that the goal was given to, if it was given to one in particular.
    #[arg(long, value_name = "NAME")]
    pub(crate) vehicle: Option<String>,
    /// Answer with JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  intermezzo fact '(not (open door3_5))'
  intermezzo fact '(= (length arc5) 9)'
  intermezzo fact '(seated ann table1)'        in a restaurant")]
pub(crate) struct FactArgs {
    /// What holds now, or `(not …)` for what no longer does.
    #[arg(value_name = "FACT")]
    pub(crate) fact: String,
    /// Answer with JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "Example: intermezzo door door3_5 closed")]
pub(crate) struct DoorArgs {
    /// The door's name on the map.
    pub(crate) door: String,
    /// How it is to be.
    #[arg(value_enum)]
    pub(crate) state: DoorState,
    /// Answer with JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) target: Target,
}

/// How a door can be.
#[derive(Clone, Copy, Debug, Eq, PartialEq, clap::ValueEnum)]
pub(crate) enum DoorState {
    Open,
    Closed,
}

#[derive(Args, Clone, Debug)]
pub(crate) struct StatusArgs {
    /// Show the plans for every goal: what each costs and hangs on, why one is followed, and what it
    /// would take for a better one.
    #[arg(long)]
    pub(crate) plans: bool,
    /// Answer with JSON: status, stack, plans and belief of every agent; with --plans, alternatives.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args, Clone, Debug)]
pub(crate) struct WatchArgs {
    /// One event a line, as a flat JSON object.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  intermezzo plan domain.hddl problem.hddl                   the plan, in the format of the IPC 2020
  intermezzo plan domain.hddl problem.hddl --explain         what each step is for, as a tree
  intermezzo plan domain.hddl problem.hddl --optimal --time-limit 60 -o problem.plan

The plan goes to the standard output or to FILE, which is written whole or not at all; how planning
goes is told on the standard error. Ctrl-C ends it; with --optimal the best plan so far is kept.

Exit status: 0 there is a plan; 4 it is proved that there is none; 5 none was found within the time
limit or the memory, or before Ctrl-C; 2 the files are not in order, or FILE cannot be written;
1 writing failed halfway.")]
pub(crate) struct PlanArgs {
    /// The domain.
    #[arg(value_name = "DOMAIN")]
    pub(crate) domain: PathBuf,
    /// The problem: objects, tasks, and what holds at first.
    #[arg(value_name = "PROBLEM")]
    pub(crate) problem: PathBuf,
    /// Where to write the plan. Without it the plan is printed.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Go on until no plan can be cheaper, and say of better plans as they are found.
    #[arg(long)]
    pub(crate) optimal: bool,
    /// Give up after so many seconds. With --optimal the best plan so far counts.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub(crate) time_limit: Option<Duration>,
    /// Print one JSON object with verdict, numbers, actions and decompositions instead of the plan.
    #[arg(long, conflicts_with = "explain")]
    pub(crate) json: bool,
    /// Print the plan as a tree: which action serves which task, by which method. Of a large tree
    /// as many levels as are easily read, or DEPTH.
    #[arg(long, value_name = "DEPTH", num_args = 0..=1, require_equals = true)]
    pub(crate) explain: Option<Option<usize>>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum DomainCommand {
    /// Name everything that is wrong with the domains and execution models of a folder.
    Check {
        /// A folder with *.hddl and *.toml.
        dir: PathBuf,
    },
}

#[derive(Debug, Subcommand)]
pub(crate) enum RoleCommand {
    /// The area level.
    Parent(parent_agent::program::ParentArgs),
    /// The node level.
    Child(child_agent::program::ChildArgs),
    /// The robot's controller.
    Executor(executor_sim::program::ControllerArgs),
    /// The world.
    World(executor_sim::program::WorldArgs),
    /// The room of a restaurant.
    Room(executor_sim::program::RoomArgs),
    /// A vehicle of a restaurant.
    Vehicle(Box<vehicle::program::VehicleArgs>),
    /// The machines of one kind of many robots.
    Host(crate::experiment::fleet::HostArgs),
}

fn seconds(text: &str) -> Result<Duration, String> {
    let number = text.parse::<f64>().ok();
    let duration = number.and_then(|number| Duration::try_from_secs_f64(number).ok());
    duration.ok_or_else(|| "expected a number of seconds".to_owned())
}

fn at_least_a_second(text: &str) -> Result<Duration, String> {
    match seconds(text) {
        Ok(limit) if limit >= Duration::from_secs(1) => Ok(limit),
        _ => Err("expected a number of seconds of at least 1".to_owned()),
    }
}

fn speed(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(speed) if speed.is_finite() && speed > 0.0 => Ok(speed),
        _ => Err("expected a number above zero".to_owned()),
    }
}
