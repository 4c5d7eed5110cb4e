//! World and controller as programs, and a room of several vehicles: reality does not end when a
//! robot's process does.

mod controller;
mod room;
mod shown_room;
mod shown_world;
mod time_keeping;
mod world;

use agent_link::RoleError;
use agent_link::options::PlaceOptions;
use clap::{Args, Subcommand};

pub use controller::{ControllerArgs, run as run_controller, wiring as wiring_of_controller};
pub use room::{RoomArgs, run as run_room, wiring as wiring_of_room};
pub use shown_room::ShownRoom;
pub use shown_world::ShownWorld;
pub use world::{WorldArgs, run as run_world, wiring as wiring_of_world};

use crate::{Floor, FloorError, RoomError, SetupError, VocabularyError};

/// The controller's name.
pub const EXECUTOR: &str = "executor";
pub use crate::{ROOM, WORLD};

/// What is run.
#[derive(Args, Clone, Debug)]
pub struct ExecutorArgs {
    #[command(subcommand)]
    part: Part,
}

/// The two halves of a simulated robot, and where several vehicles are.
#[derive(Clone, Debug, Subcommand)]
enum Part {
    /// The robot's controller: takes instructions, gives reports.
    Controller(ControllerArgs),
    /// The world: doors, the robot's body, and the clock of all.
    World(WorldArgs),
    /// One reality for several vehicles, each made of parts, and the clock of all.
    Room(RoomArgs),
}

/// Why a program could not start or could not go on.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    /// The folder with map and domains.
    #[error(transparent)]
    Place(#[from] maps::NotInOrder),
    /// A map on which no robot can move.
    #[error("cannot set up the floor: {0}")]
    Floor(#[from] FloorError),
    /// An execution model that no robot can follow.
    #[error("cannot set up the robot: {0}")]
    Vocabulary(#[from] VocabularyError),
    /// No such robot on this floor.
    #[error("cannot set up the world: {0}")]
    Setup(#[from] SetupError),
    /// No such vehicles here.
    #[error("cannot set up the room: {0}")]
    Room(#[from] RoomError),
    /// Connection, clock, loop.
    #[error(transparent)]
    Role(#[from] RoleError),
}

/// Runs one of them until it is told to end.
///
/// # Errors
/// If it cannot start or cannot go on.
pub async fn run(args: ExecutorArgs) -> Result<(), ProgramError> {
    match args.part {
        Part::Controller(args) => run_controller(args).await,
        Part::World(args) => run_world(args).await,
        Part::Room(args) => run_room(args).await,
    }
}

/// The place, and the floor that it is to a robot.
fn read(options: &PlaceOptions) -> Result<(maps::Place, Floor), ProgramError> {
    let place = maps::Place::open(options.place.as_deref())?;
    let floor = Floor::try_from(&**place.site())?;
    Ok((place, floor))
}
