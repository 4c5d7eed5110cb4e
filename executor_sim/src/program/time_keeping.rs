//! What the world and the room have in common as programs: each keeps the time for all others.

use std::time::Duration;

use agent_link::options::LinkOptions;
use agent_link::{Clock, Keys, LinkError, RoleError, Session, session};

/// Ten pictures a second look like motion …
const LONGEST_PERIOD: Duration = Duration::from_millis(100);
/// … but at high speed a robot is nowhere for long, and who waits to see it there must not miss it.
const WORLD_S_BETWEEN_SNAPSHOTS: f64 = 1.0;
/// More often is a load and no help.
const SHORTEST_PERIOD: Duration = Duration::from_millis(10);

/// How often a picture is published when `speed` seconds of the world pass in one.
pub(super) fn snapshots_every(speed: f64) -> Duration {
    let period = WORLD_S_BETWEEN_SNAPSHOTS / speed;
    let period = Duration::try_from_secs_f64(period).unwrap_or(LONGEST_PERIOD);
    period.clamp(SHORTEST_PERIOD, LONGEST_PERIOD)
}

/// Does `work` on a session of its own with a clock that goes on where it was stopped last, tells the
/// time to whoever asks for it meanwhile, and notes at the end what time it was.
///
/// # Errors
/// If there is no session or no clock, or `work` cannot go on.
pub(super) async fn keeping_time<T>(
    link: &LinkOptions,
    keys: &Keys,
    speed: f64,
    work: impl AsyncFnOnce(&Session, Clock) -> Result<T, LinkError>,
) -> Result<(), RoleError> {
    let noted = link.state_file("clock.json")?;
    let clock = match &noted {
        Some(file) => Clock::continued(file, speed)?,
        None => Clock::start(speed)?,
    };
    let session = link.open().await?;
    let driven = match clock.serve(&session, keys).await {
        Err(error) => Err(error.into()),
        Ok(_service) => work(&session, clock).await.map_err(RoleError::from),
    };
    session::close(session).await;
    if let Some(file) = &noted {
        clock.stop(file)?;
    }
    driven.map(|_| ())
}
