//! What is in a room beside the vehicles: bottles, guests, what was spilt and what stands in the way.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use agent_core::model::{Symbol, Time};
use serde::{Deserialize, Serialize};

/// Where a bottle is. It is always at exactly one of these.
#[derive(Clone, Debug, Eq, PartialEq, Ord, PartialOrd, Serialize, Deserialize)]
pub enum Spot {
    /// In its proper place there.
    Proper {
        /// Where.
        node: Symbol,
    },
    /// Set down there in haste.
    Edge {
        /// Where.
        node: Symbol,
    },
    /// In a gripper.
    Hand {
        /// Whose.
        vehicle: Symbol,
    },
    /// On a tray.
    Slot {
        /// Whose.
        vehicle: Symbol,
        /// Where on it.
        slot: Symbol,
    },
    /// Somebody has taken it away.
    Away,
}

/// A bottle.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct Bottle {
    /// What is in it.
    pub kind: Symbol,
    /// Where it is.
    pub spot: Spot,
    /// A gripper that has hold of it, but has not lifted it away.
    pub gripped_by: Option<Symbol>,
    /// Who was given it.
    pub given_to: Option<Symbol>,
    /// It is empty.
    pub used: bool,
}

/// Where a guest is.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub enum Whereabouts {
    /// Not here yet.
    Outside,
    /// In the entrance.
    Entrance,
    /// At a table.
    Seated {
        /// Which.
        table: Symbol,
    },
    /// Has left.
    Gone,
}

/// A guest.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct Guest {
    /// Where this guest will sit, or sits.
    pub table: Symbol,
    /// What this guest says when asked.
    pub wants: Symbol,
    /// Where this guest is.
    pub whereabouts: Whereabouts,
    /// What this guest was given.
    pub served: BTreeSet<Symbol>,
    /// When this guest comes, sits down and goes, as far as that is not over.
    pub plans: Vec<(Time, Whereabouts)>,
}

/// Everything in a room that is no vehicle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Things {
    pub(super) bottles: BTreeMap<Symbol, Bottle>,
    pub(super) guests: BTreeMap<Symbol, Guest>,
    pub(super) spills: BTreeSet<Symbol>,
    pub(super) blocked: BTreeSet<Symbol>,
    /// Where a vehicle can stand.
    pub(super) places: BTreeSet<Symbol>,
    /// Counts changes, so that nobody looks twice at what is the same.
    pub(super) version: u64,
}

impl Things {
    /// All bottles, by name.
    pub fn bottles(&self) -> impl Iterator<Item = (&Symbol, &Bottle)> {
        self.bottles.iter()
    }

    /// The bottle of that name.
    pub fn bottle(&self, name: &str) -> Option<&Bottle> {
        self.bottles.get(&Symbol::from(name))
    }

    /// All guests, by name.
    pub fn guests(&self) -> impl Iterator<Item = (&Symbol, &Guest)> {
        self.guests.iter()
    }

    /// The guest of that name.
    pub fn guest(&self, name: &str) -> Option<&Guest> {
        self.guests.get(&Symbol::from(name))
    }

    /// Where something was spilt.
    pub fn spills(&self) -> impl Iterator<Item = &Symbol> {
        self.spills.iter()
    }

    /// Where nobody can drive.
    pub fn blocked(&self) -> impl Iterator<Item = &Symbol> {
        self.blocked.iter()
    }

    /// What is in that vehicle's hand.
    pub fn in_hand(&self, vehicle: &Symbol) -> Option<&Symbol> {
        self.find(|spot| matches!(spot, Spot::Hand { vehicle: whose } if whose == vehicle))
    }

    /// What is in that place of a vehicle's tray.
    pub fn in_slot(&self, vehicle: &Symbol, slot: &Symbol) -> Option<&Symbol> {
        self.find(|spot| {
            matches!(spot, Spot::Slot { vehicle: whose, slot: place }
                if whose == vehicle && place == slot)
        })
    }

    pub(super) fn is_place(&self, name: &Symbol) -> bool {
        self.places.contains(name)
    }

    fn find(&self, there: impl Fn(&Spot) -> bool) -> Option<&Symbol> {
        let mut bottles = self.bottles.iter();
        bottles.find_map(|(name, bottle)| there(&bottle.spot).then_some(name))
    }

    /// Puts a bottle somewhere else. Nobody has hold of it then.
    pub(super) fn put(&mut self, bottle: &Symbol, spot: Spot) {
        if let Some(bottle) = self.bottles.get_mut(bottle) {
            bottle.gripped_by = None;
            if bottle.spot != spot {
                bottle.spot = spot;
                self.version += 1;
            }
        }
    }

    /// Lets a guest come, sit down or go.
    pub(super) fn move_guest(&mut self, name: &Symbol, to: Whereabouts) {
        let Some(guest) = self.guests.get_mut(name) else {
            return;
        };
        if guest.whereabouts == to {
            return;
        }
        if let Whereabouts::Seated { table } = &to {
            guest.table = table.clone();
        }
        if to == Whereabouts::Gone {
            // What was drunk stays on the table.
            for bottle in self.bottles.values_mut() {
                bottle.used |= bottle.given_to.as_ref() == Some(name);
            }
        }
        guest.whereabouts = to;
        self.version += 1;
    }

    /// The next guest who does something by plan, and when.
    pub(super) fn next_plan(&self) -> Option<(Time, Symbol)> {
        let guests = self.guests.iter();
        let next = guests.filter_map(|(name, guest)| Some((guest.plans.first()?.0, name)));
        next.min().map(|(time, name)| (time, name.clone()))
    }

    /// That guest does what is planned next.
    pub(super) fn follow_plan(&mut self, name: &Symbol) {
        let Some(guest) = self.guests.get_mut(name) else {
            return;
        };
        if !guest.plans.is_empty() {
            let (_, to) = guest.plans.remove(0);
            self.move_guest(name, to);
        }
    }
}

impl Bottle {
    /// Whether it stands there, properly or not.
    pub fn is_at(&self, place: &Symbol) -> bool {
        match &self.spot {
            Spot::Proper { node } | Spot::Edge { node } => node == place,
            Spot::Hand { .. } | Spot::Slot { .. } | Spot::Away => false,
        }
    }
}

impl fmt::Display for Spot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Proper { node } => write!(f, "at {node}"),
            Self::Edge { node } => write!(f, "at the edge of {node}"),
            Self::Hand { vehicle } => write!(f, "in the hand of {vehicle}"),
            Self::Slot { vehicle, slot } => write!(f, "in {slot} of {vehicle}"),
            Self::Away => f.write_str("away"),
        }
    }
}

impl fmt::Display for Whereabouts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outside => f.write_str("outside"),
            Self::Entrance => f.write_str("in the entrance"),
            Self::Seated { table } => write!(f, "at {table}"),
            Self::Gone => f.write_str("gone"),
        }
    }
}
