//! The robot that a command is for.

use std::path::{Path, PathBuf};

use agent_link::options::DEFAULT_ROBOT;
use agent_link::registry::{Registry, RegistryError, RunningRobot};
use agent_link::session::{self, Role, SessionError};
use agent_link::{Client, ClientError, Keys, Session};

use crate::cli::Target;
use crate::exit::Failure;

/// A connection to one robot.
pub(crate) struct Connection {
    pub(crate) session: Session,
    pub(crate) keys: Keys,
    pub(crate) client: Client,
    /// Where the robot was found, if it was looked for on this machine.
    pub(crate) found_at: Option<String>,
    /// Zenoh settings.
    pub(crate) file: Option<PathBuf>,
}

impl Connection {
    /// Finds the robot and connects to it.
    ///
    /// # Errors
    /// If there is none, or none of that name, or nobody answers where it should be.
    pub(crate) async fn open(target: &Target) -> Result<Self, Failure> {
        let named = target.robot.as_deref();
        let file = target.zenoh_config.as_deref();
        let named_there = match file {
            None => false,
            Some(file) => session::names_routers(file).map_err(Failure::bad_input)?,
        };
        if target.connect.is_empty() && !named_there {
            let running = Registry::of_user()
                .and_then(|registry| registry.find(named))
                .map_err(not_found)?;
            return Self::to(running, file).await;
        }
        let robot = named.unwrap_or(DEFAULT_ROBOT);
        Self::connect(robot, target.connect.clone(), file).await
    }

    /// Connects to a robot of this machine.
    ///
    /// # Errors
    /// If nobody answers where it should be.
    pub(crate) async fn to(running: RunningRobot, file: Option<&Path>) -> Result<Self, Failure> {
        let connect = vec![running.endpoint.clone()];
        let mut connection = Self::connect(&running.robot, connect, file).await?;
        connection.found_at = Some(running.endpoint);
        Ok(connection)
    }

    async fn connect(
        robot: &str,
        connect: Vec<String>,
        file: Option<&Path>,
    ) -> Result<Self, Failure> {
        let keys = Keys::new(robot).map_err(Failure::bad_input)?;
        let session = session::open(&Role::Client { connect }, file)
            .await
            .map_err(|error| match error {
                SessionError::ConfigFile { .. } | SessionError::Setting { .. } => {
                    Failure::bad_input(error)
                }
                _ => Failure::nobody_there(error).advice(
                    "is the robot's router there, and may this machine and this user reach it?",
                ),
            })?;
        Ok(Self {
            client: Client::new(&session, &keys),
            session,
            keys,
            found_at: None,
            file: file.map(Path::to_owned),
        })
    }

    /// Hands `result` on once the session is closed.
    pub(crate) async fn close<T>(self, result: Result<T, Failure>) -> Result<T, Failure> {
        session::close(self.session).await;
        result
    }
}

/// What a question without an answer means to the user.
pub(crate) fn unanswered(error: ClientError) -> Failure {
    match error {
        ClientError::NoAnswer { .. } => Failure::nobody_there(error).advice(
            "`intermezzo status` shows who is there; a robot that just starts needs a second",
        ),
        ClientError::Name(_) => Failure::bad_input(error),
        _ => Failure::failed(error),
    }
}

fn not_found(error: RegistryError) -> Failure {
    match &error {
        RegistryError::NoneRunning => Failure::nobody_there("no robot is running on this machine")
            .advice("start one with `intermezzo up`, or name one elsewhere with --connect"),
        RegistryError::NotRunning { .. } => Failure::nobody_there(error),
        RegistryError::Several { .. } | RegistryError::Name(_) => Failure::bad_input(error),
        _ => Failure::failed(error),
    }
}
