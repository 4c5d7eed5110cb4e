//! The area level: what a parent agent is made with.
//!
//! The parent plans over areas and hands each of its actions to a child agent, together with the
//! map of the area that the action is about. It does not know how the child does it, nor that
//! there is a robot below.

#[cfg(feature = "process")]
pub mod program;

use std::collections::BTreeMap;
use std::sync::Arc;

use agent_core::agent::{Configuration, Executors, Policy};
use agent_core::model::{FactChange, Symbol};
use maps::{Level, Site};

/// What it is called unless told otherwise.
pub const NAME: &str = "parent";
/// Its level: the name of the domain files.
pub const LEVEL: &str = "area";

/// Why an agent cannot be made.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// The robot is said to start from nowhere.
    #[error("there is no node `{0}` on this map to start from")]
    UnknownNode(String),
    /// A child agent is given an area that is not there.
    #[error("there is no area `{0}` on this map that an agent could be put in charge of")]
    UnknownArea(Symbol),
}

/// A parent agent over the areas of a site, for a robot that stands at `start`.
///
/// `wings`: the child agents that are in charge of certain areas only, by area; every other area
/// is the business of `child`.
pub fn configuration(
    site: &Arc<Site>,
    level: &Level,
    start: &str,
    child: &str,
    wings: BTreeMap<Symbol, Symbol>,
    epoch: u64,
) -> Result<Configuration, SetupError> {
    if let Some(area) = wings.keys().find(|area| site.area(area.as_str()).is_none()) {
        return Err(SetupError::UnknownArea(area.clone()));
    }
    let facts =
        maps::area_start(site, start).ok_or_else(|| SetupError::UnknownNode(start.to_owned()))?;
    Ok(Configuration {
        name: Symbol::from(NAME),
        epoch,
        domain: Arc::new(level.domain.clone()),
        model: Arc::new(level.model.clone()),
        map: maps::area_level(site),
        maps_below: Arc::new(maps::AreaMaps::of(site.clone())),
        facts: facts.into_iter().map(FactChange::Add).collect(),
        executors: Executors {
            default: Symbol::from(child),
            of_place: wings,
        },
        policy: Policy::default(),
    })
}
