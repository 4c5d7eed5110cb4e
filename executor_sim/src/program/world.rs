//! The world as a program.

use std::time::Duration;

use agent_link::options::{LinkOptions, PlaceOptions};
use agent_link::{Clock, Keys, Memory, RoleError, Wiring, drive, next_epoch, session};
use clap::Args;

use super::shown_world::ShownWorld;
use super::{ProgramError, WORLD, read};
use crate::{MoverSpec, Place, World};

/// Ten pictures a second look like motion …
const LONGEST_PERIOD: Duration = Duration::from_millis(100);
/// … but at high speed a robot is nowhere for long, and who waits to see it there must not miss it.
const WORLD_S_BETWEEN_SNAPSHOTS: f64 = 1.0;
/// More often is a load and no help.
const SHORTEST_PERIOD: Duration = Duration::from_millis(10);

/// What a world is started with.
#[derive(Args, Clone, Debug)]
pub struct WorldArgs {
    #[command(flatten)]
    link: LinkOptions,
    #[command(flatten)]
    place: PlaceOptions,
    /// How many seconds of the world pass in one.
    #[arg(long, value_name = "X", default_value_t = 1.0)]
    speed: f64,
}

/// Runs a world until it is told to end.
///
/// # Errors
/// If it cannot start or cannot go on.
pub async fn run(args: WorldArgs) -> Result<(), ProgramError> {
    let (place, floor) = read(&args.place)?;
    let start = Place::at(&args.place.start);
    let world = World::new(floor, MoverSpec::default(), start)?;
    let memory = args.link.memory(WORLD, place.fingerprint())?;
    drive_world(world, memory, &args).await?;
    Ok(())
}

async fn drive_world(world: World, memory: Memory, args: &WorldArgs) -> Result<(), RoleError> {
    let keys = args.link.keys()?;
    let noted = args.link.state_file("clock.json")?;
    let clock = match &noted {
        Some(file) => Clock::continued(file, args.speed)?,
        None => Clock::start(args.speed)?,
    };
    let period = WORLD_S_BETWEEN_SNAPSHOTS / args.speed;
    let period = Duration::try_from_secs_f64(period).unwrap_or(LONGEST_PERIOD);
    let wiring = Wiring {
        snapshots_every: Some(period.clamp(SHORTEST_PERIOD, LONGEST_PERIOD)),
        ..wiring(&keys, next_epoch(&memory)?)
    };
    let session = args.link.open().await?;
    let service = clock.serve(&session, &keys).await;
    let driven = match service {
        Err(error) => Err(error.into()),
        Ok(_service) => {
            let world = ShownWorld::new(world, clock);
            let driven = drive(world, memory, wiring, &session, clock, args.link.shutdown()).await;
            driven.map(|_| ()).map_err(RoleError::from)
        }
    };
    session::close(session).await;
    if let Some(file) = &noted {
        clock.stop(file)?;
    }
    driven
}

/// What a world is connected to.
pub fn wiring(keys: &Keys, epoch: u64) -> Wiring {
    Wiring {
        takes_facts: true,
        waits_for_the_disk: false,
        local_in: Some(keys.world_command()),
        local_out: Some(keys.executor_sensor()),
        ..Wiring::new(keys, WORLD, epoch)
    }
}
