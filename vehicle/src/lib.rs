//! A vehicle of a restaurant: what it is made with.
//!
//! One level, from place to place. A vehicle plans and acts, gives tasks to the others and takes theirs,
//! and shares what it sees ([`agent_core::vehicle`]); its body is in the room that all of them are in.

#[cfg(feature = "process")]
pub mod program;

use std::num::NonZeroUsize;
use std::sync::Arc;

use agent_core::agent::{Configuration, Executors, Policy, Repair};
use agent_core::model::{FactChange, Symbol};
use agent_core::parallel::ParallelAgent;
use agent_core::planner::Planner;
use agent_core::service::Times;
use agent_core::vehicle::Equipment;
use maps::Restaurant;

/// The executor that all vehicles' bodies are in.
pub const ROOM: &str = "room";

/// So many goals a vehicle works on at once unless told otherwise: one more than the tray takes.
pub const TOGETHER: NonZeroUsize = NonZeroUsize::new(4).expect("it is not nothing");

/// A vehicle whose agent may work on several goals at once.
pub type Vehicle<P> = agent_core::vehicle::Vehicle<ParallelAgent<P>, P>;

/// Why a vehicle cannot be made.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// It is not in `room.toml`.
    #[error("there is no vehicle `{name}` in this restaurant; there are {known}")]
    Unknown {
        /// As given.
        name: String,
        /// As in the file.
        known: String,
    },
}

/// What the agent of a restaurant's vehicle is made with.
///
/// # Errors
/// If there is no such vehicle.
pub fn configuration(
    restaurant: &Restaurant,
    name: &str,
    epoch: u64,
) -> Result<Configuration, SetupError> {
    let start = restaurant.start(name).ok_or_else(|| {
        let known = restaurant.room().vehicles.keys();
        let known: Vec<&str> = known.map(Symbol::as_str).collect();
        SetupError::Unknown {
            name: name.to_owned(),
            known: known.join(", "),
        }
    })?;
    let level = restaurant.level();
    Ok(Configuration {
        name: Symbol::from(name),
        epoch,
        domain: Arc::new(level.domain.clone()),
        model: Arc::new(level.model.clone()),
        map: start.map,
        maps_below: Arc::new(()),
        facts: start.facts.into_iter().map(FactChange::Add).collect(),
        executors: Executors::one(ROOM),
        policy: Policy {
            repair: Repair::Nearest,
            ..Policy::default()
        },
    })
}

/// What a restaurant's vehicle is beside its agent, in a world of that speed.
pub fn equipment(restaurant: &Restaurant, name: &str, speed: f64) -> Equipment {
    let vehicle = restaurant.room().vehicles.get(&Symbol::from(name));
    Equipment {
        provides: vehicle.map(|it| it.provides.clone()).unwrap_or_default(),
        times: Times::at_speed(speed),
    }
}

/// A vehicle with that configuration.
pub fn vehicle<P: Planner + Clone>(
    configuration: Configuration,
    equipment: Equipment,
    together: NonZeroUsize,
    planner: P,
) -> Vehicle<P> {
    let mind = ParallelAgent::new(configuration.clone(), together, planner.clone());
    Vehicle::new(&configuration, equipment, mind, planner)
}
