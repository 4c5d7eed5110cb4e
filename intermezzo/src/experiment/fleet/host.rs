//! Many robots' machines of one kind in one process, over few sessions.
//!
//! Each is driven as in a process of its own, by the same loop; none keeps a journal, and no world
//! publishes pictures.

use std::collections::BTreeMap;
use std::future::pending;
use std::sync::Arc;

use agent_core::agent::Agent;
use agent_core::planner::{AnyPlanner, PlannerKind, Settings};
use agent_link::options::LinkOptions;
use agent_link::{Clock, Keys, Session, Wiring, drive, drive_agent, epoch_now, session};
use clap::{Args, ValueEnum};
use executor_sim::program::{ShownWorld, wiring_of_controller, wiring_of_world};
use executor_sim::{Controller, Faults, Floor, MoverSpec, World};
use maps::Place;
use tokio::task::JoinSet;

use crate::exit::Failure;

/// A world is there within this, however many are started.
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(120);

/// So many robots share a session: for every message zenoh looks through all that is declared in the
/// session that it comes to.
const ROBOTS_A_SESSION: usize = 25;

/// What a process hosts.
#[derive(Args, Clone, Debug)]
pub(crate) struct HostArgs {
    /// Which machines.
    #[arg(value_enum)]
    part: Part,
    /// Of how many robots.
    #[arg(long)]
    robots: u32,
    /// Seconds of the world in one.
    #[arg(long, default_value_t = 1.0)]
    speed: f64,
    #[command(flatten)]
    link: LinkOptions,
}

/// Machines of one kind.
#[derive(Clone, Copy, Debug, Eq, PartialEq, ValueEnum)]
pub(super) enum Part {
    /// The area level.
    Parents,
    /// The node level.
    Children,
    /// Controllers and their worlds.
    Bodies,
}

impl Part {
    pub(super) const ALL: [Self; 3] = [Self::Bodies, Self::Children, Self::Parents];

    /// As it is typed.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Parents => "parents",
            Self::Children => "children",
            Self::Bodies => "bodies",
        }
    }
}

/// The keys of one robot of a fleet.
pub(super) fn keys(number: u32) -> Result<Keys, Failure> {
    Keys::new(&format!("r{number}")).map_err(Failure::failed)
}

/// The number of the robot that has that key.
pub(super) fn number_of(key: &str) -> Option<u32> {
    key.split('/').nth(1)?.strip_prefix('r')?.parse().ok()
}

/// Where a robot begins: fleets are spread over the map.
fn start(place: &Place, number: u32) -> String {
    let count = place.site().nodes().count();
    let node = place.site().nodes().nth(number as usize % count);
    node.map(|node| node.name().to_string()).unwrap_or_default()
}

/// Hosts machines until the process is told to end.
///
/// # Errors
/// If they cannot be made, or one of them cannot go on.
pub(crate) async fn run(args: HostArgs) -> Result<(), Failure> {
    let mut sessions = Vec::new();
    let hosted = tokio::select! {
        hosted = host(&args, &mut sessions) => hosted,
        () = args.link.shutdown() => Ok(()),
    };
    let closing: JoinSet<()> = sessions.into_iter().map(session::close).collect();
    closing.join_all().await;
    hosted
}

async fn host(args: &HostArgs, sessions: &mut Vec<Session>) -> Result<(), Failure> {
    let place = Arc::new(Place::museum());
    for _ in 0..(args.robots as usize).div_ceil(ROBOTS_A_SESSION) {
        sessions.push(args.link.open().await.map_err(Failure::failed)?);
    }
    let first = sessions
        .first()
        .ok_or_else(|| Failure::bad_input("a fleet has a robot at least"))?;
    let clock = match args.part {
        Part::Bodies => Clock::start(args.speed),
        // All worlds have one clock.
        _ => Clock::of_world(first, &keys(0)?, PATIENCE).await,
    };
    let clock = clock.map_err(Failure::failed)?;
    let epoch = epoch_now();
    let mut driven = JoinSet::new();
    let mut services = Vec::new();
    for number in 0..args.robots {
        let session = &sessions[number as usize / ROBOTS_A_SESSION];
        let (keys, session) = (keys(number)?, session.clone());
        match args.part {
            Part::Parents => {
                let (agent, wiring) = parent(&place, &keys, number, epoch)?;
                driven.spawn(async move {
                    let drive = drive_agent(agent, None, wiring, &session, clock, pending());
                    drive.await.map(|_| ())
                });
            }
            Part::Children => {
                let (agent, wiring) = child(&place, &keys, number, epoch)?;
                driven.spawn(async move {
                    let drive = drive_agent(agent, None, wiring, &session, clock, pending());
                    drive.await.map(|_| ())
                });
            }
            Part::Bodies => {
                let service = clock.serve(&session, &keys).await;
                services.push(service.map_err(Failure::failed)?);
                let (world, controller) = body(&place, number)?;
                let world = ShownWorld::new(world, clock);
                let wiring = wiring_of_world(&keys, epoch);
                let of_world = session.clone();
                driven.spawn(async move {
                    let drive = drive(world, None, wiring, &of_world, clock, pending());
                    drive.await.map(|_| ())
                });
                let wiring = wiring_of_controller(&keys, epoch);
                driven.spawn(async move {
                    let drive = drive(controller, None, wiring, &session, clock, pending());
                    drive.await.map(|_| ())
                });
            }
        }
    }
    while let Some(ended) = driven.join_next().await {
        ended.map_err(Failure::failed)?.map_err(Failure::failed)?;
    }
    Ok(())
}

fn planner() -> AnyPlanner {
    AnyPlanner::new(PlannerKind::default(), Settings::default())
}

fn parent(
    place: &Place,
    keys: &Keys,
    number: u32,
    epoch: u64,
) -> Result<(Agent<AnyPlanner>, Wiring), Failure> {
    let configuration = parent_agent::configuration(
        place.site(),
        place.area(),
        &start(place, number),
        child_agent::NAME,
        BTreeMap::new(),
        epoch,
    );
    let configuration = configuration.map_err(Failure::failed)?;
    let wiring = parent_agent::program::wiring(keys, &configuration);
    Ok((Agent::new(configuration, planner()), wiring))
}

fn child(
    place: &Place,
    keys: &Keys,
    number: u32,
    epoch: u64,
) -> Result<(Agent<AnyPlanner>, Wiring), Failure> {
    let configuration = child_agent::configuration(
        place.site(),
        place.node(),
        &start(place, number),
        executor_sim::program::EXECUTOR,
        child_agent::NAME,
        epoch,
    );
    let configuration = configuration.map_err(Failure::failed)?;
    let wiring = child_agent::program::wiring(keys, &configuration);
    Ok((Agent::new(configuration, planner()), wiring))
}

fn body(place: &Place, number: u32) -> Result<(World, Controller), Failure> {
    let floor = Floor::try_from(&**place.site()).map_err(Failure::failed)?;
    let start = executor_sim::Place::at(&start(place, number));
    let world = World::new(floor.clone(), MoverSpec::default(), start).map_err(Failure::failed)?;
    let node = place.node();
    let controller = Controller::new(&node.domain, &node.model, floor, Faults::none());
    Ok((world, controller.map_err(Failure::failed)?))
}
