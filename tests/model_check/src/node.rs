//! A process with its disk, and what it is sending.

use std::collections::VecDeque;
use std::fmt::Debug;
use std::hash::{DefaultHasher, Hash, Hasher};

use agent_core::model::Time;
use agent_core::protocol::{Arrival, Durable, Effect, Input, Row, Rows, Station, Unreadable};

use crate::letter::{Letter, Way};

/// A process: all but the disk is gone when it dies.
#[derive(Clone, Debug)]
pub struct Node<M: Durable>
where
    M::Out: Clone + Debug,
{
    /// What it is.
    pub station: Station<M, Way>,
    /// Of its start.
    pub epoch: u64,
    /// What has been written.
    pub disk: Rows,
    /// What is being written.
    pub flight: Option<Vec<Row>>,
    /// What is to be sent to its neighbour; the first is under way.
    pub queue: VecDeque<Letter>,
}

/// What a crash in the middle of a writing leaves.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Left {
    /// What had been written before.
    Before,
    /// All of it, and that many of the effects that waited for it got out.
    All(usize),
}

impl<M> Node<M>
where
    M: Durable + Clone + Debug,
    M::Out: Clone + Debug,
{
    /// That process, on that disk.
    pub fn start(name: &str, epoch: u64, machine: M, disk: Rows) -> Result<Self, Unreadable> {
        Ok(Self {
            station: Station::recall(name.into(), epoch, machine, &disk)?,
            epoch,
            disk,
            flight: None,
            queue: VecDeque::new(),
        })
    }

    /// Takes something in, and thinks until there is nothing to think about.
    pub fn take(&mut self, arrival: Arrival<M::In>, way: Option<Way>) {
        self.station.handle(Time::ZERO, arrival, way);
        while self.station.wake_at() == Some(Time::ZERO) {
            let wake = Arrival::Input(Input::Wake);
            self.station.handle(Time::ZERO, wake, None);
        }
    }

    /// Begins to write if it is time to, and gives what may go out.
    pub fn effects(&mut self, hasty: bool) -> Vec<Effect<M::Out, Way>> {
        if hasty {
            self.station.release();
        }
        if self.flight.is_none() && self.station.wants_writing() {
            self.flight = self.station.write_down();
        }
        // Nobody here listens to events: what is told to observers changes nothing.
        std::iter::from_fn(|| self.station.poll_effect())
            .filter(|effect| !matches!(effect, Effect::Event { .. }))
            .collect()
    }

    /// What is being written is on the disk.
    pub fn written(&mut self) {
        apply(&mut self.disk, self.flight.take().unwrap_or_default());
        self.station.written();
    }

    /// The fingerprint of all that matters for what it does next.
    pub fn print(&self, volatile: &impl Hash) -> u64 {
        let (rows, words) = self.station.sameness();
        let mut now = self.disk.clone();
        apply(&mut now, self.flight.clone().unwrap_or_default());
        apply(&mut now, rows);
        let mut hasher = DefaultHasher::new();
        for row in self.disk.iter().filter(|(key, _)| matters(key)) {
            row.hash(&mut hasher);
        }
        let flight = self.flight.iter().flatten();
        self.flight.is_some().hash(&mut hasher);
        for row in flight.filter(|row| matters(&row.key)) {
            (&row.key, &row.value).hash(&mut hasher);
        }
        for row in now.iter().filter(|(key, _)| matters(key)) {
            row.hash(&mut hasher);
        }
        words.hash(&mut hasher);
        format!("{:?}", self.queue).hash(&mut hasher);
        (self.epoch, volatile).hash(&mut hasher);
        hasher.finish()
    }
}

/// Whether a row is more than what observers are told.
fn matters(key: &str) -> bool {
    !key.starts_with("s/event/") && key != "s/next-event"
}

/// Puts rows on a disk.
pub fn apply(disk: &mut Rows, rows: Vec<Row>) {
    for Row { key, value } in rows {
        match value {
            Some(value) => disk.insert(key, value),
            None => disk.remove(&key),
        };
    }
}
