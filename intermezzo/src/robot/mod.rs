//! A robot of this machine: the router in this process, and its roles as processes of their own.

mod alive;
mod role_process;

use std::path::PathBuf;
use std::time::Duration;

use agent_link::options::PlannerOptions;
use agent_link::registry::{Entry, Registry, RegistryError};
use agent_link::session::{self, Role, SessionError};
use agent_link::{Clock, Keys, Session};
use tokio::sync::mpsc;

use crate::exit::Failure;

use role_process::RoleProcess;
pub use role_process::{RoleKind, RoleNews};

/// A world that has been started answers within this, unless something is wrong.
const PATIENCE_WITH_THE_CLOCK: Duration = Duration::from_secs(10);

/// What a robot is started with.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Its name.
    pub robot: String,
    /// The folder of its place; `None` for the museum.
    pub place: Option<PathBuf>,
    /// Where it begins.
    pub start: String,
    /// Seconds of the world in one.
    pub speed: f64,
    /// How its agents plan.
    pub planner: PlannerOptions,
    /// The seed of what goes wrong, if anything does.
    pub faults: Option<u64>,
    /// Where its router listens; empty for a free port of this machine.
    pub listen: Vec<String>,
    /// Routers to use instead of one in this process.
    pub connect: Vec<String>,
    /// Zenoh settings.
    pub zenoh_config: Option<PathBuf>,
}

/// A robot that runs.
#[derive(Debug)]
pub struct Robot {
    /// With its roles.
    pub session: Session,
    /// Its keys.
    pub keys: Keys,
    /// The time of its world.
    pub clock: Clock,
    /// Where others reach it.
    pub endpoint: String,
    /// What its processes say and how they end.
    pub news: mpsc::UnboundedReceiver<RoleNews>,
    roles: Vec<RoleProcess>,
    _entry: Entry,
}

impl Robot {
    /// Starts all roles and returns once they are ready to take goals.
    ///
    /// # Errors
    /// If the name is taken, a port cannot be had, or a role does not come up. Nothing is left
    /// running then.
    pub async fn start(setup: &Setup) -> Result<Self, Failure> {
        let keys = Keys::new(&setup.robot).map_err(Failure::bad_input)?;
        let registry = Registry::of_user().map_err(unregistered)?;
        let running = registry.running().map_err(unregistered)?;
        if let Some(same) = running.into_iter().find(|one| one.robot == setup.robot) {
            return Err(unregistered(RegistryError::Taken(same)));
        }
        let role = if setup.connect.is_empty() {
            Role::Router {
                listen: setup.listen.clone(),
            }
        } else {
            Role::Client {
                connect: setup.connect.clone(),
            }
        };
        let session = session::open(&role, setup.zenoh_config.as_deref())
            .await
            .map_err(|error| not_opened(&error, setup))?;
        let endpoints = if setup.connect.is_empty() {
            session::endpoints(&session).await
        } else {
            setup.connect.clone()
        };
        match Self::with_session(setup, &session, keys, &registry, endpoints).await {
            Ok(robot) => Ok(robot),
            Err(failure) => {
                session::close(session).await;
                Err(failure)
            }
        }
    }

    async fn with_session(
        setup: &Setup,
        session: &Session,
        keys: Keys,
        registry: &Registry,
        endpoints: Vec<String>,
    ) -> Result<Self, Failure> {
        let endpoint = endpoints
            .first()
            .cloned()
            .ok_or_else(|| Failure::failed("the router listens nowhere"))?;
        let entry = registry
            .enter(&setup.robot, &endpoint)
            .map_err(unregistered)?;
        let (tell, mut news) = mpsc::unbounded_channel();
        let mut roles = Vec::new();
        for kind in RoleKind::ALL {
            roles.push(RoleProcess::start(kind, setup, &endpoints, &tell)?);
        }
        let ready = async {
            alive::until_all_are_there(session, &keys).await?;
            let clock = Clock::of_world(session, &keys, PATIENCE_WITH_THE_CLOCK)
                .await
                .map_err(Failure::failed)?;
            alive::until_it_knows_where_it_stands(session, &keys).await?;
            Ok(clock)
        };
        let ready = tokio::select! {
            ready = ready => ready,
            failure = first_end(&mut news) => Err(failure),
        };
        match ready {
            Ok(clock) => Ok(Self {
                session: session.clone(),
                keys,
                clock,
                endpoint,
                news,
                roles,
                _entry: entry,
            }),
            Err(failure) => {
                role_process::end_all(roles).await;
                Err(failure)
            }
        }
    }

    /// The process of each role, for people who want to see what becomes of it.
    pub fn processes(&self) -> impl Iterator<Item = (RoleKind, u32)> {
        self.roles.iter().map(|role| (role.kind, role.pid))
    }

    /// Ends all roles, and returns when they have ended.
    pub async fn end(self) {
        role_process::end_all(self.roles).await;
        session::close(self.session).await;
    }
}

/// Waits for a role that ends before all are there, and says what it said.
async fn first_end(news: &mut mpsc::UnboundedReceiver<RoleNews>) -> Failure {
    let mut said = Vec::new();
    while let Some(one) = news.recv().await {
        match one {
            RoleNews::Said(kind, line) => said.push(format!("{kind}: {line}")),
            RoleNews::Ended(kind, how) => {
                let mut what = format!("the {kind} did not start ({how})");
                for line in said {
                    what.push('\n');
                    what.push_str(&line);
                }
                return Failure::failed(what);
            }
        }
    }
    Failure::failed("no role has started")
}

fn not_opened(error: &SessionError, setup: &Setup) -> Failure {
    match error {
        SessionError::ConfigFile { .. } | SessionError::Setting { .. } => {
            Failure::bad_input(error)
        }
        _ if setup.connect.is_empty() => Failure::failed(error).advice(
            "is the address this machine's, and the port free? Without --listen a free one is taken",
        ),
        _ => Failure::nobody_there(error)
            .advice("is there a router, and may this machine reach it?"),
    }
}

fn unregistered(error: RegistryError) -> Failure {
    match error {
        RegistryError::Taken(_) | RegistryError::Name(_) => Failure::bad_input(error),
        _ => Failure::failed(error),
    }
}
