//! Opening and closing zenoh with settings that keep to themselves.

use std::path::Path;
use std::time::Duration;

use zenoh::Config;
pub use zenoh::Session;

/// A process that is gone is noticed at once; one that hangs, after this long.
const LEASE_MS: u32 = 2000;

/// How long a client tries to reach its router before it gives up.
const CONNECT_TIMEOUT_MS: u32 = 5000;

/// A session that does not close within this is left behind.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);

/// Zenoh gives up no sooner than this on a router that cannot bind.
const OPEN_TIMEOUT: Duration = Duration::from_secs(15);

/// Which end of the tree a process is.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Role {
    /// Carries the messages of all others. There is one for each robot, within `intermezzo up`.
    Router {
        /// Where to listen. Empty: as the configuration file says, else on a free port of this
        /// machine that no other machine can reach.
        listen: Vec<String>,
    },
    /// Connects to a router and listens nowhere.
    Client {
        /// Where routers listen. Empty: as the configuration file says.
        connect: Vec<String>,
    },
}

/// Why there is no session.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The user's file.
    #[error("cannot read the zenoh configuration {path}: {why}")]
    ConfigFile {
        /// Where it is.
        path: String,
        /// In zenoh's words.
        why: zenoh::Error,
    },
    /// A setting that zenoh does not take.
    #[error("zenoh refuses the setting {key} = {value}: {why}")]
    Setting {
        /// Which.
        key: &'static str,
        /// To what.
        value: String,
        /// In zenoh's words.
        why: zenoh::Error,
    },
    /// Nowhere to connect to.
    #[error("no router to connect to: name one, or start a robot with `intermezzo up`")]
    NoEndpoint,
    /// Nobody there, no permission, or the port is taken.
    #[error("cannot open a session ({role}): {why}")]
    Open {
        /// What was tried.
        role: String,
        /// In zenoh's words.
        why: String,
    },
}

/// Opens a session.
///
/// `file` is a zenoh configuration (JSON5) for what this project does not decide: TLS, passwords,
/// access control, endpoints on other machines. On top of it only that is set which it leaves open,
/// save that the role decides the mode and a client never listens.
pub async fn open(role: &Role, file: Option<&Path>) -> Result<Session, SessionError> {
    let config = config(role, file)?;
    let failed = |why: String| SessionError::Open {
        role: match role {
            Role::Router { listen } => format!("listening on {listen:?}"),
            Role::Client { connect } => format!("connecting to {connect:?}"),
        },
        why,
    };
    match tokio::time::timeout(OPEN_TIMEOUT, zenoh::open(config)).await {
        Ok(Ok(session)) => Ok(session),
        Ok(Err(why)) => Err(failed(why.to_string())),
        Err(_) => Err(failed(format!("nothing happened for {OPEN_TIMEOUT:?}"))),
    }
}

/// Whether a zenoh configuration says where routers are.
///
/// # Errors
/// If it cannot be read.
pub fn names_routers(file: &Path) -> Result<bool, SessionError> {
    let config = read(file)?;
    Ok(!is_default(&config, "connect/endpoints"))
}

fn read(path: &Path) -> Result<Config, SessionError> {
    let mut config = Config::from_file(path).map_err(|why| SessionError::ConfigFile {
        path: path.display().to_string(),
        why,
    })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    for key in FILES {
        beside(&mut config, key, folder)?;
    }
    Ok(config)
}

/// Settings that name files.
const FILES: [&str; 6] = [
    "transport/auth/usrpwd/dictionary_file",
    "transport/link/tls/root_ca_certificate",
    "transport/link/tls/listen_certificate",
    "transport/link/tls/listen_private_key",
    "transport/link/tls/connect_certificate",
    "transport/link/tls/connect_private_key",
];

/// Certificates and passwords lie beside the file that names them, wherever it is used from. What
/// does not lie there is looked for where zenoh looks, in the working directory.
fn beside(config: &mut Config, key: &'static str, folder: &Path) -> Result<(), SessionError> {
    let named = config.get_json(key).ok();
    let named = named.and_then(|json| serde_json::from_str::<Option<String>>(&json).ok()?);
    let Some(named) = named else { return Ok(()) };
    let found = folder.join(named);
    if !found.exists() {
        return Ok(());
    }
    let found = serde_json::Value::from(found.to_string_lossy()).to_string();
    set(config, key, &found)
}

/// What zenoh is told.
fn config(role: &Role, file: Option<&Path>) -> Result<Config, SessionError> {
    let mut config = match file {
        None => Config::default(),
        Some(path) => read(path)?,
    };
    match role {
        Role::Router { listen } => {
            set(&mut config, "mode", "\"router\"")?;
            if !listen.is_empty() {
                set(&mut config, "listen/endpoints", &list(listen))?;
            } else if file.is_none() || is_default(&config, "listen/endpoints") {
                // Zenoh's own default is every interface of the machine.
                set(&mut config, "listen/endpoints", "[\"tcp/127.0.0.1:0\"]")?;
            }
        }
        Role::Client { connect } => {
            set(&mut config, "mode", "\"client\"")?;
            set(&mut config, "listen/endpoints", "[]")?;
            if !connect.is_empty() {
                set(&mut config, "connect/endpoints", &list(connect))?;
            } else if is_default(&config, "connect/endpoints") {
                return Err(SessionError::NoEndpoint);
            }
        }
    }
    // With the defaults, every process finds and is found by all zenoh in the building.
    for key in ["scouting/multicast/enabled", "scouting/gossip/enabled"] {
        if is_default(&config, key) {
            set(&mut config, key, "false")?;
        }
    }
    let connect_timeout_ms = CONNECT_TIMEOUT_MS.to_string();
    let lease_ms = LEASE_MS.to_string();
    for (key, value) in [
        ("connect/timeout_ms", connect_timeout_ms.as_str()),
        // A router that is back is found within a fifth of a second, not within four.
        (
            "connect/retry",
            "{period_init_ms:50,period_max_ms:200,period_increase_factor:2}",
        ),
    ] {
        if is_default(&config, key) {
            set(&mut config, key, value)?;
        }
    }
    // The lease that counts is the one announced by the side that is watched, so both have it.
    if file.is_none() || is_default(&config, "transport/link/tx/lease") {
        set(&mut config, "transport/link/tx/lease", &lease_ms)?;
    }
    Ok(config)
}

/// Whether a setting is as zenoh has it by itself.
fn is_default(config: &Config, key: &str) -> bool {
    match (config.get_json(key), Config::default().get_json(key)) {
        (Ok(value), Ok(default)) => value == default,
        _ => true,
    }
}

fn set(config: &mut Config, key: &'static str, value: &str) -> Result<(), SessionError> {
    config
        .insert_json5(key, value)
        .map_err(|why| SessionError::Setting {
            key,
            value: value.to_owned(),
            why,
        })
}

/// As JSON.
fn list(endpoints: &[String]) -> String {
    serde_json::Value::from(endpoints).to_string()
}

/// Where a router can be reached: the ports that it was given, in the form that clients take.
pub async fn endpoints(session: &Session) -> Vec<String> {
    let locators = session.info().locators().await;
    locators.iter().map(ToString::to_string).collect()
}

/// Closes a session, but does not wait for one that will not close.
pub async fn close(session: Session) {
    match tokio::time::timeout(CLOSE_TIMEOUT, session.close()).await {
        Ok(Ok(())) => {}
        Ok(Err(why)) => tracing::warn!("the session did not close in order: {why}"),
        Err(_) => tracing::warn!("the session did not close within {CLOSE_TIMEOUT:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn get(config: &Config, key: &str) -> String {
        config.get_json(key).unwrap()
    }

    #[test]
    fn nothing_listens_beyond_this_machine_unless_told() {
        let router = config(&Role::Router { listen: vec![] }, None).unwrap();
        assert_eq!(get(&router, "listen/endpoints"), r#"["tcp/127.0.0.1:0"]"#);
        assert_eq!(get(&router, "scouting/multicast/enabled"), "false");
        let client = Role::Client {
            connect: vec!["tcp/127.0.0.1:7447".to_owned()],
        };
        let client = config(&client, None).unwrap();
        assert_eq!(get(&client, "listen/endpoints"), "[]");
        assert_eq!(get(&client, "mode"), "\"client\"");
        assert_eq!(get(&client, "transport/link/tx/lease"), "2000");
        assert_eq!(get(&client, "connect/timeout_ms"), "5000");
    }

    #[test]
    fn a_users_file_keeps_what_it_says() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("zenoh.json5");
        std::fs::write(
            &path,
            r#"{ mode: "peer", // overruled by the role
                listen: { endpoints: ["tcp/127.0.0.1:17999"] },
                connect: { endpoints: ["tls/robot.example:7447"] },
                transport: { link: { tx: { lease: 7000 } },
                             auth: { usrpwd: { user: "operator", password: "x" } } } }"#,
        )
        .unwrap();
        let router = config(&Role::Router { listen: vec![] }, Some(&path)).unwrap();
        assert_eq!(get(&router, "mode"), "\"router\"");
        assert_eq!(
            get(&router, "listen/endpoints"),
            r#"["tcp/127.0.0.1:17999"]"#
        );
        assert_eq!(get(&router, "transport/link/tx/lease"), "7000");
        assert_eq!(get(&router, "transport/auth/usrpwd/user"), "\"operator\"");
        assert_eq!(get(&router, "scouting/gossip/enabled"), "false");
        let client = config(&Role::Client { connect: vec![] }, Some(&path)).unwrap();
        assert_eq!(
            get(&client, "connect/endpoints"),
            r#"["tls/robot.example:7447"]"#
        );
        assert_eq!(get(&client, "listen/endpoints"), "[]");
    }

    #[test]
    fn certificates_and_passwords_lie_beside_the_file_that_names_them() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("router.json5");
        std::fs::write(
            &path,
            r#"{ transport: { auth: { usrpwd: { dictionary_file: "credentials.txt" } },
                 link: { tls: { root_ca_certificate: "elsewhere/ca.pem" } } } }"#,
        )
        .unwrap();
        let credentials = directory.path().join("credentials.txt");
        std::fs::write(&credentials, "a:b").unwrap();
        let config = read(&path).unwrap();
        let found = get(&config, "transport/auth/usrpwd/dictionary_file");
        assert_eq!(found, format!("{credentials:?}"));
        let elsewhere = get(&config, "transport/link/tls/root_ca_certificate");
        assert_eq!(elsewhere, r#""elsewhere/ca.pem""#);
    }

    #[test]
    fn a_client_needs_somewhere_to_go_and_a_file_must_be_readable() {
        let error = config(&Role::Client { connect: vec![] }, None).unwrap_err();
        assert!(matches!(error, SessionError::NoEndpoint));
        let error = config(
            &Role::Router { listen: vec![] },
            Some(Path::new("/no/file.json5")),
        );
        assert!(error.unwrap_err().to_string().contains("/no/file.json5"));
    }
}
