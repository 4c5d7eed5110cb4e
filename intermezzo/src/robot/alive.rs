//! Waiting until a robot is ready.

use std::time::Duration;

use agent_link::{Client, Keys, Session, View};

use super::RoleKind;
use crate::exit::Failure;

/// A controller that is there has heard from its world within this.
const PATIENCE: Duration = Duration::from_secs(30);

/// Between two looks at the controller.
const RETRY: Duration = Duration::from_millis(20);

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
