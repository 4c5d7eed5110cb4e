//! The command that users type.
#![cfg_attr(test, allow(clippy::unwrap_used))]

mod cli;
mod command;
mod exit;
mod experiment;
mod place;
mod robot;
mod scenario;
mod security;
mod show;
mod snapshot;
mod style;
mod target;

pub use cli::Cli;
pub use exit::{Exit, Failure};

use agent_core::protocol::Command as Wish;
use cli::{Command, DomainCommand, MapCommand, RoleCommand};
use command::{
    check, control, demo, experiment as measure, from_rmf, goal, plan, scale, secure, status, svg,
    up, watch,
};

/// Carries out what was typed, if that needs neither a robot nor anything else that waits. `None`
/// if it does: then it is for [`run`].
pub fn run_alone(cli: &Cli) -> Option<Result<Exit, Failure>> {
    match &cli.command {
        Command::Plan(args) => Some(plan::run(args)),
        Command::Certs(args) => Some(secure::certs(args)),
        Command::Passwords(args) => Some(secure::passwords(args)),
        Command::Map(MapCommand::Check { file }) => Some(check::map(file)),
        Command::Map(MapCommand::Scale(args)) => Some(scale::run(args)),
        Command::Map(MapCommand::FromRmf(args)) => Some(from_rmf::run(args)),
        Command::Map(MapCommand::Svg(args)) => Some(svg::run(args)),
        Command::Domain(DomainCommand::Check { dir }) => Some(check::domain(dir)),
        Command::Experiment(what) => measure::run_alone(what),
        _ => None,
    }
}

/// Carries out what was typed.
///
/// # Errors
/// If that is not possible.
pub async fn run(cli: Cli) -> Result<Exit, Failure> {
    if let Some(result) = run_alone(&cli) {
        return result;
    }
    match cli.command {
        Command::Demo(args) => demo::run(args).await,
        Command::Up(args) => up::run(*args).await,
        Command::Goal(args) => goal::run(args).await,
        Command::Suspend(args) => control::command(args, Wish::Suspend, "is set aside").await,
        Command::Resume(args) => control::command(args, Wish::Resume, "may go on").await,
        Command::Cancel(args) => control::command(args, Wish::Cancel, "is ended").await,
        Command::Fact(args) => control::fact(args).await,
        Command::Door(args) => control::door(args).await,
        Command::Status(args) => status::run(args).await,
        Command::Watch(args) => watch::run(args).await,
        Command::Experiment(what) => measure::run(what).await,
        Command::Role(role) => run_role(role).await,
        // All of these went alone.
        Command::Plan(_)
        | Command::Certs(_)
        | Command::Passwords(_)
        | Command::Map(_)
        | Command::Domain(_) => Ok(Exit::Done),
    }
}

async fn run_role(role: RoleCommand) -> Result<Exit, Failure> {
    match role {
        RoleCommand::Parent(args) => parent_agent::program::run(args)
            .await
            .map_err(Failure::failed)?,
        RoleCommand::Child(args) => child_agent::program::run(args)
            .await
            .map_err(Failure::failed)?,
        RoleCommand::Executor(args) => executor_sim::program::run_controller(args)
            .await
            .map_err(Failure::failed)?,
        RoleCommand::World(args) => executor_sim::program::run_world(args)
            .await
            .map_err(Failure::failed)?,
        RoleCommand::Room(args) => executor_sim::program::run_room(args)
            .await
            .map_err(Failure::failed)?,
        RoleCommand::Vehicle(args) => vehicle::program::run(*args)
            .await
            .map_err(Failure::failed)?,
        RoleCommand::Host(args) => experiment::fleet::host(args).await?,
    }
    Ok(Exit::Done)
}
