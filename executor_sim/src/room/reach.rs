//! What the parts of a vehicle do to the things in a room.

use agent_core::model::{Fact, Symbol, Time};

use super::chronicle::{Chronicle, Deed, Doing};
use super::things::{Spot, Things, Whereabouts};
use crate::parts::{Errand, Hindrance, Reality};

/// A vehicle's hands, eyes and voice, from where it stands.
pub(super) struct Reach<'a> {
    pub(super) now: Time,
    pub(super) vehicle: &'a Symbol,
    /// Where it stands; `None` on its way.
    pub(super) place: Option<&'a Symbol>,
    pub(super) slots: &'a [Symbol],
    pub(super) things: &'a mut Things,
    pub(super) chronicle: &'a mut Chronicle,
}

impl Reach<'_> {
    fn here(&self) -> Result<&Symbol, Hindrance> {
        let vehicle = self.vehicle;
        self.place.ok_or_else(|| {
            let reason = format!("{vehicle} does not stand at a place where anything is in reach");
            without(reason)
        })
    }

    fn spot(&self, bottle: &Symbol) -> Result<&Spot, Hindrance> {
        let bottle_here = self.things.bottles.get(bottle);
        let bottle_here = bottle_here.map(|bottle| &bottle.spot);
        bottle_here.ok_or_else(|| without(format!("there is no bottle `{bottle}`")))
    }

    /// It stands here, and no other gripper has hold of it.
    fn stands_here(&self, bottle: &Symbol) -> Result<(), Hindrance> {
        let here = self.here()?;
        let spot = self.spot(bottle)?;
        let Some(known) = self.things.bottles.get(bottle).filter(|it| it.is_at(here)) else {
            let reason = format!("{bottle} is not at {here}, it is {spot}");
            return Err(blocked(reason, fact("stands", &[bottle, here])));
        };
        match &known.gripped_by {
            Some(other) if other != self.vehicle => {
                let reason = format!("{other} has hold of {bottle}");
                Err(blocked(reason, fact("stands", &[bottle, here])))
            }
            _ => Ok(()),
        }
    }

    fn hand_is_free(&self) -> Result<(), Hindrance> {
        match self.things.in_hand(self.vehicle) {
            Some(bottle) => {
                let reason = format!("the hand of {} holds {bottle}", self.vehicle);
                Err(blocked(reason, fact("hand-free", &[])))
            }
            None => Ok(()),
        }
    }

    fn holds(&self, bottle: &Symbol) -> Result<(), Hindrance> {
        let spot = self.spot(bottle)?;
        if self.things.in_hand(self.vehicle) == Some(bottle) {
            return Ok(());
        }
        let reason = format!(
            "{bottle} is not in the hand of {}, it is {spot}",
            self.vehicle
        );
        Err(blocked(reason, fact("holding", &[bottle])))
    }

    fn has_slot(&self, slot: &Symbol) -> Result<(), Hindrance> {
        if self.slots.contains(slot) {
            return Ok(());
        }
        let reason = format!("{} has no `{slot}` on a tray", self.vehicle);
        Err(without(reason))
    }

    fn slot_is_empty(&self, slot: &Symbol) -> Result<(), Hindrance> {
        self.has_slot(slot)?;
        match self.things.in_slot(self.vehicle, slot) {
            Some(bottle) => {
                let reason = format!("{bottle} is in {slot} of {}", self.vehicle);
                Err(blocked(reason, fact("empty", &[slot])))
            }
            None => Ok(()),
        }
    }

    fn is_loaded(&self, bottle: &Symbol, slot: &Symbol) -> Result<(), Hindrance> {
        self.has_slot(slot)?;
        let spot = self.spot(bottle)?;
        if self.things.in_slot(self.vehicle, slot) == Some(bottle) {
            return Ok(());
        }
        let reason = format!(
            "{bottle} is not in {slot} of {}, it is {spot}",
            self.vehicle
        );
        Err(blocked(reason, fact("loaded", &[bottle, slot])))
    }

    fn sits_here(&self, name: &Symbol) -> Result<(), Hindrance> {
        let here = self.here()?;
        let guest = self.things.guests.get(name);
        let guest = guest.ok_or_else(|| without(format!("there is no guest `{name}`")))?;
        match &guest.whereabouts {
            Whereabouts::Seated { table } if table == here => Ok(()),
            elsewhere => {
                let reason = format!("{name} does not sit at {here} but is {elsewhere}");
                Err(blocked(reason, fact("seated", &[name, here])))
            }
        }
    }

    fn is_here_to_wipe(&self, place: &Symbol) -> Result<(), Hindrance> {
        let here = self.here()?;
        if here == place {
            return Ok(());
        }
        let reason = format!("{} stands at {here}, not at {place}", self.vehicle);
        Err(blocked(reason, fact("at", &[place])))
    }

    /// All that an errand needs: `at_first` before the part has hold of anything.
    fn needs(&self, errand: &Errand, at_first: bool) -> Result<(), Hindrance> {
        match errand {
            Errand::Grasp { bottle } => {
                self.hand_is_free()?;
                self.stands_here(bottle)?;
                self.is_gripped(bottle, at_first)
            }
            Errand::Stow { bottle, slot } => {
                self.holds(bottle)?;
                self.slot_is_empty(slot)
            }
            Errand::Take { bottle, slot } => {
                self.hand_is_free()?;
                self.is_loaded(bottle, slot)?;
                self.is_gripped(bottle, at_first)
            }
            Errand::SetBack { bottle } => {
                self.here()?;
                if self.holds(bottle).is_ok() {
                    return Ok(());
                }
                self.hand_is_free()?;
                self.stands_here(bottle)?;
                self.is_gripped(bottle, at_first)
            }
            Errand::PutDown { bottle } => {
                self.here()?;
                self.holds(bottle)
            }
            Errand::HandOver { bottle, guest } => {
                self.sits_here(guest)?;
                self.holds(bottle)
            }
            Errand::Wipe { place } => self.is_here_to_wipe(place),
            Errand::Ask { guest } => self.sits_here(guest),
            Errand::Watch | Errand::Speak => Ok(()),
        }
    }

    fn is_gripped(&self, bottle: &Symbol, at_first: bool) -> Result<(), Hindrance> {
        let known = self.things.bottles.get(bottle);
        let gripped = known.is_some_and(|it| it.gripped_by.as_ref() == Some(self.vehicle));
        if at_first || gripped {
            return Ok(());
        }
        let reason = format!("{bottle} was taken out of the gripper of {}", self.vehicle);
        Err(without(reason))
    }

    fn note(&mut self, doing: Doing) {
        self.chronicle.add(Deed {
            number: 0,
            at: self.now,
            vehicle: self.vehicle.clone(),
            what: doing,
        });
    }
}

impl Reality for Reach<'_> {
    fn begin(&mut self, errand: &Errand) -> Result<(), Hindrance> {
        self.needs(errand, true)?;
        let vehicle = self.vehicle.clone();
        if errand.begins_anew()
            && let Some(bottle) = errand.bottle()
            && self.things.in_hand(&vehicle) != Some(bottle)
            && let Some(bottle) = self.things.bottles.get_mut(bottle)
        {
            bottle.gripped_by = Some(vehicle);
        }
        Ok(())
    }

    fn goes_on(&self, errand: &Errand) -> Result<(), Hindrance> {
        self.needs(errand, false)
    }

    fn finish(&mut self, errand: &Errand) -> Result<(), Hindrance> {
        self.needs(errand, false)?;
        let vehicle = self.vehicle.clone();
        match errand {
            Errand::Grasp { bottle } => {
                self.things.put(bottle, Spot::Hand { vehicle });
                if let Some(bottle) = self.things.bottles.get_mut(bottle) {
                    bottle.given_to = None;
                }
                let bottle = bottle.clone();
                self.note(Doing::Grasped { bottle });
            }
            Errand::Stow { bottle, slot } => {
                let (bottle, slot) = (bottle.clone(), slot.clone());
                let spot = Spot::Slot {
                    vehicle,
                    slot: slot.clone(),
                };
                self.things.put(&bottle, spot);
                self.note(Doing::Stowed { bottle, slot });
            }
            Errand::Take { bottle, slot } => {
                self.things.put(bottle, Spot::Hand { vehicle });
                let (bottle, slot) = (bottle.clone(), slot.clone());
                self.note(Doing::Taken { bottle, slot });
            }
            Errand::SetBack { bottle } | Errand::PutDown { bottle } => {
                let node = self.here()?.clone();
                let place = node.clone();
                self.things.put(bottle, Spot::Proper { node });
                let bottle = bottle.clone();
                self.note(Doing::PutDown { bottle, place });
            }
            Errand::HandOver { bottle, guest } => {
                let node = self.here()?.clone();
                self.things.put(bottle, Spot::Proper { node });
                if let (Some(thing), Some(person)) = (
                    self.things.bottles.get_mut(bottle),
                    self.things.guests.get_mut(guest),
                ) {
                    thing.given_to = Some(guest.clone());
                    person.served.insert(thing.kind.clone());
                    self.things.version += 1;
                }
                let (bottle, guest) = (bottle.clone(), guest.clone());
                self.note(Doing::Served { bottle, guest });
            }
            Errand::Wipe { place } => {
                if self.things.spills.remove(place) {
                    self.things.version += 1;
                }
                let place = place.clone();
                self.note(Doing::Wiped { place });
            }
            Errand::Ask { guest } => {
                let guest = guest.clone();
                self.note(Doing::Asked { guest });
            }
            Errand::Watch => self.note(Doing::Watched),
            Errand::Speak => self.note(Doing::Spoke),
        }
        Ok(())
    }

    fn let_go(&mut self, errand: &Errand) {
        let Some(name) = errand.bottle() else { return };
        let Some(bottle) = self.things.bottles.get_mut(name) else {
            return;
        };
        let gripped = bottle.gripped_by.take_if(|by| by == self.vehicle);
        if gripped.is_some()
            && let Spot::Proper { node } | Spot::Edge { node } = &bottle.spot
        {
            let node = node.clone();
            let place = node.clone();
            self.things.put(name, Spot::Edge { node });
            let bottle = name.clone();
            self.note(Doing::SetDownInHaste { bottle, place });
        }
    }
}

fn without(reason: String) -> Hindrance {
    Hindrance {
        reason,
        blocked_by: Vec::new(),
    }
}

fn blocked(reason: String, fact: Fact) -> Hindrance {
    Hindrance {
        reason,
        blocked_by: vec![fact],
    }
}

pub(super) fn fact(name: &str, args: &[&Symbol]) -> Fact {
    Fact {
        name: Symbol::from(name),
        args: args.iter().copied().cloned().collect(),
    }
}
