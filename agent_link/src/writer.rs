//! The thread that writes the journal, one commit at a time, while the loop goes on listening.

use std::collections::VecDeque;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc as std_mpsc;
use std::time::{Duration, Instant};

use agent_core::protocol::Row;
use agent_journal::{CommitError, Journal};
use serde_json::{Value, json};
use tokio::sync::mpsc;

/// After a failure the next attempt is made so much later.
const RETRY: Duration = Duration::from_millis(500);

/// The median is that of the latest commits.
const MEDIAN_OF: usize = 101;

/// Whoever ends waits so long for what is being written.
const FINISH_TIMEOUT: Duration = Duration::from_secs(2);

/// Writes to a journal.
pub(crate) struct Writer {
    place: String,
    work: std_mpsc::Sender<Vec<Row>>,
    done: mpsc::UnboundedReceiver<Done>,
    state: State,
    rows: usize,
    bytes: u64,
    commits: u64,
    /// How long the latest took.
    took: VecDeque<Duration>,
}

#[derive(Debug)]
enum State {
    Idle,
    /// The error is that of the attempt before.
    Writing(Option<CommitError>),
    /// The next attempt is due then.
    Failed(CommitError, tokio::time::Instant),
}

struct Done {
    result: Result<(), CommitError>,
    took: Duration,
    rows: usize,
    bytes: u64,
}

impl Writer {
    pub(crate) fn start(mut journal: Journal) -> io::Result<Self> {
        let place = journal.name();
        let (rows, bytes) = (journal.row_count(), journal.content_bytes());
        let (work, orders) = std_mpsc::channel::<Vec<Row>>();
        let (finished, done) = mpsc::unbounded_channel();
        let thread = std::thread::Builder::new().name("journal".to_owned());
        thread.spawn(move || {
            while let Ok(rows) = orders.recv() {
                let begun = Instant::now();
                let commit = catch_unwind(AssertUnwindSafe(|| journal.commit(&rows)));
                let result = commit.unwrap_or_else(|_| {
                    Err(CommitError {
                        place: journal.name(),
                        why: "its database gave up".to_owned(),
                    })
                });
                let done = Done {
                    result,
                    took: begun.elapsed(),
                    rows: journal.row_count(),
                    bytes: journal.content_bytes(),
                };
                if finished.send(done).is_err() {
                    return;
                }
            }
        })?;
        Ok(Self {
            place,
            work,
            done,
            state: State::Idle,
            rows,
            bytes,
            commits: 0,
            took: VecDeque::new(),
        })
    }

    /// Whether [`begin`](Self::begin) may be called.
    pub(crate) fn is_idle(&self) -> bool {
        matches!(self.state, State::Idle)
    }

    /// Why the last attempt failed, if none has succeeded since.
    pub(crate) fn trouble(&self) -> Option<&CommitError> {
        match &self.state {
            State::Idle | State::Writing(None) => None,
            State::Writing(Some(error)) | State::Failed(error, _) => Some(error),
        }
    }

    /// Begins to write rows down.
    pub(crate) fn begin(&mut self, rows: Vec<Row>) {
        self.order(rows, None);
    }

    fn order(&mut self, rows: Vec<Row>, before: Option<CommitError>) {
        self.state = match self.work.send(rows) {
            Ok(()) => State::Writing(before),
            // It ends only with this one, or with the process.
            Err(_) => self.failed("the thread that writes it has ended".to_owned()),
        };
    }

    fn failed(&self, why: String) -> State {
        let place = self.place.clone();
        let due = tokio::time::Instant::now() + RETRY;
        State::Failed(CommitError { place, why }, due)
    }

    /// Returns when everything that was begun is on the disk (`Ok`), or when an attempt has failed;
    /// what has failed is tried again by calling this again. Never returns while nothing is to be
    /// written. May be dropped at any time.
    pub(crate) async fn next(&mut self) -> Result<(), CommitError> {
        if let State::Failed(error, due) = &self.state {
            let (error, due) = (error.clone(), *due);
            tokio::time::sleep_until(due).await;
            // What was not written is kept by the journal.
            self.order(Vec::new(), Some(error));
        }
        match &self.state {
            State::Idle => std::future::pending().await,
            State::Failed(error, _) => return Err(error.clone()),
            State::Writing(_) => {}
        }
        let Some(done) = self.done.recv().await else {
            let error = CommitError {
                place: self.place.clone(),
                why: "the thread that writes it has ended".to_owned(),
            };
            self.state = self.failed(error.why.clone());
            return Err(error);
        };
        (self.rows, self.bytes) = (done.rows, done.bytes);
        match done.result {
            Ok(()) => {
                self.commits += 1;
                self.took.push_back(done.took);
                if self.took.len() > MEDIAN_OF {
                    self.took.pop_front();
                }
                self.state = State::Idle;
                Ok(())
            }
            Err(error) => {
                self.state = self.failed(error.why.clone());
                Err(error)
            }
        }
    }

    /// For people. `waiting`: how much waits for the disk.
    pub(crate) fn view(&self, waiting: usize) -> Value {
        let mut took: Vec<Duration> = self.took.iter().copied().collect();
        took.sort_unstable();
        let ms = |took: Option<&Duration>| took.map(|took| took.as_secs_f64() * 1e3);
        json!({
            "path": self.place,
            "rows": self.rows,
            "bytes": self.bytes,
            "commits": self.commits,
            "last_ms": ms(self.took.back()),
            "median_ms": ms(took.get(took.len() / 2)),
            "waiting": waiting,
            "error": self.trouble().map(ToString::to_string),
        })
    }

    /// Waits until what is being written is on the disk and the file is closed, but not for ever.
    pub(crate) async fn finish(self) {
        let Self { work, mut done, .. } = self;
        drop(work);
        let closed = async { while done.recv().await.is_some() {} };
        if tokio::time::timeout(FINISH_TIMEOUT, closed).await.is_err() {
            tracing::warn!("{} was not closed within {FINISH_TIMEOUT:?}", self.place);
        }
    }
}
