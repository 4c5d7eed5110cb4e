//! The vehicle as a program: arguments, then drive.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use agent_core::agent::Configuration;
use agent_link::options::{LimitOptions, LinkOptions, PlannerOptions};
use agent_link::{Keys, RoleError, Wiring, drive_vehicle_in_world, next_epoch};
use clap::Args;
use maps::{NotInOrder, Restaurant};

use crate::{ROOM, SetupError, TOGETHER};

/// What a vehicle is started with.
#[derive(Args, Clone, Debug)]
pub struct VehicleArgs {
    #[command(flatten)]
    link: LinkOptions,
    /// The folder with map.geojson, node.hddl, node.toml and room.toml. Without it, the restaurant of
    /// the paper.
    #[arg(long, value_name = "DIR")]
    place: Option<PathBuf>,
    #[command(flatten)]
    planner: PlannerOptions,
    #[command(flatten)]
    limits: LimitOptions,
    /// Which of the vehicles in room.toml it is.
    #[arg(long, value_name = "NAME")]
    name: String,
    /// So many goals it works on at once; 1 is one after another.
    #[arg(long, value_name = "N", default_value_t = TOGETHER)]
    together: NonZeroUsize,
}

/// Why a vehicle could not start or could not go on.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    /// The folder with map, domain and room.
    #[error(transparent)]
    Place(#[from] NotInOrder),
    /// The arguments do not fit the place.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// Connection, clock, loop.
    #[error(transparent)]
    Role(#[from] RoleError),
}

/// Runs a vehicle until it is told to end.
///
/// # Errors
/// If it cannot start or cannot go on.
pub async fn run(args: VehicleArgs) -> Result<(), ProgramError> {
    let restaurant = Restaurant::open(args.place.as_deref())?;
    let keys = args.link.keys().map_err(RoleError::from)?;
    let memory = args.link.memory(&args.name, restaurant.fingerprint())?;
    let epoch = next_epoch(&memory).map_err(RoleError::from)?;
    let mut configuration = crate::configuration(&restaurant, &args.name, epoch)?;
    configuration.policy.most_waiting = args.limits.most_waiting;
    let wiring = Wiring {
        limits: args.limits.limits(),
        ..wiring(&keys, &restaurant, &configuration)
    };
    let planner = args.planner.make();
    let make = |speed| {
        let equipment = crate::equipment(&restaurant, &args.name, speed);
        crate::vehicle(configuration, equipment, args.together, planner)
    };
    drive_vehicle_in_world(make, memory, wiring, &args.link).await?;
    Ok(())
}

/// What a vehicle of that configuration is connected to. The first of a restaurant's vehicles by name
/// takes the goals that are for none of them in particular, and publishes them.
pub fn wiring(keys: &Keys, restaurant: &Restaurant, configuration: &Configuration) -> Wiring {
    let vehicles = &restaurant.room().vehicles;
    let first = vehicles.keys().next();
    Wiring {
        executors: vec![ROOM.to_owned()],
        takes_goals: first == Some(&configuration.name),
        takes_own_goals: true,
        in_team: true,
        signs: true,
        ..Wiring::new(keys, configuration.name.as_str(), configuration.epoch)
    }
}
