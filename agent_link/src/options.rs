//! What can be set for every role, in the same words.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use agent_core::planner::{AnyPlanner, Depth, PlannerKind, Settings};
use agent_journal::{Identity, Journal};
use clap::Args;
use zenoh::Session;

use crate::driver::Memory;
use crate::keys::{Keys, NameError};
pub use crate::limit_options::{LimitOptions, RateOption};
use crate::process::{interrupted, stdin_ended};
use crate::role::RoleError;
use crate::session::{self, Role, SessionError};

/// The robot that is meant unless one is named.
pub const DEFAULT_ROBOT: &str = "robot";

/// Whose role it is, and how the others are reached.
#[derive(Args, Clone, Debug)]
pub struct LinkOptions {
    /// The robot that this is a part of.
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    pub robot: String,
    /// Where the robot's router listens, such as tcp/127.0.0.1:7447. May be given several times.
    #[arg(long, value_name = "ENDPOINT")]
    pub connect: Vec<String>,
    /// Be the router: listen here, and let the other roles connect to it.
    #[arg(long, value_name = "ENDPOINT", conflicts_with = "connect")]
    pub listen: Vec<String>,
    /// Zenoh settings (JSON5) for TLS, passwords, access control.
    #[arg(long, value_name = "FILE")]
    pub zenoh_config: Option<PathBuf>,
    /// Remember in `DIR/<robot>/` what must not be lost, and go on from there. Without it, everything
    /// is forgotten when the role ends.
    #[arg(long, value_name = "DIR")]
    pub state: Option<PathBuf>,
    /// End when the standard input ends: whoever started this role is gone then.
    #[arg(long, hide = true)]
    pub until_stdin_ends: bool,
}

impl LinkOptions {
    /// The keys of the robot.
    pub fn keys(&self) -> Result<Keys, NameError> {
        Keys::new(&self.robot)
    }

    /// What the role of that name has written down, in a place of that fingerprint: in
    /// `DIR/<robot>/<role>.redb`, which is made if it is not there. `None` without `--state`.
    ///
    /// # Errors
    /// If that is not its journal, is damaged, or is in use.
    pub fn memory(&self, role: &str, place: &str) -> Result<Memory, RoleError> {
        self.keys()?.agent(role)?;
        let Some(path) = self.state_file(&format!("{role}.redb"))? else {
            return Ok(None);
        };
        let whose = Identity {
            robot: self.robot.clone(),
            role: role.to_owned(),
            place: place.to_owned(),
        };
        Ok(Some(Journal::open(&path, whose)?))
    }

    /// The file of that name in `DIR/<robot>/`; `None` without `--state`.
    ///
    /// # Errors
    /// If the names would lead elsewhere.
    pub fn state_file(&self, name: &str) -> Result<Option<PathBuf>, NameError> {
        let Some(directory) = &self.state else {
            return Ok(None);
        };
        self.keys()?;
        for part in [&self.robot, name] {
            if part.starts_with('.') {
                return Err(NameError::NotAName(part.to_owned()));
            }
        }
        Ok(Some(directory.join(&self.robot).join(name)))
    }

    /// A session with the robot's other roles.
    pub async fn open(&self) -> Result<Session, SessionError> {
        let role = if self.listen.is_empty() {
            Role::Client {
                connect: self.connect.clone(),
            }
        } else {
            Role::Router {
                listen: self.listen.clone(),
            }
        };
        session::open(&role, self.zenoh_config.as_deref()).await
    }

    /// Returns when the role is to end.
    pub async fn shutdown(&self) {
        tokio::select! {
            () = interrupted() => {}
            () = stdin_ended(), if self.until_stdin_ends => {}
        }
    }
}

/// Where the robot is.
#[derive(Args, Clone, Debug)]
pub struct PlaceOptions {
    /// The folder with map, domains and execution models. Without it, the museum.
    #[arg(long, value_name = "DIR")]
    pub place: Option<PathBuf>,
    /// The node where the robot stands when the world begins.
    #[arg(long, value_name = "NODE", default_value = "n1")]
    pub start: String,
}

/// How an agent plans.
#[derive(Args, Clone, Copy, Debug)]
pub struct PlannerOptions {
    /// The planner: `graph` keeps what it has found out, `naive` plans from scratch each time.
    #[arg(long, value_name = "PLANNER", default_value_t)]
    pub planner: PlannerOption,
    /// How far plans are decomposed: `full`, `first-action`, or a number of actions.
    #[arg(long, value_name = "DEPTH", default_value_t)]
    pub depth: DepthOption,
    /// How many plans are kept, the best included.
    #[arg(long, value_name = "K", default_value_t = 3, value_parser = at_least_one)]
    pub alternatives: usize,
}

impl PlannerOptions {
    /// For the planner.
    pub fn settings(&self) -> Settings {
        Settings {
            depth: self.depth.0,
            alternatives: self.alternatives,
        }
    }

    /// The planner that was chosen.
    pub fn make(&self) -> AnyPlanner {
        AnyPlanner::new(self.planner.0, self.settings())
    }

    /// As they are typed, to hand them on to another process.
    pub fn to_args(&self) -> Vec<String> {
        [
            "--planner",
            &self.planner.to_string(),
            "--depth",
            &self.depth.to_string(),
            "--alternatives",
            &self.alternatives.to_string(),
        ]
        .map(str::to_owned)
        .into()
    }
}

/// [`PlannerKind`] as it is typed.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct PlannerOption(pub PlannerKind);

impl FromStr for PlannerOption {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "graph" => Ok(Self(PlannerKind::Graph)),
            "naive" => Ok(Self(PlannerKind::Naive)),
            _ => Err("expected `graph` or `naive`".to_owned()),
        }
    }
}

impl fmt::Display for PlannerOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.0 {
            PlannerKind::Graph => "graph",
            PlannerKind::Naive => "naive",
        })
    }
}

/// [`Depth`] as it is typed.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct DepthOption(pub Depth);

impl FromStr for DepthOption {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "full" => Ok(Self(Depth::Full)),
            "first-action" => Ok(Self(Depth::FirstAction)),
            _ => match text.parse() {
                Ok(actions) if actions > 0 => Ok(Self(Depth::Actions(actions))),
                _ => Err("expected `full`, `first-action` or a number of actions".to_owned()),
            },
        }
    }
}

impl fmt::Display for DepthOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Depth::Full => f.write_str("full"),
            Depth::FirstAction => f.write_str("first-action"),
            Depth::Actions(actions) => write!(f, "{actions}"),
        }
    }
}

fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(number) if number > 0 => Ok(number),
        _ => Err("expected a number of at least 1".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planner_is_read_as_it_is_written() {
        for text in ["graph", "naive"] {
            assert_eq!(text.parse::<PlannerOption>().unwrap().to_string(), text);
        }
        assert!("none".parse::<PlannerOption>().is_err());
        assert_eq!(PlannerOption::default().to_string(), "graph");
    }

    #[test]
    fn a_depth_is_read_as_it_is_written() {
        for text in ["full", "first-action", "3"] {
            assert_eq!(text.parse::<DepthOption>().unwrap().to_string(), text);
        }
        for text in ["", "0", "-1", "all"] {
            assert!(text.parse::<DepthOption>().is_err(), "{text}");
        }
    }
}
