//! Whether everything went right, told from what was done in the room and from nothing else: where every
//! bottle must be, who was given what, who has asked whom.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Symbol, Time};
use executor_sim::{Room, RoomDoing, Spot, Whereabouts};

/// One who only looks, and counts.
pub struct Judge {
    seen: u64,
    /// Where every bottle is, by what was done to it.
    bottles: BTreeMap<Symbol, Spot>,
    /// Who was given a bottle, and which: of each guest.
    pub given: BTreeMap<Symbol, Vec<Symbol>>,
    /// Who has taken a guest's order, and when.
    pub asked: BTreeMap<Symbol, (Symbol, Time)>,
    /// Who has set a bottle down in haste last.
    pub in_haste: BTreeMap<Symbol, Symbol>,
    spills: BTreeSet<Symbol>,
    /// When something was done to a thing last.
    pub last: Time,
}

type Verdict = Result<(), String>;

impl Judge {
    /// Before anything is done.
    pub fn new(room: &Room) -> Self {
        let bottles = room.things().bottles();
        let bottles = bottles.map(|(name, bottle)| (name.clone(), bottle.spot.clone()));
        Self {
            seen: 0,
            bottles: bottles.collect(),
            given: BTreeMap::new(),
            asked: BTreeMap::new(),
            in_haste: BTreeMap::new(),
            spills: BTreeSet::new(),
            last: Time::ZERO,
        }
    }

    /// Somebody from outside has moved a bottle.
    pub fn moved(&mut self, bottle: &Symbol, to: Spot) {
        self.in_haste.remove(bottle);
        self.bottles.insert(bottle.clone(), to);
    }

    /// Something was spilt there.
    pub fn spilt(&mut self, place: &Symbol) {
        self.spills.insert(place.clone());
    }

    /// Takes in what was done since the last look, each of which must be possible after the last, and
    /// compares the outcome with the room.
    pub fn look(&mut self, room: &Room) -> Verdict {
        let new = room.done_count() - self.seen;
        if new == 0 {
            return self.compare(room);
        }
        self.seen = room.done_count();
        let deeds: Vec<_> = room.done().rev().take(new as usize).cloned().collect();
        for deed in deeds.into_iter().rev() {
            let vehicle = &deed.vehicle;
            if !matches!(deed.what, RoomDoing::Watched | RoomDoing::Spoke) {
                self.last = deed.at;
            }
            match &deed.what {
                RoomDoing::Grasped { bottle } => {
                    let spot = self.spot(bottle)?.clone();
                    if !matches!(spot, Spot::Proper { .. } | Spot::Edge { .. }) {
                        return Err(format!("{deed}, which was {spot}"));
                    }
                    self.goes_into_hand(vehicle, bottle)?;
                }
                RoomDoing::SetDownInHaste { bottle, place } => {
                    let node = place.clone();
                    self.in_haste.insert(bottle.clone(), vehicle.clone());
                    self.bottles.insert(bottle.clone(), Spot::Edge { node });
                }
                RoomDoing::Stowed { bottle, slot } => {
                    self.out_of_hand(vehicle, bottle)?;
                    let (vehicle, slot) = (vehicle.clone(), slot.clone());
                    let there = Spot::Slot { vehicle, slot };
                    if let Some((other, _)) = self.bottles.iter().find(|(_, it)| **it == there) {
                        return Err(format!("{deed}, where {other} is"));
                    }
                    self.bottles.insert(bottle.clone(), there);
                }
                RoomDoing::Taken { bottle, slot } => {
                    let spot = self.spot(bottle)?;
                    if !matches!(spot, Spot::Slot { vehicle: whose, slot: place } if whose == vehicle && place == slot)
                    {
                        return Err(format!("{deed}, but it was {spot}"));
                    }
                    self.goes_into_hand(vehicle, bottle)?;
                }
                RoomDoing::PutDown { bottle, place } => {
                    // From the hand, or pushed back from the edge.
                    let node = place.clone();
                    let edge = Spot::Edge { node };
                    if *self.spot(bottle)? != edge {
                        self.out_of_hand(vehicle, bottle)?;
                    }
                    let node = place.clone();
                    self.bottles.insert(bottle.clone(), Spot::Proper { node });
                }
                RoomDoing::Served { bottle, guest } => {
                    self.out_of_hand(vehicle, bottle)?;
                    self.served(room, bottle, guest)?;
                }
                RoomDoing::Wiped { place } => {
                    self.spills.remove(place);
                }
                RoomDoing::Asked { guest } => {
                    let by = (vehicle.clone(), deed.at);
                    if let Some((before, _)) = self.asked.insert(guest.clone(), by) {
                        return Err(format!("{deed}, whom {before} had asked"));
                    }
                }
                RoomDoing::Watched | RoomDoing::Spoke => {}
            }
        }
        self.compare(room)
    }

    fn spot(&self, bottle: &Symbol) -> Result<&Spot, String> {
        let spot = self.bottles.get(bottle);
        spot.ok_or_else(|| format!("there is no {bottle}"))
    }

    fn goes_into_hand(&mut self, vehicle: &Symbol, bottle: &Symbol) -> Verdict {
        let vehicle = vehicle.clone();
        let hand = Spot::Hand { vehicle };
        if let Some((other, _)) = self.bottles.iter().find(|(_, it)| **it == hand) {
            return Err(format!("{bottle} and {other} are both {hand}"));
        }
        self.bottles.insert(bottle.clone(), hand);
        self.in_haste.remove(bottle);
        Ok(())
    }

    fn out_of_hand(&self, vehicle: &Symbol, bottle: &Symbol) -> Verdict {
        let spot = self.spot(bottle)?;
        match spot {
            Spot::Hand { vehicle: whose } if whose == vehicle => Ok(()),
            _ => Err(format!("{vehicle} did not hold {bottle}, which was {spot}")),
        }
    }

    fn served(&mut self, room: &Room, bottle: &Symbol, guest: &Symbol) -> Verdict {
        let things = room.things();
        let (Some(thing), Some(person)) =
            (things.bottle(bottle.as_str()), things.guest(guest.as_str()))
        else {
            return Err(format!("nobody knows {bottle} or {guest}"));
        };
        if thing.kind != person.wants {
            return Err(format!("{guest} wanted {}, got {bottle}", person.wants));
        }
        if !self.asked.contains_key(guest) {
            return Err(format!("{guest} was not asked, and given {bottle}"));
        }
        let given = self.given.entry(guest.clone()).or_default();
        given.push(bottle.clone());
        if given.len() > 1 {
            return Err(format!("{guest} was given {given:?}"));
        }
        let whose = self.given.values().flatten();
        if whose.filter(|it| *it == bottle).count() > 1 {
            return Err(format!("{bottle} was given twice: {:?}", self.given));
        }
        let node = person.table.clone();
        self.bottles.insert(bottle.clone(), Spot::Proper { node });
        Ok(())
    }

    fn compare(&self, room: &Room) -> Verdict {
        for (name, bottle) in room.things().bottles() {
            let due = self.spot(name)?;
            if *due != bottle.spot {
                let spot = &bottle.spot;
                return Err(format!("{name} is {spot}, and should be {due}"));
            }
        }
        Ok(())
    }

    /// Spills that nobody has wiped up.
    pub fn spills(&self) -> &BTreeSet<Symbol> {
        &self.spills
    }

    /// Guests who sit there still, were asked, and have not been given anything.
    pub fn waiting(&self, room: &Room) -> Vec<Symbol> {
        let guests = room.things().guests();
        let waiting = guests.filter(|(name, guest)| {
            matches!(guest.whereabouts, Whereabouts::Seated { .. })
                && self.asked.contains_key(*name)
                && !self.given.contains_key(*name)
        });
        waiting.map(|(name, _)| name.clone()).collect()
    }

    /// Guests who sit there still and were not asked.
    pub fn unasked(&self, room: &Room) -> Vec<Symbol> {
        let guests = room.things().guests();
        let unasked = guests.filter(|(name, guest)| {
            matches!(guest.whereabouts, Whereabouts::Seated { .. })
                && !self.asked.contains_key(*name)
        });
        unasked.map(|(name, _)| name.clone()).collect()
    }
}
