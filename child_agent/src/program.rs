//! The child as a program: arguments, then drive.

use agent_core::agent::{Agent, Configuration};
use agent_link::options::{LinkOptions, PlaceOptions, PlannerOptions};
use agent_link::{Keys, RoleError, Wiring, drive_agent_in_world, next_epoch};
use clap::Args;
use maps::{NotInOrder, Place};

use crate::SetupError;

/// What a child is started with.
#[derive(Args, Clone, Debug)]
pub struct ChildArgs {
    #[command(flatten)]
    link: LinkOptions,
    #[command(flatten)]
    place: PlaceOptions,
    #[command(flatten)]
    planner: PlannerOptions,
    /// Its name, by which parents instruct it.
    #[arg(long, value_name = "NAME", default_value = crate::NAME)]
    name: String,
    /// The robot's controller that does what this one plans.
    #[arg(long, value_name = "NAME", default_value = "executor")]
    executor: String,
}

/// Why a child could not start or could not go on.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    /// The folder with map and domains.
    #[error(transparent)]
    Place(#[from] NotInOrder),
    /// The arguments do not fit the place.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// Connection, clock, loop.
    #[error(transparent)]
    Role(#[from] RoleError),
}

/// Runs a child until it is told to end.
///
/// # Errors
/// If it cannot start or cannot go on.
pub async fn run(args: ChildArgs) -> Result<(), ProgramError> {
    let place = Place::open(args.place.place.as_deref())?;
    let keys = args.link.keys().map_err(RoleError::from)?;
    let memory = args.link.memory(&args.name, place.fingerprint())?;
    let epoch = next_epoch(&memory).map_err(RoleError::from)?;
    let configuration = crate::configuration(
        place.site(),
        place.node(),
        &args.place.start,
        &args.executor,
        &args.name,
        epoch,
    )?;
    let wiring = wiring(&keys, &configuration);
    let agent = Agent::new(configuration, args.planner.make());
    drive_agent_in_world(agent, memory, wiring, &args.link).await?;
    Ok(())
}

/// What a child of that configuration is connected to.
pub fn wiring(keys: &Keys, configuration: &Configuration) -> Wiring {
    let executors = configuration.executors.all();
    Wiring {
        executors: executors.iter().map(ToString::to_string).collect(),
        takes_facts: true,
        ..Wiring::new(keys, configuration.name.as_str(), configuration.epoch)
    }
}
