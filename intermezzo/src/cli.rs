//! What can be typed.

mod experiment;

pub(crate) use experiment::{
    ExperimentCommand, FleetArgs, LatencyArgs, ReportOptions, ScalingArgs,
};

use std::path::PathBuf;
use std::time::Duration;

use agent_link::options::{DEFAULT_ROBOT, LimitOptions, PlannerOptions};
use clap::{Args, Parser, Subcommand};

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
    /// A guided tour with two emergencies and a door that closes, played by four processes.
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

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The story: a robot guides a visitor from the entrance (n1) to the main hall (n40). In the middle of
a corridor somebody needs the toilet, and on the way there a child feels ill. While the tour waits, a
door on its way closes. The robot comes back to the tour with another plan, and arrives.

It is the scenario file intermezzo/scenarios/demo.toml, which `intermezzo up --scenario` reads too.

Examples:
  intermezzo demo --speed 5     slower, to watch the robot stop and turn
  intermezzo demo --json        one event a line, for programs")]
pub(crate) struct DemoArgs {
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
  intermezzo up --state robot-state                 keep goals and places there: go on where it was
  intermezzo up --scenario story.toml --until-done  play a story, then end

A role that dies or hangs is started again; `intermezzo status` shows it.

A scenario is TOML, one event after the other:
  [[event]]
  at_s = 2.0                  # seconds after the robot is ready, or
  while_on = \"arc5\"           # when the robot is well on that arc; or at once
  say = \"Somebody is in need.\"
  emergency = \"(go n28)\"      # or goal = …; with id, priority, deadline_s
                              # or door = \"door4_6\" and state = \"closed\"
                              # or fact = \"(not (open door4_6))\"
                              # or suspend, resume, cancel = \"tour\"

Exit status: 0 after Ctrl-C; with --until-done, 0 if all goals of the scenario succeeded, else 1;
1 if a role ends whenever it is started; 2 if the place or the scenario is not in order.")]
pub(crate) struct UpArgs {
    /// A folder with map, domains and execution models, or `museum`, which is built in.
    #[arg(value_name = "PLACE", default_value = "museum")]
    pub(crate) place: PathBuf,
    /// The robot's name. Two robots of different names can run side by side.
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT, env = "INTERMEZZO_ROBOT")]
    pub(crate) robot: String,
    /// The node where the robot stands at first.
    #[arg(long, value_name = "NODE", default_value = "n1")]
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
    /// Without it, in a temporary directory that is removed at the end.
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
  intermezzo fact '(= (length arc5) 9)'")]
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

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
In DIR there is then, each readable by you alone:
  ca.pem, ca-key.pem            an authority; its key makes more certificates, and nothing else needs it
  router, supervisor, parent, child, executor, world, operator, viewer
                                of each a certificate, its private key and a zenoh configuration

Examples:
  intermezzo certs keys                          then: intermezzo up --security keys
  intermezzo certs keys --name robot1.example    if other machines reach the router by that name
  intermezzo certs keys --add anna               one user more, signed by the same authority

security/README.md says what each may do. Exit status: 0 all is there; 2 nothing was written.")]
pub(crate) struct CertsArgs {
    /// The folder; it is made if it is not there.
    #[arg(value_name = "DIR")]
    pub(crate) dir: PathBuf,
    /// A name or address by which other machines reach the router. May be given several times.
    #[arg(long, value_name = "HOST", conflicts_with = "add")]
    pub(crate) name: Vec<String>,
    /// How long the certificates are good for; the authority is for ten years.
    #[arg(long, value_name = "DAYS", default_value_t = 365, value_parser = clap::value_parser!(u16).range(1..=3650))]
    pub(crate) days: u16,
    /// One user more, by an authority that was made here before.
    #[arg(long, value_name = "NAME")]
    pub(crate) add: Option<String>,
    /// Replace what is there. Whoever has the old files is locked out.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
In DIR there is then, each readable by you alone:
  router.json5, credentials.txt       the router's configuration, and the names and passwords it knows
  supervisor, parent, child, executor, world, operator, viewer (.json5)
                                      of each a zenoh configuration with its name and password

Passwords are not sent, but what is said can be read on the way and changed: beyond one machine use
certificates (intermezzo certs).

Examples:
  intermezzo passwords keys                then: intermezzo up --security keys
  intermezzo passwords keys --add anna     one user more

security/README.md says what each may do. Exit status: 0 all is there; 2 nothing was written.")]
pub(crate) struct PasswordsArgs {
    /// The folder; it is made if it is not there.
    #[arg(value_name = "DIR")]
    pub(crate) dir: PathBuf,
    /// One user more.
    #[arg(long, value_name = "NAME")]
    pub(crate) add: Option<String>,
    /// Replace what is there. Whoever has the old files is locked out.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum MapCommand {
    /// Name everything that is wrong with a map, each with its line.
    Check {
        /// A map in the shape of Nav2's Route Server.
        file: PathBuf,
    },
    /// Make up a museum of any size, to see how things go on a map as large as yours.
    Scale(ScaleArgs),
    /// Make a map of a navigation graph of Open-RMF.
    FromRmf(FromRmfArgs),
    /// Draw a map: areas, nodes, passages and doors, and the shortest way between two nodes.
    Svg(SvgArgs),
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  intermezzo map from-rmf maps/examples/office.rmf.yaml -o office/      a whole place, then:
  intermezzo up office --start charger1
  intermezzo map from-rmf 0.yaml --level L2 --areas-by names -o l2.geojson

A navigation graph has no areas; ours are made so: what can be reached without passing a door is an area,
and what is too large then, or has a door inside, is cut in two. Where areas meet without a door, a gate is
made up that is open. What is left out or made up is told on the standard error. See maps/README.md.

Exit status: 0 made; 1 the graph has faults, each is named with its line; 2 no such file, or OUT cannot be
written.")]
pub(crate) struct FromRmfArgs {
    /// A navigation graph in YAML, as building_map_generator of rmf_building_map_tools makes it.
    pub(crate) file: PathBuf,
    /// The file to write the map to, or a folder (it exists, or its name ends in `/`) to write a whole
    /// place to, with the museum's domains. Without it the map is printed.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// The level that is wanted, if there are several.
    #[arg(long, value_name = "NAME")]
    pub(crate) level: Option<String>,
    /// What makes an area: only doors, or also what vertices are called (a property `area`, or else what
    /// names have in common: office_101 and office_102).
    #[arg(long, value_enum, default_value_t = AreasBy::Doors)]
    pub(crate) areas_by: AreasBy,
    /// An area of more nodes is cut.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(2..))]
    pub(crate) area_nodes: u32,
    /// Print one JSON object with what was made, left out and made up.
    #[arg(long, requires = "output")]
    pub(crate) json: bool,
}

/// What makes an area.
#[derive(Clone, Copy, Debug, Eq, PartialEq, clap::ValueEnum)]
pub(crate) enum AreasBy {
    Doors,
    Names,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  intermezzo map svg maps/museum/map.geojson -o museum.svg
  intermezzo map svg maps/museum/map.geojson --start n1 --route n1 n40 --closed door3_5 > museum.svg

The picture is the same whenever the map is. Labels for which there is no room are left out; in a map of
up to 2,000 nodes each node, door and area says what it is where the pointer rests on it.

Exit status: 0 drawn; 1 the map has faults, or there is no way; 2 no such file, node or door, or OUT cannot
be written.")]
pub(crate) struct SvgArgs {
    /// A map in the shape of Nav2's Route Server.
    pub(crate) file: PathBuf,
    /// The file to write the picture to. Without it the picture is printed.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Draw this door closed. May be given several times.
    #[arg(long, value_name = "DOOR")]
    pub(crate) closed: Vec<String>,
    /// Draw this door open, though the map has it closed at first.
    #[arg(long, value_name = "DOOR")]
    pub(crate) open: Vec<String>,
    /// Mark the node where the robot starts.
    #[arg(long, value_name = "NODE")]
    pub(crate) start: Option<String>,
    /// Show the shortest way from node to node, through the doors that are drawn open.
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"])]
    pub(crate) route: Vec<String>,
}

#[derive(Args, Clone, Debug)]
pub(crate) struct ScaleArgs {
    /// How many nodes it is to have. There is an area for every five of them.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(maps::MOST_NODES)))]
    pub(crate) nodes: u32,
    /// The same seed makes the same museum.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// The file to write the map to, or a folder (it exists, or its name ends in `/`) to write a whole
    /// place to, with the museum's domains. Without it the map is printed.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
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
