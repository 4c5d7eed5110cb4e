//! The world's clock: one time for all processes of a robot, simulated or not.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
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

/// Roles that are told to end with their world have ended after this long.
const LAST_TO_END: Duration = Duration::from_secs(6);

/// No note is longer; what is, is not ours.
const MAX_NOTE_BYTES: u64 = 4096;

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

/// What a world notes of its clock, for its next start.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ClockNote {
    v: u32,
    origin_unix_us: u64,
    speed: f64,
    /// When it has ended in order; `None` while it runs, or if it was killed.
    stopped_unix_us: Option<u64>,
}

/// Why there is no time.
#[derive(Debug, thiserror::Error)]
pub enum ClockError {
    /// The file system.
    #[error("cannot keep the world's time in {}: {why}", path.display())]
    Io {
        /// Where.
        path: PathBuf,
        /// In the system's words.
        why: io::Error,
    },
    /// Not what a world has noted.
    #[error("{} does not say what time it is: {why}; without it, and without the journals beside it, time begins anew", path.display())]
    Note {
        /// Where.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
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

    /// The clock that was noted in `file`, or one that begins now.
    ///
    /// A world that was killed has missed nothing: time went on for all others. One that has ended in
    /// order has stopped it for all, at the latest when the last of them has ended.
    ///
    /// # Errors
    /// If the file makes no sense or cannot be written.
    pub fn continued(file: &Path, speed: f64) -> Result<Self, ClockError> {
        let now_us = unix_us();
        let origin_unix_us = match read_note(file)? {
            None => now_us,
            Some(note) => {
                let longest = note.stopped_unix_us.unwrap_or(now_us);
                let until = now_us.min(longest.saturating_add(LAST_TO_END.as_micros() as u64));
                let paused_us = now_us - until;
                let passed_us = until.saturating_sub(note.origin_unix_us);
                if note.speed.to_bits() == speed.to_bits() {
                    note.origin_unix_us.saturating_add(paused_us)
                } else {
                    // The same time, which passes otherwise from now on.
                    let passed_us = passed_us as f64 * note.speed / speed;
                    now_us.saturating_sub(passed_us as u64)
                }
            }
        };
        let clock = Self::new(origin_unix_us, speed)?;
        clock.note(file, None)?;
        Ok(clock)
    }

    /// Notes in `file` that the world ends now.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn stop(&self, file: &Path) -> Result<(), ClockError> {
        self.note(file, Some(unix_us()))
    }

    fn note(&self, file: &Path, stopped_unix_us: Option<u64>) -> Result<(), ClockError> {
        let note = wire::write(&ClockNote {
            v: VERSION,
            origin_unix_us: self.origin_unix_us,
            speed: self.speed,
            stopped_unix_us,
        })?;
        // As a whole or not at all.
        let unfinished = file.with_extension("new");
        let written = (|| {
            if let Some(directory) = file.parent() {
                fs::create_dir_all(directory)?;
            }
            let mut new = File::create(&unfinished)?;
            new.write_all(note.as_bytes())?;
            new.sync_all()?;
            fs::rename(&unfinished, file)
        })();
        written.map_err(|why| ClockError::Io {
            path: file.to_owned(),
            why,
        })
    }

    fn new(origin_unix_us: u64, speed: f64) -> Result<Self, ClockError> {
        if !(speed.is_finite() && speed > 0.0) {
            return Err(ClockError::Speed(speed));
        }
        let (anchor, unix_us) = both_clocks();
        let since_origin_us = unix_us.saturating_sub(origin_unix_us);
        Ok(Self {
            origin_unix_us,
            speed,
            anchor,
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

/// What a world has noted of its clock; `None` if there is no file.
fn read_note(file: &Path) -> Result<Option<ClockNote>, ClockError> {
    let mut text = Vec::new();
    let read = File::open(file).and_then(|open| open.take(MAX_NOTE_BYTES).read_to_end(&mut text));
    match read {
        Ok(_) => {}
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(why) => {
            let path = file.to_owned();
            return Err(ClockError::Io { path, why });
        }
    }
    let unread = |why: String| ClockError::Note {
        path: file.to_owned(),
        why,
    };
    let note: ClockNote = wire::read("clock", &text).map_err(|error| unread(error.to_string()))?;
    if !(note.speed.is_finite() && note.speed > 0.0) {
        return Err(unread(format!("a speed of {}", note.speed)));
    }
    Ok(Some(note))
}

/// The monotonic clock and the date at one moment. A process may lose the processor between reading
/// the one and the other, and would be late by that for as long as it lives; so the closest of some
/// readings counts.
fn both_clocks() -> (Instant, u64) {
    const READINGS: usize = 8;
    let readings = (0..READINGS).map(|_| {
        let before = Instant::now();
        let date_us = unix_us();
        let took = before.elapsed();
        (took, before + took / 2, date_us)
    });
    let closest = readings.min_by_key(|(took, ..)| *took);
    closest.map_or_else(
        || (Instant::now(), unix_us()),
        |(_, anchor, date_us)| (anchor, date_us),
    )
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

    fn noted(file: &Path, change: impl FnOnce(&mut ClockNote)) {
        let mut note = read_note(file).unwrap().unwrap();
        change(&mut note);
        fs::write(file, wire::write(&note).unwrap()).unwrap();
    }

    const HOUR_US: u64 = 3_600_000_000;

    #[test]
    fn time_goes_on_for_a_world_that_was_killed() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("robot/clock.json");
        let clock = Clock::continued(&file, 2.0).unwrap();
        assert!(clock.now() < Time::from_secs(60.0));
        noted(&file, |note| note.origin_unix_us -= HOUR_US);
        let clock = Clock::continued(&file, 2.0).unwrap();
        assert!(clock.now() >= Time::from_secs(7200.0));
        // To the microsecond: others go on with the date that they were told.
        let origin = clock.origin_unix_us;
        let again = Clock::continued(&file, 2.0).unwrap();
        assert_eq!(again.origin_unix_us, origin);
        let faster = Clock::continued(&file, 20.0).unwrap();
        assert!((faster.now().secs() - again.now().secs()).abs() < 60.0);
    }

    #[test]
    fn time_stands_still_while_nothing_runs() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("clock.json");
        let clock = Clock::continued(&file, 1.0).unwrap();
        clock.stop(&file).unwrap();
        noted(&file, |note| {
            note.origin_unix_us -= 2 * HOUR_US;
            note.stopped_unix_us = Some(note.origin_unix_us + HOUR_US);
        });
        let clock = Clock::continued(&file, 1.0).unwrap();
        let (now_s, stopped_s) = (clock.now().secs(), 3600.0);
        assert!(
            (stopped_s..stopped_s + 60.0).contains(&now_s),
            "{now_s} s after the beginning"
        );
    }

    #[test]
    fn what_is_no_note_is_refused_and_left_untouched() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("clock.json");
        for text in [
            "",
            "{}",
            "\u{0}",
            r#"{"v":1,"origin_unix_us":1,"speed":0,"stopped_unix_us":null}"#,
        ] {
            fs::write(&file, text).unwrap();
            let error = Clock::continued(&file, 1.0).unwrap_err();
            assert!(matches!(error, ClockError::Note { .. }), "{error}");
            assert_eq!(fs::read_to_string(&file).unwrap(), text);
        }
    }
}
