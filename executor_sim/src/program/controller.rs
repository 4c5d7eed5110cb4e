//! The robot's controller as a program.

use agent_link::options::{LinkOptions, PlaceOptions};
use agent_link::{Keys, RoleError, Wiring, drive_in_world, next_epoch};
use clap::Args;

use super::{EXECUTOR, ProgramError, read};
use crate::{Controller, FaultRates, Faults};

/// How often things go wrong with `--faults`: with one action in five.
pub(super) const RATES: FaultRates = FaultRates {
    late_stop_per_mille: 50,
    refused_suspension_per_mille: 50,
    failure_per_mille: 50,
    slow_per_mille: 50,
};

/// What a controller is started with.
#[derive(Args, Clone, Debug)]
pub struct ControllerArgs {
    #[command(flatten)]
    link: LinkOptions,
    #[command(flatten)]
    place: PlaceOptions,
    /// Have some actions fail, stop late, refuse to stop or be slow: which ones, this seed decides.
    #[arg(long, value_name = "SEED")]
    faults: Option<u64>,
}

/// Runs a controller until it is told to end.
///
/// # Errors
/// If it cannot start or cannot go on.
pub async fn run(args: ControllerArgs) -> Result<(), ProgramError> {
    let (place, floor) = read(&args.place)?;
    let faults = args
        .faults
        .map_or_else(Faults::none, |seed| Faults::random(seed, RATES));
    let node = place.node();
    let controller = Controller::new(&node.domain, &node.model, floor, faults)?;
    let keys = args.link.keys().map_err(RoleError::from)?;
    let memory = args.link.memory(EXECUTOR, place.fingerprint())?;
    let epoch = next_epoch(&memory).map_err(RoleError::from)?;
    drive_in_world(controller, memory, wiring(&keys, epoch), &args.link).await?;
    Ok(())
}

/// What a controller is connected to.
pub fn wiring(keys: &Keys, epoch: u64) -> Wiring {
    Wiring {
        local_in: Some(keys.executor_sensor()),
        local_out: Some(keys.world_command()),
        ..Wiring::new(keys, EXECUTOR, epoch)
    }
}
