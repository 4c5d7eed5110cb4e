//! A process with its disk, and what it is sending.

use std::collections::VecDeque;
use std::fmt::Debug;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use agent_core::model::Time;
use agent_core::protocol::{Arrival, Effect, Input, Row, Rows, Station, Unreadable};
use siphasher::sip128::{Hasher128, SipHasher13};

use crate::fence::Fence;
use crate::letter::{Letter, Way};
use crate::role::Role;

/// A process: all but the disk is gone when it dies.
#[derive(Clone, Debug)]
pub struct Node<M: Role> {
    /// What it is.
    pub station: Station<M, Way>,
    /// Of its start.
    pub epoch: u64,
    /// What has been written.
    pub disk: Arc<Rows>,
    /// What is being written.
    pub flight: Option<Vec<Row>>,
    /// What is to be sent to its neighbour; the first is under way.
    pub queue: VecDeque<Letter>,
    /// Whether it will not die any more. Then it does not matter what is on the disk.
    pub is_spared: bool,
    /// What it was told to stop ahead of its turn.
    pub fence: Option<Fence>,
}

impl<M: Role> Node<M> {
    /// That machine in its process, on that disk.
    pub fn start(epoch: u64, machine: M, disk: Arc<Rows>) -> Result<Self, Unreadable> {
        Ok(Self {
            station: Station::recall(M::SIDE.name().into(), epoch, machine, &disk)?,
            epoch,
            disk,
            flight: None,
            queue: VecDeque::new(),
            is_spared: false,
            fence: None,
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
        if let Some(flight) = self.flight.take() {
            apply(Arc::make_mut(&mut self.disk), flight);
        }
        self.station.written();
    }

    /// The disk if all that is known now were written down.
    pub fn disk_to_be(&self) -> Rows {
        let mut disk = (*self.disk).clone();
        apply(&mut disk, self.flight.clone().unwrap_or_default());
        apply(&mut disk, self.station.sameness().0);
        disk
    }

    /// The fingerprint of all that matters for what it does next, and of what a look at its disk shows.
    pub fn print(&self, kept: u8) -> u128 {
        let (rows, words) = self.station.sameness();
        let mut hasher = SipHasher13::new();
        self.flight.is_some().hash(&mut hasher);
        // What observers are told is not looked at, but it is written down, too.
        let is_told = rows.iter().any(|row| !matters(&row.key));
        let is_changed = rows.iter().any(|row| matters(&row.key));
        (is_told, is_changed).hash(&mut hasher);
        let mut now = (*self.disk).clone();
        apply(&mut now, self.flight.clone().unwrap_or_default());
        apply(&mut now, rows);
        hash_rows(&now, &mut hasher);
        if !self.is_spared {
            hash_rows(&self.disk, &mut hasher);
            let flight = self.flight.iter().flatten();
            for row in flight.filter(|row| matters(&row.key)) {
                (&row.key, &row.value).hash(&mut hasher);
            }
        }
        words.hash(&mut hasher);
        format!("{:?}", self.queue).hash(&mut hasher);
        let volatile = self.station.machine().volatile();
        (self.epoch, volatile, self.is_spared, &self.fence, kept).hash(&mut hasher);
        hasher.finish128().as_u128()
    }
}

/// The fingerprint of a disk.
pub fn disk_print(disk: &Rows) -> u128 {
    let mut hasher = SipHasher13::new();
    hash_rows(disk, &mut hasher);
    hasher.finish128().as_u128()
}

fn hash_rows(rows: &Rows, hasher: &mut impl Hasher) {
    let rows: Vec<_> = rows.iter().filter(|(key, _)| matters(key)).collect();
    rows.hash(hasher);
}

/// Whether a row is more than what observers are told.
fn matters(key: &str) -> bool {
    !key.starts_with("s/event/") && key != "s/next-event"
}

/// Puts rows on a disk.
fn apply(disk: &mut Rows, rows: Vec<Row>) {
    for Row { key, value } in rows {
        match value {
            Some(value) => disk.insert(key, value),
            None => disk.remove(&key),
        };
    }
}
