//! What is known of one role that is looked after.

use std::collections::{BTreeSet, VecDeque};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use serde_json::{Value, json};
use tokio::time::Instant;

use super::back_off::{BackOff, End, Verdict};
use super::role_process::RoleProcess;

/// A process that dies falls silent a moment before its end is seen: so long nothing is made of it.
const GRACE: Duration = Duration::from_millis(300);
/// A role has so many times as long to be ready as to answer: it reads maps and its journal, and waits
/// for its world.
const TIMES_TO_START: u32 = 6;
/// What it said last, for people who want to know why it was given up.
const LAST_WORDS: usize = 10;

/// How a role is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Phase {
    /// Its process runs and has not said that it is there.
    Starting,
    /// It is there.
    Ready,
    /// Its process runs, and nobody hears of it.
    Silent {
        /// Since when.
        since: Instant,
        /// Whether people know.
        told: bool,
    },
    /// It was killed, and its end is to be seen soon.
    Killed,
    /// It has no process until then.
    Down {
        /// When it is started again.
        next: Instant,
    },
    /// It has no process, and is not started again.
    GivenUp,
}

/// What is to be done about a role.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Due {
    /// Start it.
    Start,
    /// Tell people that it does not answer.
    TellSilence,
    /// Kill it, since a process that hangs holds its journal.
    Kill,
}

/// One role.
#[derive(Debug)]
pub(super) struct Watched {
    pub(super) process: Option<RoleProcess>,
    pub(super) phase: Phase,
    /// How often it was started again.
    pub(super) restarts: u32,
    back_off: BackOff,
    /// The epochs in which somebody says to be this role.
    tokens: BTreeSet<u64>,
    /// The epoch of its process is not before this.
    spawned_ms: u64,
    spawned: Instant,
    /// Since when it has been missing, until it is ready.
    down_since: Option<Instant>,
    /// In seconds since 1970.
    ready_unix_s: Option<f64>,
    /// How its last process ended, and when, in seconds since 1970.
    last_exit: Option<(String, f64)>,
    words: VecDeque<String>,
}

impl Watched {
    /// One that has not been started.
    pub(super) fn new() -> Self {
        Self {
            process: None,
            phase: Phase::Starting,
            restarts: 0,
            back_off: BackOff::default(),
            tokens: BTreeSet::new(),
            spawned_ms: 0,
            spawned: Instant::now(),
            down_since: None,
            ready_unix_s: None,
            last_exit: None,
            words: VecDeque::new(),
        }
    }

    /// The id of its process; 0 if it has none.
    pub(super) fn pid(&self) -> u32 {
        self.process.as_ref().map_or(0, |process| process.pid)
    }

    /// It has a process, which was begun after `now_ms`.
    pub(super) fn spawned(&mut self, process: RoleProcess, now_ms: u64) {
        if matches!(self.phase, Phase::Down { .. }) {
            self.restarts += 1;
        }
        self.process = Some(process);
        self.phase = Phase::Starting;
        self.spawned_ms = now_ms;
        self.spawned = Instant::now();
        self.words.clear();
    }

    pub(super) fn said(&mut self, line: &str) {
        self.words.push_back(line.to_owned());
        if self.words.len() > LAST_WORDS {
            self.words.pop_front();
        }
    }

    /// How it ended, and what it said before.
    pub(super) fn last_words(&self, how: &str) -> String {
        let mut words = how.to_owned();
        for line in &self.words {
            words.push('\n');
            words.push_str(line);
        }
        words
    }

    /// Somebody says to be this role, or says so no more.
    pub(super) fn token(&mut self, epoch: u64, there: bool) {
        if there {
            self.tokens.insert(epoch);
        } else {
            self.tokens.remove(&epoch);
        }
    }

    /// Whether its process says that it is there.
    pub(super) fn answers(&self) -> bool {
        self.tokens.range(self.spawned_ms..).next().is_some()
    }

    /// It is there; since it was last, so much time has gone by.
    pub(super) fn ready(&mut self) -> Option<Duration> {
        self.phase = Phase::Ready;
        self.back_off.up();
        self.ready_unix_s = Some(unix_s());
        self.down_since.take().map(|since| since.elapsed())
    }

    /// Its process has ended.
    pub(super) fn ended(&mut self, end: End, how: &str) -> Verdict {
        let now = Instant::now();
        self.process = None;
        self.ready_unix_s = None;
        self.last_exit = Some((how.to_owned(), unix_s()));
        self.down_since.get_or_insert(now);
        let verdict = self.back_off.ended(end, self.spawned.elapsed());
        self.phase = match verdict {
            Verdict::Again(delay) => Phase::Down { next: now + delay },
            Verdict::GiveUp => Phase::GivenUp,
        };
        verdict
    }

    /// Kills it; it has not answered for so long.
    pub(super) fn kill(&mut self) -> Duration {
        let since = match self.phase {
            Phase::Silent { since, .. } => since,
            _ => self.spawned,
        };
        if let Some(process) = &self.process {
            process.kill();
        }
        self.phase = Phase::Killed;
        since.elapsed()
    }

    /// Its silence says nothing so far.
    pub(super) fn wait_longer(&mut self) {
        let now = Instant::now();
        match &mut self.phase {
            Phase::Silent { since, .. } => *since = now,
            _ => self.spawned = now,
        }
    }

    /// What is to be done next, and when.
    pub(super) fn due(&self, hang_limit: Duration) -> Option<(Instant, Due)> {
        match self.phase {
            Phase::Starting => Some((self.spawned + hang_limit * TIMES_TO_START, Due::Kill)),
            Phase::Silent { since, told: false } => Some((since + GRACE, Due::TellSilence)),
            Phase::Silent { since, told: true } => Some((since + hang_limit, Due::Kill)),
            Phase::Down { next } => Some((next, Due::Start)),
            Phase::Ready | Phase::Killed | Phase::GivenUp => None,
        }
    }

    /// For those who ask.
    pub(super) fn status(&self) -> Value {
        let state = match self.phase {
            Phase::Starting => "starting",
            Phase::Ready | Phase::Silent { told: false, .. } => "up",
            Phase::Silent { .. } | Phase::Killed => "silent",
            Phase::Down { .. } => "down",
            Phase::GivenUp => "given_up",
        };
        let mut status = json!({ "state": state, "restarts": self.restarts });
        if let Some(process) = &self.process {
            status["process"] = json!(process.pid);
        }
        if let Some(since) = self.ready_unix_s {
            status["up_since_unix_s"] = json!(since);
        }
        if let Some((how, at)) = &self.last_exit {
            status["last_exit"] = json!(how);
            status["last_exit_unix_s"] = json!(at);
        }
        if let Phase::Down { next } = self.phase {
            let left = next.saturating_duration_since(Instant::now());
            status["next_start_s"] = json!(left.as_secs_f64());
        }
        status
    }
}

/// The date.
fn unix_s() -> f64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0.0, |since| since.as_secs_f64())
}
