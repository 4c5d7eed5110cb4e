//! What vehicles have done to the things in a room, so that somebody who only looks can say how often.

use std::collections::VecDeque;
use std::fmt;

use agent_core::model::{Symbol, Time};
use serde::{Deserialize, Serialize};

/// How many are kept; whoever counts looks more often.
const KEPT: usize = 10_000;

/// Something that was done, to its end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deed {
    /// Counts from 1, over all starts of the room.
    pub number: u64,
    /// When it ended.
    pub at: Time,
    /// Who did it.
    pub vehicle: Symbol,
    /// What.
    pub what: Doing,
}

/// What can be done to the things in a room.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Doing {
    /// A bottle was lifted away from where it stood.
    Grasped {
        /// Which.
        bottle: Symbol,
    },
    /// A grasp was broken off, and the bottle stands at the edge.
    SetDownInHaste {
        /// Which.
        bottle: Symbol,
        /// Where.
        place: Symbol,
    },
    /// It was put on the tray.
    Stowed {
        /// Which.
        bottle: Symbol,
        /// Where on it.
        slot: Symbol,
    },
    /// It was taken from the tray.
    Taken {
        /// Which.
        bottle: Symbol,
        /// From where on it.
        slot: Symbol,
    },
    /// It was put in its proper place.
    PutDown {
        /// Which.
        bottle: Symbol,
        /// Where.
        place: Symbol,
    },
    /// A guest was given it.
    Served {
        /// Which.
        bottle: Symbol,
        /// Who.
        guest: Symbol,
    },
    /// What was spilt was wiped up.
    Wiped {
        /// Where.
        place: Symbol,
    },
    /// A guest has said what it is to be.
    Asked {
        /// Who.
        guest: Symbol,
    },
    /// Something was looked at.
    Watched,
    /// Something was said.
    Spoke,
}

impl fmt::Display for Deed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} at {}: {} {}",
            self.number, self.at, self.vehicle, self.what
        )
    }
}

impl fmt::Display for Doing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Grasped { bottle } => write!(f, "grasped {bottle}"),
            Self::SetDownInHaste { bottle, place } => {
                write!(f, "set {bottle} down in haste at {place}")
            }
            Self::Stowed { bottle, slot } => write!(f, "put {bottle} in {slot}"),
            Self::Taken { bottle, slot } => write!(f, "took {bottle} from {slot}"),
            Self::PutDown { bottle, place } => write!(f, "put {bottle} down at {place}"),
            Self::Served { bottle, guest } => write!(f, "gave {bottle} to {guest}"),
            Self::Wiped { place } => write!(f, "wiped {place}"),
            Self::Asked { guest } => write!(f, "asked {guest}"),
            Self::Watched => f.write_str("looked"),
            Self::Spoke => f.write_str("spoke"),
        }
    }
}

/// The latest, oldest first, and how many there were.
#[derive(Clone, Debug, Default)]
pub(super) struct Chronicle {
    pub(super) kept: VecDeque<Deed>,
    pub(super) count: u64,
}

impl Chronicle {
    /// Gives it its number.
    pub(super) fn add(&mut self, mut deed: Deed) {
        self.count = self.count.saturating_add(1);
        deed.number = self.count;
        self.kept.push_back(deed);
        if self.kept.len() > KEPT {
            self.kept.pop_front();
        }
    }
}
