//! A simulated world and the mover in it, without any input or output.
//!
//! Three state machines in virtual time: the [`World`] is what is there; the [`Controller`] is
//! what a superior talks to, and knows the world only by its sensors; a [`SimulatedRobot`] is both
//! of them coupled, one executor to whoever tests or drives agents. `docs/executor.md` says what a
//! real robot's driver has to fulfil in the controller's place. [`program`] drives world and
//! controller as processes of their own.

mod controller;
mod faults;
mod floor;
mod memory;
mod parts;
mod place;
mod profile;
#[cfg(feature = "process")]
pub mod program;
mod refusal;
mod room;
mod setup;
mod signal;
mod simulated_robot;
mod world;

pub use controller::{Controller, Skill, Vocabulary, VocabularyError};
pub use faults::{Fault, FaultRates, Faults};
pub use floor::{Floor, FloorError, Passage};
pub use parts::{Errand, Hindrance, Job, PartName, PartsError, PartsVocabulary, Work};
pub use place::Place;
pub use profile::MoverSpec;
pub use room::{
    Bottle, Deed, Doing as RoomDoing, Guest, Mover, Pace, ROOM, Room, RoomError, Spot, Tempo,
    Things, Whereabouts, users_speak_about,
};
pub use setup::SetupError;
pub use signal::{MotorCommand, Pose, Sensor, Ticket};
pub use simulated_robot::SimulatedRobot;
pub use world::{Doing, Done, Motion, World};

/// The world's name among the neighbours of a controller.
pub const WORLD: &str = "world";
