//! The room of several vehicles as a program.

use std::path::PathBuf;

use agent_link::options::LinkOptions;
use agent_link::{Keys, Memory, RoleError, Wiring, drive_agent, next_epoch};
use clap::Args;

use super::ProgramError;
use super::controller::RATES;
use super::shown_room::ShownRoom;
use super::time_keeping::{keeping_time, snapshots_every};
use crate::{ROOM, Room, Tempo};

/// How much more or less time things take with `--varied`.
const VARIED: f64 = 0.15;

/// What a room is started with.
#[derive(Args, Clone, Debug)]
pub struct RoomArgs {
    #[command(flatten)]
    link: LinkOptions,
    /// The folder with map.geojson, node.hddl, node.toml and room.toml. Without it, the restaurant of
    /// the paper.
    #[arg(long, value_name = "DIR")]
    place: Option<PathBuf>,
    /// How many seconds of the room pass in one.
    #[arg(long, value_name = "X", default_value_t = 1.0)]
    speed: f64,
    /// Have some actions fail, stop late, refuse to stop or be slow: which ones, this seed decides.
    #[arg(long, value_name = "SEED")]
    faults: Option<u64>,
    /// Have everything take up to 15 % more or less time than the model says, as this seed decides.
    #[arg(long, value_name = "SEED")]
    varied: Option<u64>,
}

/// Runs a room until it is told to end.
///
/// # Errors
/// If it cannot start or cannot go on.
pub async fn run(args: RoomArgs) -> Result<(), ProgramError> {
    let restaurant = maps::Restaurant::open(args.place.as_deref())?;
    let mut room = Room::new(&restaurant)?;
    if let Some(seed) = args.faults {
        room = room.with_chance(seed, RATES);
    }
    if let Some(seed) = args.varied {
        room = room.with_tempo(Tempo::varied(seed, VARIED));
    }
    let memory = args.link.memory(ROOM, restaurant.fingerprint())?;
    drive_room(room, memory, &args).await?;
    Ok(())
}

async fn drive_room(room: Room, memory: Memory, args: &RoomArgs) -> Result<(), RoleError> {
    let keys = args.link.keys()?;
    let wiring = Wiring {
        snapshots_every: Some(snapshots_every(args.speed)),
        ..wiring(&keys, next_epoch(&memory)?)
    };
    keeping_time(&args.link, &keys, args.speed, async |session, clock| {
        let room = ShownRoom::new(room, clock);
        drive_agent(room, memory, wiring, session, clock, args.link.shutdown()).await
    })
    .await
}

/// What a room is connected to: to every vehicle it is an executor of this name.
pub fn wiring(keys: &Keys, epoch: u64) -> Wiring {
    Wiring {
        takes_facts: true,
        signs: true,
        ..Wiring::new(keys, ROOM, epoch)
    }
}
