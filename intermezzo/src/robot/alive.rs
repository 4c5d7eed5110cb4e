//! Waiting until a robot is ready.

use std::collections::BTreeSet;
use std::time::Duration;

use agent_link::{Client, Keys, Session, View};
use zenoh::sample::SampleKind;

use super::RoleKind;
use crate::exit::Failure;

/// All roles together; a busy machine may take its time to start four processes.
const PATIENCE: Duration = Duration::from_secs(30);

/// Between two looks at the controller.
const RETRY: Duration = Duration::from_millis(20);

/// Returns once every role has said that it is there, which it does when it listens.
pub(super) async fn until_all_are_there(session: &Session, keys: &Keys) -> Result<(), Failure> {
    let network = |error| Failure::failed(format_args!("cannot see who is there: {error}"));
    let tokens = session
        .liveliness()
        .declare_subscriber(keys.alive_any())
        .history(true)
        .await
        .map_err(network)?;
    let mut missing: BTreeSet<&str> = RoleKind::ALL.map(RoleKind::name).into();
    let seeing = async {
        while !missing.is_empty() {
            let token = tokens.recv_async().await.map_err(network)?;
            let key = token.key_expr().as_str();
            // What goes again does so with its process, of which there are other news.
            if token.kind() == SampleKind::Put
                && let Some((role, _)) = Keys::read_alive(key)
            {
                missing.remove(role);
            }
        }
        Ok(())
    };
    match tokio::time::timeout(PATIENCE, seeing).await {
        Ok(seen) => seen,
        Err(_) => Err(Failure::failed(format_args!(
            "not every role has come up within {PATIENCE:?}"
        ))
        .advice("try again with RUST_LOG=info to see what they do")),
    }
}

/// Returns once the controller has heard from its sensors; before that it accepts nothing.
pub(super) async fn until_it_knows_where_it_stands(
    session: &Session,
    keys: &Keys,
) -> Result<(), Failure> {
    let client = Client::new(session, keys);
    let looking = async {
        loop {
            let status = client
                .look(RoleKind::Executor.name(), View::Status)
                .await
                .map_err(Failure::failed)?;
            if !status["stood"].is_null() {
                return Ok(());
            }
            tokio::time::sleep(RETRY).await;
        }
    };
    match tokio::time::timeout(PATIENCE, looking).await {
        Ok(looked) => looked,
        Err(_) => Err(Failure::failed(format_args!(
            "the robot has not said within {PATIENCE:?} where it stands"
        ))),
    }
}
