//! What always holds in a room, whoever does what.

use std::collections::BTreeMap;

use agent_core::model::Symbol;

use super::Room;
use super::things::Spot;
use crate::parts::{Errand, PartName};

impl Room {
    /// Every law of a room; for tests, after every step.
    ///
    /// # Errors
    /// The first that is broken, in words.
    pub fn check(&self) -> Result<(), String> {
        let mut taken: BTreeMap<(&Symbol, Option<&Symbol>), &Symbol> = BTreeMap::new();
        for (name, bottle) in &self.things.bottles {
            let held = match &bottle.spot {
                Spot::Hand { vehicle } => Some((vehicle, None)),
                Spot::Slot { vehicle, slot } => Some((vehicle, Some(slot))),
                Spot::Proper { node } | Spot::Edge { node } => {
                    if !self.things.is_place(node) {
                        return Err(format!("{name} stands at {node}, which is no place"));
                    }
                    None
                }
                Spot::Away => None,
            };
            if let Some((vehicle, slot)) = held {
                let mover = self.movers.get(vehicle);
                let mover = mover.ok_or_else(|| format!("{name} is with {vehicle}, who is not"))?;
                if slot.is_none() && !mover.has_arm() {
                    return Err(format!("{name} is in the hand of {vehicle}, who has none"));
                }
                if slot.is_some_and(|slot| !mover.slots.contains(slot)) {
                    return Err(format!("{name} is in a slot that {vehicle} does not have"));
                }
                if let Some(other) = taken.insert((vehicle, slot), name) {
                    return Err(format!("{other} and {name} are both {}", bottle.spot));
                }
            }
            if let Some(vehicle) = &bottle.gripped_by {
                let errand = self.arm_of(vehicle);
                if errand.and_then(Errand::bottle) != Some(name) {
                    return Err(format!(
                        "{vehicle} has hold of {name} and does nothing with it"
                    ));
                }
                if self.things.in_hand(vehicle).is_some() {
                    return Err(format!("{vehicle} has hold of {name} with a full hand"));
                }
            }
            if bottle.given_to.is_some()
                && !matches!(
                    bottle.spot,
                    Spot::Proper { .. } | Spot::Edge { .. } | Spot::Away
                )
            {
                return Err(format!(
                    "{name} was given to a guest, and is {}",
                    bottle.spot
                ));
            }
        }
        for mover in self.movers.values() {
            let rolls = mover.stands_at(self.now).is_none();
            let errand = self.arm_of(&mover.name);
            let needs_rest = errand
                .is_some_and(|errand| !matches!(errand, Errand::Stow { .. } | Errand::Take { .. }));
            if rolls && needs_rest {
                return Err(format!("{} drives and reaches out at once", mover.name));
            }
        }
        Ok(())
    }

    fn arm_of(&self, vehicle: &Symbol) -> Option<&Errand> {
        let part = self.movers.get(vehicle)?.parts.get(&PartName::Arm)?;
        part.doing().map(|(job, _)| &job.rest.errand)
    }
}
