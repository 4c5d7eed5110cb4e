//! What a machine is connected to, and why it may be connected no longer.

use std::time::Duration;

use crate::clock::epoch_now;
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
    /// How much users may ask for.
    pub limits: Limits,
    /// Whether it wants to know what users and sensors say about the world.
    pub takes_facts: bool,
    /// The key on which [`Input::Local`](agent_core::protocol::Input::Local) arrives.
    pub local_in: Option<String>,
    /// The key to which [`Output::Local`](agent_core::protocol::Output::Local) is sent.
    pub local_out: Option<String>,
    /// How often [`Inspect::snapshot`](crate::Inspect::snapshot) is published on the world's pose.
    pub snapshots_every: Option<Duration>,
}

impl Wiring {
    /// A machine that takes instructions, and nothing else yet.
    pub fn new(keys: &Keys, name: &str) -> Self {
        Self {
            keys: keys.clone(),
            name: name.to_owned(),
            epoch: epoch_now(),
            executors: Vec::new(),
            takes_goals: false,
            limits: Limits::default(),
            takes_facts: false,
            local_in: None,
            local_out: None,
            snapshots_every: None,
        }
    }
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
