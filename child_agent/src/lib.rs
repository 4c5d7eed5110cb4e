//! The node level: what a child agent is made with.
//!
//! The child plans over the nodes of one area and hands each of its actions to a robot. It has no
//! map of its own: the map of the area it works in comes with its parent's instruction (the paper,
//! section 7).

#[cfg(feature = "process")]
pub mod program;

use std::sync::Arc;

use agent_core::agent::{Configuration, Executors, Policy};
use agent_core::model::{FactChange, Map, Symbol};
use maps::{Level, Site};

/// What it is called unless told otherwise.
pub const NAME: &str = "child";
/// Its level: the name of the domain files.
pub const LEVEL: &str = "node";

/// Why an agent cannot be made.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// The robot is said to start from nowhere.
    #[error("there is no node `{0}` on this map to start from")]
    UnknownNode(String),
}

/// A child agent for a robot that stands at `start` and is driven by `executor`.
pub fn configuration(
    site: &Site,
    level: &Level,
    start: &str,
    executor: &str,
    name: &str,
    epoch: u64,
) -> Result<Configuration, SetupError> {
    let facts =
        maps::node_start(site, start).ok_or_else(|| SetupError::UnknownNode(start.to_owned()))?;
    Ok(Configuration {
        name: Symbol::from(name),
        epoch,
        domain: Arc::new(level.domain.clone()),
        model: Arc::new(level.model.clone()),
        map: Map::default(),
        maps_below: Arc::new(()),
        facts: facts.into_iter().map(FactChange::Add).collect(),
        executors: Executors::one(executor),
        policy: Policy::default(),
    })
}
