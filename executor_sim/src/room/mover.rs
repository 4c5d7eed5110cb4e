//! A vehicle's body: parts put together.

use std::collections::BTreeMap;

use agent_core::model::{Action, FactChange, Symbol, Time};
use agent_core::protocol::ActionId;

use crate::parts::{Part, PartName};
use crate::{Place, SimulatedRobot};

/// The parts of one vehicle, and what is known of whoever drives it.
#[derive(Clone, Debug)]
pub struct Mover {
    pub(super) name: Symbol,
    /// Where it stands for good, if it has no base.
    pub(super) start: Symbol,
    pub(super) base: Option<SimulatedRobot>,
    pub(super) parts: BTreeMap<PartName, Part>,
    /// The places on its tray.
    pub(super) slots: Vec<Symbol>,
    /// Whoever drives it is not there: nobody could stop what is begun.
    pub(super) gone: bool,
    /// Where the drives lead that it has not forgotten.
    pub(super) ways: BTreeMap<ActionId, Symbol>,
    /// Where it is driving to, or was kept from driving to.
    pub(super) ahead: Option<Symbol>,
    /// What its superior was told last, and of which state of things that was true.
    pub(super) told: Vec<FactChange>,
    pub(super) told_of: Option<(u64, Option<Symbol>, Option<Symbol>)>,
}

impl Mover {
    /// Its vehicle's name.
    pub fn name(&self) -> &Symbol {
        &self.name
    }

    /// Where it is at that time, if nothing happens before.
    pub fn place(&self, now: Time) -> Place {
        match &self.base {
            Some(base) => base.world().place(now),
            None => Place::Node {
                node: self.start.clone(),
            },
        }
    }

    /// The place at which it stands. `None` on a way, and while it turns in order to set off.
    pub fn stands_at(&self, now: Time) -> Option<Symbol> {
        let Some(base) = &self.base else {
            return Some(self.start.clone());
        };
        match base.world().place(now) {
            Place::Node { node } if base.world().stands() => Some(node),
            Place::Node { .. } | Place::Arc { .. } => None,
        }
    }

    /// The base, if it has one.
    pub fn base(&self) -> Option<&SimulatedRobot> {
        self.base.as_ref()
    }

    /// The places on its tray.
    pub fn slots(&self) -> &[Symbol] {
        &self.slots
    }

    /// Whether it has an arm with a gripper.
    pub fn has_arm(&self) -> bool {
        self.parts.contains_key(&PartName::Arm)
    }

    /// Whether it sees what is where it stands.
    pub fn has_eyes(&self) -> bool {
        self.parts.contains_key(&PartName::Eyes)
    }

    /// Whether nobody is there to drive it.
    pub fn is_gone(&self) -> bool {
        self.gone
    }

    /// What its parts do, and which of that is coming to rest.
    pub fn doing(&self) -> impl Iterator<Item = (PartName, &Action, bool)> {
        let base = self.base.as_ref().and_then(SimulatedRobot::doing);
        let base = base.map(|(action, stopping)| (PartName::Base, action, stopping));
        let parts = self.parts.iter().filter_map(|(name, part)| {
            let (job, stopping) = part.doing()?;
            Some((*name, &job.action, stopping))
        });
        base.into_iter().chain(parts)
    }

    /// How many suspended actions its parts keep.
    pub fn suspended(&self) -> usize {
        let base = self.base.as_ref().map_or(0, SimulatedRobot::depth);
        base + self.parts.values().map(Part::depth).sum::<usize>()
    }

    /// When something is due.
    pub(super) fn due(&self) -> Option<Time> {
        let base = self.base.iter().filter_map(wake_at);
        base.chain(self.parts.values().filter_map(Part::due)).min()
    }

    /// Which part knows that execution.
    pub(super) fn part_of(&self, id: &ActionId) -> Option<PartName> {
        let mut parts = self.parts.iter();
        parts.find_map(|(name, part)| part.knows(id).then_some(*name))
    }
}

pub(super) fn wake_at(base: &SimulatedRobot) -> Option<Time> {
    agent_core::protocol::Machine::wake_at(base)
}
