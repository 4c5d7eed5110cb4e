//! What the programs of all roles have in common around their loop.

use std::convert::Infallible;
use std::fmt;
use std::io::{self, Write};
use std::pin::Pin;
use std::process::ExitCode;
use std::time::Duration;

use agent_core::protocol::Durable;
use agent_core::service::Message;
use agent_journal::JournalError;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::clock::{Clock, ClockError};
use crate::driver::{Memory, drive, drive_agent, drive_vehicle};
use crate::inspect::Inspect;
use crate::keys::NameError;
use crate::options::LinkOptions;
use crate::process::runtime;
use crate::session::{self, Session, SessionError};
use crate::wiring::{LinkError, Wiring};

/// The world may be started after its robots.
const PATIENCE_WITH_THE_WORLD: Duration = Duration::from_secs(60);

/// Our own warnings. What zenoh complains of comes back to us as an error, which we report in our
/// own words; it also complains of every attempt to connect, and when one answer was enough and a
/// second one comes. `RUST_LOG=warn` shows it all.
const DEFAULT_FILTER: &str = "off,agent_core=warn,agent_link=warn,child_agent=warn,\
    executor_sim=warn,intermezzo=warn,maps=warn,parent_agent=warn,vehicle=warn";

/// Why a role could not start or could not go on.
#[derive(Debug, thiserror::Error)]
pub enum RoleError {
    /// A name that cannot be part of a key.
    #[error(transparent)]
    Name(#[from] NameError),
    /// No connection to the other roles.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// No world, or not at this speed.
    #[error(transparent)]
    Clock(#[from] ClockError),
    /// What it has written down.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// It could not go on.
    #[error(transparent)]
    Link(#[from] LinkError),
}

/// Runs a program of one role: log, runtime, and an error in words on the standard error.
pub fn run_role<E: fmt::Display>(run: impl Future<Output = Result<(), E>>) -> ExitCode {
    log_to_stderr();
    let result = match runtime() {
        Ok(runtime) => runtime.block_on(run).map_err(|error| error.to_string()),
        Err(error) => Err(format!("cannot start: {error}")),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Nobody can be told that the standard error is closed.
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Has the log written to the standard error: warnings, or what `RUST_LOG` says.
pub fn log_to_stderr() {
    let filter = tracing_subscriber::EnvFilter::try_from_default_env()
        .unwrap_or_else(|_| tracing_subscriber::EnvFilter::new(DEFAULT_FILTER));
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(io::stderr)
        .with_ansi(io::IsTerminal::is_terminal(&io::stderr()));
    // A second subscriber is refused; the first is as good.
    let _ = log.try_init();
}

/// Drives an agent by the clock of the robot's world until it is to end.
///
/// # Errors
/// If there is no connection, no world, or another process of this name.
pub async fn drive_agent_in_world<M>(
    agent: M,
    memory: Memory,
    wiring: Wiring,
    options: &LinkOptions,
) -> Result<(), RoleError>
where
    M: Durable<In = Infallible, Out = Infallible> + Inspect,
{
    in_world(options, wiring, async |wiring, session, clock, shutdown| {
        drive_agent(agent, memory, wiring, session, clock, shutdown).await?;
        Ok(())
    })
    .await
}

/// As [`drive_agent_in_world`], for a machine that also hears from and tells others.
///
/// # Errors
/// If there is no connection, no world, or another process of this name.
pub async fn drive_in_world<M>(
    machine: M,
    memory: Memory,
    wiring: Wiring,
    options: &LinkOptions,
) -> Result<(), RoleError>
where
    M: Durable + Inspect,
    M::In: DeserializeOwned,
    M::Out: Serialize + Clone,
{
    in_world(options, wiring, async |wiring, session, clock, shutdown| {
        drive(machine, memory, wiring, session, clock, shutdown).await?;
        Ok(())
    })
    .await
}

/// As [`drive_agent_in_world`], for one of a team of vehicles, which is made once it is known how fast
/// the world runs.
///
/// # Errors
/// If there is no connection, no world, or another process of this name.
pub async fn drive_vehicle_in_world<M>(
    make: impl FnOnce(f64) -> M,
    memory: Memory,
    wiring: Wiring,
    options: &LinkOptions,
) -> Result<(), RoleError>
where
    M: Durable<In = Message, Out = Message> + Inspect,
{
    in_world(options, wiring, async |wiring, session, clock, shutdown| {
        let vehicle = make(clock.speed());
        drive_vehicle(vehicle, memory, wiring, session, clock, shutdown).await?;
        Ok(())
    })
    .await
}

/// Connects, waits for the world's clock, and closes the session at the end.
async fn in_world(
    options: &LinkOptions,
    wiring: Wiring,
    drive: impl AsyncFnOnce(Wiring, &Session, Clock, Shutdown<'_>) -> Result<(), LinkError>,
) -> Result<(), RoleError> {
    let mut shutdown: Shutdown<'_> = Box::pin(options.shutdown());
    let session = options.open().await?;
    let asked = Clock::of_world(&session, &wiring.keys, PATIENCE_WITH_THE_WORLD);
    let clock = tokio::select! {
        clock = asked => Some(clock),
        () = &mut shutdown => None,
    };
    let driven = match clock {
        None => Ok(()),
        Some(Err(error)) => Err(error.into()),
        Some(Ok(clock)) => {
            let driven = drive(wiring, &session, clock, shutdown).await;
            driven.map_err(RoleError::from)
        }
    };
    session::close(session).await;
    driven
}

type Shutdown<'a> = Pin<Box<dyn Future<Output = ()> + 'a>>;
