//! What has been done to the world, so that somebody who only looks can say how often.

use std::collections::VecDeque;
use std::fmt;

use agent_core::model::{Action, Symbol, Time};
use serde::{Deserialize, Serialize};

use crate::{Place, Ticket};

/// How many are kept; whoever counts looks more often.
const KEPT: usize = 1000;

/// Something that has been done, or was broken off.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Done {
    /// Counts from 1, over all starts of the world.
    pub number: u64,
    /// By which command.
    pub ticket: Ticket,
    /// When it ended.
    pub at: Time,
    /// Whether to its end. What is broken off has not been done.
    pub to_the_end: bool,
    /// What.
    pub what: Doing,
}

/// What can be done to the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Doing {
    /// Something was driven.
    Drive {
        /// Along this arc.
        arc: Symbol,
        /// Towards this end of it.
        to: Symbol,
        /// How far, in metres.
        driven_m: f64,
    },
    /// Something was said.
    Speech {
        /// Where the robot stood, or passed.
        place: Place,
        /// For how long, in seconds.
        spoken_s: f64,
    },
    /// A door was set.
    Door {
        /// Which.
        door: Symbol,
        /// How it is since.
        open: bool,
    },
    /// What is not seen otherwise.
    Deed {
        /// In the model's words.
        what: Action,
    },
}

impl fmt::Display for Done {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at {}: {}", self.number, self.at, self.what)?;
        if self.to_the_end {
            Ok(())
        } else {
            f.write_str(", broken off")
        }
    }
}

impl fmt::Display for Doing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drive { arc, to, driven_m } => write!(f, "{driven_m:.2} m along {arc} to {to}"),
            Self::Speech { place, spoken_s } => write!(f, "spoke {spoken_s:.1} s {place}"),
            Self::Door { door, open } => {
                let state = if *open { "open" } else { "closed" };
                write!(f, "{door} {state}")
            }
            Self::Deed { what } => write!(f, "{what}"),
        }
    }
}

/// The latest, oldest first, and what is left of all of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Chronicle {
    pub(super) kept: VecDeque<Done>,
    pub(super) head: Head,
}

/// What is left of all that was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Head {
    /// How many there were.
    pub(super) count: u64,
    /// The last that was done to its end.
    pub(super) done: Ticket,
    /// The greatest number of a command that has come in.
    pub(super) heard: Ticket,
}

impl Chronicle {
    pub(super) fn add(&mut self, ticket: Ticket, at: Time, to_the_end: bool, what: Doing) {
        self.head.count = self.head.count.saturating_add(1);
        if to_the_end {
            self.head.done = ticket;
        }
        self.kept.push_back(Done {
            number: self.head.count,
            ticket,
            at,
            to_the_end,
            what,
        });
        if self.kept.len() > KEPT {
            self.kept.pop_front();
        }
    }
}
