//! The parent as a program: arguments, then drive.

use std::collections::BTreeMap;

use agent_core::agent::{Agent, Configuration};
use agent_core::model::Symbol;
use agent_link::options::{LimitOptions, LinkOptions, PlaceOptions, PlannerOptions};
use agent_link::{Keys, RoleError, Wiring, drive_agent_in_world, next_epoch};
use clap::Args;
use maps::{NotInOrder, Place};

use crate::SetupError;

/// What a parent is started with.
#[derive(Args, Clone, Debug)]
pub struct ParentArgs {
    #[command(flatten)]
    link: LinkOptions,
    #[command(flatten)]
    place: PlaceOptions,
    #[command(flatten)]
    planner: PlannerOptions,
    #[command(flatten)]
    limits: LimitOptions,
    /// The child agent that does what this one plans.
    #[arg(long, value_name = "NAME", default_value = "child")]
    child: String,
    /// A child agent in charge of one area only. May be given several times.
    #[arg(long, value_name = "AREA=NAME", value_parser = wing)]
    wing: Vec<(Symbol, Symbol)>,
}

/// Why a parent could not start or could not go on.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    /// The folder with map and domains.
    #[error(transparent)]
    Place(#[from] NotInOrder),
    /// The arguments do not fit the place.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// Connection, clock, loop.
    #[error(transparent)]
    Role(#[from] RoleError),
}

/// Runs a parent until it is told to end.
///
/// # Errors
/// If it cannot start or cannot go on.
pub async fn run(args: ParentArgs) -> Result<(), ProgramError> {
    let place = Place::open(args.place.place.as_deref())?;
    let keys = args.link.keys().map_err(RoleError::from)?;
    let memory = args.link.memory(crate::NAME, place.fingerprint())?;
    let epoch = next_epoch(&memory).map_err(RoleError::from)?;
    let mut configuration = crate::configuration(
        place.site(),
        place.area(),
        &args.place.start,
        &args.child,
        BTreeMap::from_iter(args.wing),
        epoch,
    )?;
    configuration.policy.most_waiting = args.limits.most_waiting;
    let wiring = Wiring {
        limits: args.limits.limits(),
        ..wiring(&keys, &configuration)
    };
    let agent = Agent::new(configuration, args.planner.make());
    drive_agent_in_world(agent, memory, wiring, &args.link).await?;
    Ok(())
}

/// What a parent of that configuration is connected to.
pub fn wiring(keys: &Keys, configuration: &Configuration) -> Wiring {
    let executors = configuration.executors.all();
    Wiring {
        executors: executors.iter().map(ToString::to_string).collect(),
        takes_goals: true,
        takes_facts: true,
        ..Wiring::new(keys, crate::NAME, configuration.epoch)
    }
}

fn wing(text: &str) -> Result<(Symbol, Symbol), String> {
    match text.split_once('=') {
        Some((area, child)) if !area.is_empty() && !child.is_empty() => {
            Ok((area.into(), child.into()))
        }
        _ => Err("expected an area and a child agent, such as area4=west".to_owned()),
    }
}
