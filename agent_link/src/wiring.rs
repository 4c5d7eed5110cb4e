//! What a machine is connected to, and why it may be connected no longer.

use std::time::Duration;

use agent_core::protocol::{Unreadable, last_epoch};

use crate::clock::epoch_now;
use crate::driver::Memory;
use crate::keys::{Keys, NameError};
use crate::quota::Limits;
use crate::wire::WireError;

/// What a machine is connected to.
#[derive(Clone, Debug)]
pub struct Wiring {
    /// Of the robot that it belongs to.
    pub keys: Keys,
    /// Its own name: instructions, reports and questions reach it there.
    pub name: String,
    /// New, and greater, at every start.
    pub epoch: u64,
    /// Who executes for it: their facts are listened to.
    pub executors: Vec<String>,
    /// Whether users' goals and commands are for it. One machine of a robot takes them.
    pub takes_goals: bool,
    /// Whether it takes users' goals and commands on keys of its own, beside those for the robot.
    pub takes_own_goals: bool,
    /// Whether it is one of a team: then what it says to nobody in particular is said to all of them, and
    /// may be lost.
    pub in_team: bool,
    /// Whether its name stands in the keys on which it instructs and reports (`…/instruction/<name>`), where
    /// the router can tell who may say what, and what others say to it is taken only so.
    pub signs: bool,
    /// How much users may ask for.
    pub limits: Limits,
    /// Whether it wants to know what users and sensors say about the world.
    pub takes_facts: bool,
    /// The key on which [`Input::Local`](agent_core::protocol::Input::Local) arrives.
    pub local_in: Option<String>,
    /// The key to which [`Output::Local`](agent_core::protocol::Output::Local) is sent.
    pub local_out: Option<String>,
    /// Whether what it says waits until the journal is written. Only the world does not wait: it is
    /// what is, written down or not.
    pub waits_for_the_disk: bool,
    /// How often [`Inspect::snapshot`](crate::Inspect::snapshot) is published on the world's pose.
    pub snapshots_every: Option<Duration>,
}

impl Wiring {
    /// A machine that takes instructions, and nothing else yet.
    pub fn new(keys: &Keys, name: &str, epoch: u64) -> Self {
        Self {
            keys: keys.clone(),
            name: name.to_owned(),
            epoch,
            executors: Vec::new(),
            takes_goals: false,
            takes_own_goals: false,
            in_team: false,
            signs: false,
            limits: Limits::default(),
            takes_facts: false,
            local_in: None,
            local_out: None,
            waits_for_the_disk: true,
            snapshots_every: None,
        }
    }
}

/// The epoch of a start now: greater than that of the last one, whatever the date says.
///
/// # Errors
/// If what was written down cannot be read.
pub fn next_epoch(memory: &Memory) -> Result<u64, LinkError> {
    let now = epoch_now();
    let Some((journal, rows)) = memory else {
        return Ok(now);
    };
    let last = last_epoch(rows).map_err(|why| LinkError::Unreadable {
        place: journal.name(),
        why,
    })?;
    Ok(last.map_or(now, |last| now.max(last.saturating_add(1))))
}

/// Why a machine is no longer driven.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// A name that cannot be part of a key.
    #[error(transparent)]
    Name(#[from] NameError),
    /// What the machine says cannot be written down.
    #[error(transparent)]
    Wire(#[from] WireError),
    /// What was written down does not fit the machine, or is damaged. The journal is as it was.
    #[error(
        "the journal {place} cannot be taken up: {why}; move it away to begin with an empty memory"
    )]
    Unreadable {
        /// The journal.
        place: String,
        /// Which row, and why.
        why: Unreadable,
    },
    /// The system.
    #[error("cannot start a thread for the journal: {0}")]
    Thread(std::io::Error),
    /// What this machine says has been said before.
    #[error(
        "`{name}` has forgotten what it has agreed with others: {key} has applied its message {seq} and knows that the answer was written down here. The journal is an old copy; move it away to begin with an empty memory"
    )]
    Outdated {
        /// This machine.
        name: String,
        /// Who said so.
        key: String,
        /// Which message.
        seq: u64,
    },
    /// zenoh.
    #[error("the network does not do what is asked of it: {0}")]
    Zenoh(zenoh::Error),
    /// Another process of this name has started since.
    #[error(
        "another `{name}` has started after this one, so this one steps down ({key} no longer listens to it). If there is no other, the date of this machine was set back"
    )]
    Superseded {
        /// This machine.
        name: String,
        /// Who said so.
        key: String,
    },
}
