//! The world as a program.

use agent_link::options::{LinkOptions, PlaceOptions};
use agent_link::{Keys, Memory, RoleError, Wiring, drive, next_epoch};
use clap::Args;

use super::shown_world::ShownWorld;
use super::time_keeping::{keeping_time, snapshots_every};
use super::{ProgramError, WORLD, read};
use crate::{MoverSpec, Place, World};

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
    let wiring = Wiring {
        snapshots_every: Some(snapshots_every(args.speed)),
        ..wiring(&keys, next_epoch(&memory)?)
    };
    keeping_time(&args.link, &keys, args.speed, async |session, clock| {
        let world = ShownWorld::new(world, clock);
        drive(world, memory, wiring, session, clock, args.link.shutdown()).await
    })
    .await
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
