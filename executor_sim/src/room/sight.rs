//! What a vehicle knows by itself: its own body, and what its eyes see where it stands.
//!
//! All of it each time, what is so and what is not: whoever applies it to any belief knows the truth of
//! everything that the vehicle could know here, whatever was predicted before.

use std::collections::BTreeMap;

use agent_core::model::{Fact, FactChange, Symbol};

use super::reach::fact;
use super::things::{Bottle, Spot, Things, Whereabouts};

/// What a vehicle is, as far as that decides what it knows.
pub(super) struct Looker<'a> {
    pub(super) name: &'a Symbol,
    pub(super) vehicles: &'a [Symbol],
    pub(super) kinds: &'a [Symbol],
    pub(super) has_arm: bool,
    pub(super) has_eyes: bool,
    pub(super) slots: &'a [Symbol],
    /// Where it stands; `None` on its way.
    pub(super) place: Option<&'a Symbol>,
    /// Where it drives to, and was kept from driving to.
    pub(super) ahead: Option<&'a Symbol>,
    pub(super) entrance: &'a [Symbol],
    pub(super) tables: &'a [Symbol],
}

/// Facts about things, with whether they are so.
pub(super) fn sight(things: &Things, looker: &Looker<'_>) -> Vec<FactChange> {
    let mut seen = Seen {
        things,
        looker,
        truth: BTreeMap::new(),
    };
    seen.body();
    if looker.has_eyes {
        if let Some(place) = looker.place {
            seen.place(place);
        }
        for place in looker.place.iter().chain(looker.ahead.iter()) {
            seen.say("blocked", &[place], things.blocked.contains(*place));
        }
    }
    let truth = seen.truth.into_iter();
    truth
        .map(|(fact, so)| match so {
            true => FactChange::Add(fact),
            false => FactChange::Remove(fact),
        })
        .collect()
}

struct Seen<'a> {
    things: &'a Things,
    looker: &'a Looker<'a>,
    truth: BTreeMap<Fact, bool>,
}

impl Seen<'_> {
    fn say(&mut self, name: &str, args: &[&Symbol], so: bool) {
        self.truth.insert(fact(name, args), so);
    }

    fn body(&mut self) {
        let looker = self.looker;
        if looker.has_arm {
            let held = self.things.in_hand(looker.name);
            self.say("hand-free", &[], held.is_none());
        }
        for slot in looker.slots {
            let loaded = self.things.in_slot(looker.name, slot);
            self.say("empty", &[slot], loaded.is_none());
        }
        if !looker.has_arm && looker.slots.is_empty() {
            return;
        }
        for (name, bottle) in &self.things.bottles {
            if looker.has_arm {
                let vehicle = looker.name.clone();
                self.say("holding", &[name], bottle.spot == Spot::Hand { vehicle });
            }
            for slot in looker.slots {
                let spot = Spot::Slot {
                    vehicle: looker.name.clone(),
                    slot: slot.clone(),
                };
                self.say("loaded", &[name, slot], bottle.spot == spot);
            }
            let mine = match &bottle.spot {
                Spot::Hand { vehicle } | Spot::Slot { vehicle, .. } => vehicle == looker.name,
                Spot::Proper { .. } | Spot::Edge { .. } | Spot::Away => false,
            };
            self.say("with", &[name, looker.name], mine);
            if mine {
                self.bottle(name, bottle);
            }
        }
    }

    fn place(&mut self, place: &Symbol) {
        let things = self.things;
        self.say("spill", &[place], things.spills.contains(place));
        for (name, bottle) in &things.bottles {
            if bottle.is_at(place) {
                self.bottle(name, bottle);
            } else {
                self.say("stands", &[name, place], false);
                self.say("edge", &[name, place], false);
            }
        }
        for (name, guest) in &things.guests {
            let table = Whereabouts::Seated {
                table: place.clone(),
            };
            if guest.whereabouts == table {
                self.guest(name);
                for kind in self.looker.kinds {
                    self.say("served", &[name, kind], guest.served.contains(kind));
                }
            } else if self.looker.entrance.contains(place)
                && matches!(guest.whereabouts, Whereabouts::Entrance | Whereabouts::Gone)
            {
                self.guest(name);
            } else if self.looker.entrance.contains(place) {
                self.say("arrived", &[name], false);
                self.say("gone", &[name], false);
            } else {
                self.say("seated", &[name, place], false);
            }
        }
    }

    /// A bottle that one sees is nowhere else.
    fn bottle(&mut self, name: &Symbol, bottle: &Bottle) {
        let places = self.things.places.iter();
        for place in places {
            let node = place.clone();
            self.say(
                "stands",
                &[name, place],
                bottle.spot == Spot::Proper { node },
            );
            let node = place.clone();
            self.say("edge", &[name, place], bottle.spot == Spot::Edge { node });
        }
        for vehicle in self.looker.vehicles {
            let there = match &bottle.spot {
                Spot::Hand { vehicle: whose } | Spot::Slot { vehicle: whose, .. } => {
                    whose == vehicle
                }
                Spot::Proper { .. } | Spot::Edge { .. } | Spot::Away => false,
            };
            self.say("with", &[name, vehicle], there);
        }
        self.say("used", &[name], bottle.used);
    }

    /// A guest whom one sees, or has seen leave, is nowhere else.
    fn guest(&mut self, name: &Symbol) {
        let Some(guest) = self.things.guests.get(name) else {
            return;
        };
        for place in self.looker.tables {
            let table = place.clone();
            let there = guest.whereabouts == Whereabouts::Seated { table };
            self.say("seated", &[name, place], there);
        }
        self.say(
            "arrived",
            &[name],
            guest.whereabouts == Whereabouts::Entrance,
        );
        self.say("gone", &[name], guest.whereabouts == Whereabouts::Gone);
    }
}
