//! A robot of this machine: the router in this process, and its roles as processes of their own.

mod alive;
mod back_off;
mod role_process;
mod state_dir;
mod supervisor;
mod temporary;
mod watched;

use std::collections::{BTreeMap, VecDeque};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

use agent_core::model::Symbol;
use agent_link::options::{LimitOptions, PlannerOptions};
use agent_link::registry::{Entry, Registry, RegistryError};
use agent_link::session::{self, Role, SessionError};
use agent_link::{Clock, Keys, Session};
use tokio::sync::mpsc;

use crate::exit::Failure;
use crate::security;

pub use role_process::RoleKind;
use state_dir::StateDir;
use supervisor::Supervisor;

/// All roles together; a busy machine may take its time to start four processes.
const PATIENCE: Duration = Duration::from_secs(60);

/// A world that has been started answers within this, unless something is wrong.
const PATIENCE_WITH_THE_CLOCK: Duration = Duration::from_secs(10);

/// A role that has not answered for so long is killed, unless the user says otherwise.
pub const HANG_LIMIT: Duration = Duration::from_secs(10);

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
    /// Where the roles keep their journals; `None` for a temporary directory that is gone at the end.
    pub state: Option<PathBuf>,
    /// Whether the world is started by others.
    pub world_elsewhere: bool,
    /// A role that has not answered for so long is killed and started again.
    pub hang_limit: Duration,
    /// The folder with settings for everybody, instead of `zenoh_config`.
    pub security: Option<PathBuf>,
    /// How much users may ask for.
    pub limits: LimitOptions,
    /// The vehicles of a restaurant: then there are a room and these, and no robot.
    pub vehicles: Vec<Symbol>,
    /// How many goals each vehicle works on at once, if not as many as it would.
    pub together: Option<NonZeroUsize>,
}

impl Setup {
    /// What there is to be looked after.
    pub fn roles(&self) -> Vec<RoleKind> {
        let all: Vec<RoleKind> = if self.vehicles.is_empty() {
            RoleKind::ALL.into()
        } else {
            let vehicles = self.vehicles.iter().cloned().map(RoleKind::Vehicle);
            std::iter::once(RoleKind::Room).chain(vehicles).collect()
        };
        let here = all.into_iter();
        here.filter(|role| !self.world_elsewhere || !role.is_reality())
            .collect()
    }

    /// The zenoh settings of a role, or of this process.
    fn zenoh_config_of(&self, name: &str) -> Option<PathBuf> {
        match &self.security {
            Some(folder) => Some(security::configuration_of(folder, name)),
            None => self.zenoh_config.clone(),
        }
    }
}

/// What becomes of the roles.
#[derive(Clone, Debug)]
pub enum RoleNews {
    /// A line on the standard error of one.
    Said(RoleKind, String),
    /// It is there.
    Ready {
        /// Which.
        role: RoleKind,
        /// Its process.
        pid: u32,
        /// How often it was started again.
        restarts: u32,
        /// How long it was missing, unless this is its first start.
        after: Option<Duration>,
    },
    /// Its process has ended.
    Ended {
        /// Which.
        role: RoleKind,
        /// The process that has ended.
        pid: u32,
        /// In words.
        how: String,
        /// When it is started again.
        next_in: Duration,
    },
    /// Its process runs, and does not answer.
    Silent {
        /// Which.
        role: RoleKind,
        /// Its process.
        pid: u32,
    },
    /// It answers again.
    Answers {
        /// Which.
        role: RoleKind,
        /// Its process.
        pid: u32,
    },
    /// It was killed, since it did not answer for so long.
    Killed {
        /// Which.
        role: RoleKind,
        /// Its process.
        pid: u32,
        /// How long.
        after: Duration,
    },
    /// It ends by itself whenever it is started.
    GivenUp {
        /// Which.
        role: RoleKind,
        /// How its last process ended, and what that said.
        how: String,
    },
}

/// [`RoleNews`], in the order in which it comes.
#[derive(Debug)]
pub struct News {
    /// What happened before all were ready.
    earlier: VecDeque<RoleNews>,
    queue: mpsc::UnboundedReceiver<RoleNews>,
}

impl News {
    /// The next. `None` once there can be no more.
    pub async fn next(&mut self) -> Option<RoleNews> {
        match self.earlier.pop_front() {
            Some(news) => Some(news),
            None => self.queue.recv().await,
        }
    }
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
    /// The process of each role when all were ready.
    pub processes: BTreeMap<RoleKind, u32>,
    /// What becomes of its roles.
    pub news: News,
    supervisor: Supervisor,
    _entry: Entry,
}

impl Robot {
    /// Starts all roles and returns once they are ready to take goals. `None` if it was `interrupted`
    /// before that.
    ///
    /// # Errors
    /// If the name or the state is taken, a port cannot be had, or a role does not come up. Nothing is
    /// left running then.
    pub async fn start(
        setup: &Setup,
        interrupted: impl Future<Output = ()>,
    ) -> Result<Option<Self>, Failure> {
        let keys = Keys::new(&setup.robot).map_err(Failure::bad_input)?;
        let registry = Registry::of_user().map_err(unregistered)?;
        let running = registry.running().map_err(unregistered)?;
        if let Some(same) = running.into_iter().find(|one| one.robot == setup.robot) {
            return Err(unregistered(RegistryError::Taken(same)));
        }
        let state = StateDir::take(setup.state.as_deref(), &setup.robot).await?;
        let role = if setup.connect.is_empty() {
            Role::Router {
                listen: setup.listen.clone(),
            }
        } else {
            Role::Client {
                connect: setup.connect.clone(),
            }
        };
        let name = match role {
            Role::Router { .. } => security::ROUTER,
            Role::Client { .. } => security::SUPERVISOR,
        };
        let session = session::open(&role, setup.zenoh_config_of(name).as_deref())
            .await
            .map_err(|error| not_opened(&error, setup))?;
        let endpoints = if setup.connect.is_empty() {
            session::endpoints(&session).await
        } else {
            setup.connect.clone()
        };
        let started = Self::with_session(
            setup,
            &session,
            keys,
            &registry,
            endpoints,
            state,
            interrupted,
        );
        let started = started.await;
        if !matches!(started, Ok(Some(_))) {
            session::close(session).await;
        }
        started
    }

    async fn with_session(
        setup: &Setup,
        session: &Session,
        keys: Keys,
        registry: &Registry,
        endpoints: Vec<String>,
        state: StateDir,
        interrupted: impl Future<Output = ()>,
    ) -> Result<Option<Self>, Failure> {
        let endpoint = endpoints
            .first()
            .cloned()
            .ok_or_else(|| Failure::failed("the router listens nowhere"))?;
        let entry = registry
            .enter(&setup.robot, &endpoint)
            .map_err(unregistered)?;
        let (tell, mut news) = mpsc::unbounded_channel();
        let supervisor = Supervisor::start(setup, state, session, &keys, endpoints, tell).await?;
        let mut earlier = VecDeque::new();
        let ready = async {
            let processes = all_ready(setup, &mut news, &mut earlier).await?;
            let clock = Clock::of_world(session, &keys, PATIENCE_WITH_THE_CLOCK)
                .await
                .map_err(Failure::failed)?;
            if setup.vehicles.is_empty() {
                alive::until_it_knows_where_it_stands(session, &keys).await?;
            }
            Ok((clock, processes))
        };
        let ready = tokio::select! {
            ready = ready => ready.map(Some),
            () = interrupted => Ok(None),
        };
        match ready {
            Ok(Some((clock, processes))) => Ok(Some(Self {
                session: session.clone(),
                keys,
                clock,
                endpoint,
                processes,
                news: News {
                    earlier,
                    queue: news,
                },
                supervisor,
                _entry: entry,
            })),
            Ok(None) => {
                supervisor.end().await;
                Ok(None)
            }
            Err(failure) => {
                supervisor.end().await;
                Err(failure)
            }
        }
    }

    /// Ends all roles, and returns when they have ended.
    pub async fn end(self) {
        self.supervisor.end().await;
        session::close(self.session).await;
    }
}

/// Waits until all roles are there, and returns their processes. What else happens is for later.
async fn all_ready(
    setup: &Setup,
    news: &mut mpsc::UnboundedReceiver<RoleNews>,
    earlier: &mut VecDeque<RoleNews>,
) -> Result<BTreeMap<RoleKind, u32>, Failure> {
    let all = setup.roles().len();
    let mut processes = BTreeMap::new();
    let coming = async {
        while processes.len() < all {
            let Some(one) = news.recv().await else {
                return Err(Failure::failed("no role has started"));
            };
            match &one {
                RoleNews::Ready {
                    role, pid, after, ..
                } => {
                    processes.insert(role.clone(), *pid);
                    if after.is_none() {
                        // That all have started is told at once.
                        continue;
                    }
                }
                RoleNews::Ended { role, .. } => {
                    processes.remove(role);
                }
                RoleNews::GivenUp { role, how } => {
                    return Err(Failure::failed(format_args!(
                        "{} did not start ({how})",
                        role.in_words()
                    )));
                }
                _ => {}
            }
            earlier.push_back(one);
        }
        Ok(processes)
    };
    match tokio::time::timeout(PATIENCE, coming).await {
        Ok(processes) => processes,
        Err(_) => Err(Failure::failed(format_args!(
            "not every role has come up within {PATIENCE:?}"
        ))
        .advice("try again with RUST_LOG=info to see what they do")),
    }
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
