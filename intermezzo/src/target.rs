//! The robot that a command is for.

use std::path::PathBuf;

use agent_link::options::DEFAULT_ROBOT;
use agent_link::registry::{Registry, RegistryError, RunningRobot};
use agent_link::session::{self, Role, SessionError};
use agent_link::{Client, ClientError, Keys, Session};

use crate::cli::Target;
use crate::exit::Failure;
use crate::security;

/// A connection to one robot.
pub(crate) struct Connection {
    pub(crate) session: Session,
    pub(crate) keys: Keys,
    pub(crate) client: Client,
    /// Where the robot was found, if it was looked for on this machine.
    pub(crate) found_at: Option<String>,
    /// Who asks.
    pub(crate) identity: Identity,
}

/// Who asks, and how they prove it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Identity {
    /// Zenoh settings.
    file: Option<PathBuf>,
    /// Their name, if they have one.
    name: Option<String>,
}

impl Connection {
    /// Finds the robot and connects to it.
    ///
    /// # Errors
    /// If there is none, or none of that name, or nobody answers where it should be.
    pub(crate) async fn open(target: &Target) -> Result<Self, Failure> {
        let named = target.robot.as_deref();
        let identity = identity(target)?;
        let named_there = match identity.file.as_deref() {
            None => false,
            Some(file) => session::names_routers(file).map_err(Failure::bad_input)?,
        };
        if target.connect.is_empty() && !named_there {
            let running = Registry::of_user()
                .and_then(|registry| registry.find(named))
                .map_err(not_found)?;
            return Self::to(running, &identity).await;
        }
        let robot = named.unwrap_or(DEFAULT_ROBOT);
        Self::connect(robot, target.connect.clone(), &identity).await
    }

    /// Connects to a robot of this machine.
    ///
    /// # Errors
    /// If nobody answers where it should be.
    pub(crate) async fn to(running: RunningRobot, identity: &Identity) -> Result<Self, Failure> {
        let connect = vec![running.endpoint.clone()];
        let mut connection = Self::connect(&running.robot, connect, identity).await?;
        connection.found_at = Some(running.endpoint);
        Ok(connection)
    }

    async fn connect(
        robot: &str,
        connect: Vec<String>,
        identity: &Identity,
    ) -> Result<Self, Failure> {
        let keys = Keys::new(robot).map_err(Failure::bad_input)?;
        let session = session::open(&Role::Client { connect }, identity.file.as_deref())
            .await
            .map_err(|error| match error {
                SessionError::ConfigFile { .. } | SessionError::Setting { .. } => {
                    Failure::bad_input(error)
                }
                _ => Failure::nobody_there(format_args!(
                    "no answer: not reachable or not permitted: {error}"
                ))
                .advice(
                    "is the robot's router there, does it take this user (--security, --as), and is it reached by a name that its certificate has (`intermezzo certs --name`)?",
                ),
            })?;
        let client = Client::new(&session, &keys);
        Ok(Self {
            client: match &identity.name {
                Some(name) => client.named(name),
                None => client,
            },
            session,
            keys,
            found_at: None,
            identity: identity.clone(),
        })
    }

    /// Hands `result` on once the session is closed.
    pub(crate) async fn close<T>(self, result: Result<T, Failure>) -> Result<T, Failure> {
        session::close(self.session).await;
        result
    }
}

/// Who asks, as the options say.
fn identity(target: &Target) -> Result<Identity, Failure> {
    let Some(folder) = &target.security else {
        return Ok(Identity {
            file: target.zenoh_config.clone(),
            name: target.user.clone(),
        });
    };
    let usual = || security::usual_user(folder).to_owned();
    let name = target.user.clone().unwrap_or_else(usual);
    Keys::new(&name).map_err(Failure::bad_input)?;
    let file = security::configuration_of(folder, &name);
    if !file.exists() {
        let what = format!("{} has nothing for `{name}`", folder.display());
        return Err(Failure::bad_input(what).advice(
            "--as NAME for somebody else; `intermezzo certs` and `intermezzo passwords` make such folders",
        ));
    }
    Ok(Identity {
        file: Some(file),
        name: Some(name),
    })
}

/// What a question without an answer means to the user.
pub(crate) fn unanswered(error: ClientError) -> Failure {
    match error {
        ClientError::NoAnswer { .. } => Failure::nobody_there(error).advice(
            "`intermezzo status` shows who is there; a robot that just starts needs a second; with --security, --as says who asks",
        ),
        ClientError::Name(_) => Failure::bad_input(error),
        _ => Failure::failed(error),
    }
}

/// The same, of a question to one in particular: perhaps there is nobody of that name.
pub(crate) async fn unanswered_by(client: &Client, whom: &str, error: ClientError) -> Failure {
    let alive = match (&error, client.alive().await) {
        (ClientError::NoAnswer { .. }, Ok(alive)) => alive,
        _ => return unanswered(error),
    };
    let mut names: Vec<&str> = alive.iter().map(|(name, _)| name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    if names.is_empty() || names.contains(&whom) {
        return unanswered(error);
    }
    let what = format!("there is no `{whom}` here: there are {}", names.join(", "));
    Failure::nobody_there(what)
}

/// Nobody of a robot is seen.
pub(crate) fn nobody(keys: &Keys) -> Failure {
    Failure::nobody_there(format_args!(
        "no answer: not reachable or not permitted (nobody of robot `{}` is seen)",
        keys.robot()
    ))
    .advice("check the name (--robot), the address (--connect) and who asks (--as)")
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
