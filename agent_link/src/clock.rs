//! The world's clock: one time for all processes of a robot, simulated or not.

use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use agent_core::model::Time;
use serde::{Deserialize, Serialize};
use tokio::runtime::Handle;
use zenoh::Session;
use zenoh::query::Queryable;

use crate::keys::Keys;
use crate::question::Question;
use crate::wire::{self, VERSION, WireError};

/// Between two attempts to hear from the world.
const RETRY: Duration = Duration::from_millis(100);

/// An attempt.
const QUERY_TIMEOUT: Duration = Duration::from_secs(1);

/// World time: seconds since the world began, times its speed.
///
/// The beginning is a date, so that processes agree without asking again. Within a process time
/// then follows the monotonic clock: a date that is corrected does not make it go back.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    origin_unix_us: u64,
    speed: f64,
    anchor: Instant,
    at_anchor: Time,
}

/// What the world answers about its clock.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct ClockMessage {
    v: u32,
    origin_unix_us: u64,
    speed: f64,
}

/// Why there is no time.
#[derive(Debug, thiserror::Error)]
pub enum ClockError {
    /// Nothing runs at this or any speed.
    #[error("a world cannot run at speed {0}: it takes a number above zero")]
    Speed(f64),
    /// The world is not there.
    #[error(
        "no world of robot `{robot}` answered on {key} within {waited_s:.0} s: it is not running, not reachable from here, or not permitted to answer"
    )]
    NoWorld {
        /// Whose.
        robot: String,
        /// Where it was asked.
        key: String,
        /// How long.
        waited_s: f64,
    },
    /// The world speaks otherwise.
    #[error("cannot make sense of the world's clock: {0}")]
    Unreadable(#[from] WireError),
    /// zenoh.
    #[error("cannot ask for the world's clock: {0}")]
    Zenoh(zenoh::Error),
}

impl Clock {
    /// A world that begins now.
    pub fn start(speed: f64) -> Result<Self, ClockError> {
        Self::new(unix_us(), speed)
    }

    fn new(origin_unix_us: u64, speed: f64) -> Result<Self, ClockError> {
        if !(speed.is_finite() && speed > 0.0) {
            return Err(ClockError::Speed(speed));
        }
        let since_origin_us = unix_us().saturating_sub(origin_unix_us);
        Ok(Self {
            origin_unix_us,
            speed,
            anchor: Instant::now(),
            at_anchor: Time::from_secs(since_origin_us as f64 / 1e6 * speed),
        })
    }

    /// The clock of the world that a robot lives in; asks until it is answered or `patience` ends.
    pub async fn of_world(
        session: &Session,
        keys: &Keys,
        patience: Duration,
    ) -> Result<Self, ClockError> {
        let asked = Instant::now();
        while asked.elapsed() < patience {
            let replies = session
                .get(keys.clock())
                .timeout(QUERY_TIMEOUT.min(patience))
                .await
                .map_err(ClockError::Zenoh)?;
            if let Ok(reply) = replies.recv_async().await
                && let Ok(sample) = reply.result()
            {
                let message: ClockMessage = wire::read("clock", &sample.payload().to_bytes())?;
                return Self::new(message.origin_unix_us, message.speed);
            }
            tokio::time::sleep(RETRY).await;
        }
        Err(ClockError::NoWorld {
            robot: keys.robot().to_owned(),
            key: keys.clock(),
            waited_s: patience.as_secs_f64(),
        })
    }

    /// Answers all who ask for the time of this world, for as long as the result is kept.
    pub async fn serve(&self, session: &Session, keys: &Keys) -> Result<ClockService, ClockError> {
        let answer = wire::write(&ClockMessage {
            v: VERSION,
            origin_unix_us: self.origin_unix_us,
            speed: self.speed,
        })?;
        let runtime = Handle::current();
        let key: Arc<str> = Arc::from(keys.clock());
        let queryable = session
            .declare_queryable(keys.clock())
            .complete(true)
            .callback(move |query| {
                Question::new(query, &runtime, key.clone()).answer(Ok(answer.clone()));
            })
            .await
            .map_err(ClockError::Zenoh)?;
        Ok(ClockService {
            _queryable: queryable,
        })
    }

    /// World time. Never goes back.
    pub fn now(&self) -> Time {
        self.at_anchor + Time::from_secs(self.anchor.elapsed().as_secs_f64() * self.speed)
    }

    /// How many seconds of the world go into one.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Returns when world time `until` has come; at once, if it has.
    pub async fn sleep_until(&self, until: Time) {
        // A timer is as exact as a millisecond, which matters at high speeds: look again.
        loop {
            let left = until.since(self.now());
            if left == Time::ZERO {
                return;
            }
            let real_s = (left.secs() / self.speed).min(MAX_SLEEP.as_secs_f64());
            tokio::time::sleep(Duration::from_secs_f64(real_s)).await;
        }
    }
}

/// No timer is set further ahead; whoever waits longer looks again.
const MAX_SLEEP: Duration = Duration::from_secs(3600);

/// Answers for the world's clock while it lives.
pub struct ClockService {
    _queryable: Queryable<()>,
}

/// A new and greater number at every start of a process, in milliseconds since 1970.
pub fn epoch_now() -> u64 {
    unix_us() / 1000
}

/// The date, in microseconds since 1970.
fn unix_us() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    // A date before 1970 is a clock that was never set.
    since.map_or(0, |since| {
        u64::try_from(since.as_micros()).unwrap_or(u64::MAX)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn world_time_runs_at_its_speed_and_waits_for_what_is_to_come() {
        let clock = Clock::start(100.0).unwrap();
        let until = clock.now() + Time::from_secs(2.0);
        let waited = Instant::now();
        clock.sleep_until(until).await;
        assert!(clock.now() >= until);
        assert!(waited.elapsed() >= Duration::from_millis(15));
        // What has passed is not waited for.
        clock.sleep_until(Time::ZERO).await;
    }

    #[test]
    fn two_processes_agree_on_the_time_and_no_world_stands_still() {
        let world = Clock::start(4.0).unwrap();
        let agent = Clock::new(world.origin_unix_us, world.speed).unwrap();
        let apart_s = (agent.now().secs() - world.now().secs()).abs();
        assert!(apart_s < 0.5, "{apart_s} s apart");
        for speed in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Clock::start(speed).is_err());
        }
    }
}
