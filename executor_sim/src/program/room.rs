//! The room of several vehicles as a program.

use std::path::PathBuf;
use std::time::Duration;

use agent_link::options::LinkOptions;
use agent_link::{Clock, Keys, Memory, RoleError, Wiring, drive_agent, next_epoch, session};
use clap::Args;

use super::ProgramError;
use super::controller::RATES;
use super::shown_room::ShownRoom;
use crate::{ROOM, Room, Tempo};

/// Ten pictures a second look like motion …
const LONGEST_PERIOD: Duration = Duration::from_millis(100);
/// … but at high speed a vehicle is nowhere for long, and who waits to see it there must not miss it.
const ROOM_S_BETWEEN_SNAPSHOTS: f64 = 1.0;
/// More often is a load and no help.
const SHORTEST_PERIOD: Duration = Duration::from_millis(10);
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
    let noted = args.link.state_file("clock.json")?;
    let clock = match &noted {
        Some(file) => Clock::continued(file, args.speed)?,
        None => Clock::start(args.speed)?,
    };
    let period = ROOM_S_BETWEEN_SNAPSHOTS / args.speed;
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
            let room = ShownRoom::new(room, clock);
            let shutdown = args.link.shutdown();
            let driven = drive_agent(room, memory, wiring, &session, clock, shutdown).await;
            driven.map(|_| ()).map_err(RoleError::from)
        }
    };
    session::close(session).await;
    if let Some(file) = &noted {
        clock.stop(file)?;
    }
    driven
}

/// What a room is connected to: to every vehicle it is an executor of this name.
pub fn wiring(keys: &Keys, epoch: u64) -> Wiring {
    Wiring {
        takes_facts: true,
        ..Wiring::new(keys, ROOM, epoch)
    }
}
