//! What an evening is made of, from a seed: who serves, who comes, what goes wrong and when.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;

use agent_core::model::{Symbol, Time};
use experiments::NoiseRates;
use maps::Restaurant;
use maps::restaurant::{BottlePlan, GuestPlan, RoomPlan, VehiclePlan};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const KINDS: [&str; 3] = ["cola", "juice", "water"];
const TABLES: [&str; 3] = ["table1", "table2", "table3"];
const PLACES: [&str; 4] = ["kitchen", "table1", "table2", "table3"];

/// What happens beside that guests come and go.
#[derive(Clone, Debug)]
pub enum Incident {
    /// Somebody takes the bottle away from wherever it is. Whoever sees it sees it.
    Take(Symbol),
    /// Somebody puts it there, at the edge or not, unless a vehicle or a guest has it, and says so.
    Put {
        bottle: Symbol,
        place: Symbol,
        edge: bool,
    },
    /// Something stands in the way. Whoever sees it sees it.
    Block(Symbol),
    /// It is taken away, and somebody says so.
    Free(Symbol),
    /// Something is spilt, and a user wants it wiped up; the vehicle that is asked, or anybody.
    Spill(Symbol, Option<Symbol>),
    /// A user wants a table cleared before anything else.
    Clear(Symbol),
    /// The process of a vehicle dies.
    Kill(Symbol),
    /// It is started again, with its journal or without.
    Restart(Symbol, bool),
}

/// All of an evening.
#[derive(Clone, Debug)]
pub struct Scene {
    pub restaurant: Restaurant,
    pub together: NonZeroUsize,
    pub noise: Option<NoiseRates>,
    pub incidents: Vec<(Time, Incident)>,
}

impl Scene {
    /// The evening of that seed.
    pub fn of(seed: u64) -> Self {
        Draw(ChaCha8Rng::seed_from_u64(seed)).scene()
    }

    /// When the last thing happens that nobody who serves has brought about.
    pub fn last(&self) -> Time {
        let guests = self.restaurant.room().guests.values();
        let guests = guests.flat_map(|it| [it.arrives_s, it.sits_s, it.leaves_s]);
        let guests = guests.flatten().map(Time::from_secs);
        let incidents = self.incidents.iter().map(|(at, _)| *at);
        guests.chain(incidents).max().unwrap_or(Time::ZERO)
    }

    /// In words, to be read beside what became of it.
    pub fn tell(&self) -> String {
        let room = self.restaurant.room();
        let mut lines = vec![format!("together {}, {:?}", self.together, self.noise)];
        let vehicles = room.vehicles.iter();
        lines.extend(vehicles.map(|(name, it)| {
            let can: Vec<&str> = it.can.iter().map(Symbol::as_str).collect();
            format!("{name} at {}: {}", it.start, can.join(", "))
        }));
        let guests = room.guests.iter();
        lines.extend(guests.map(|(name, it)| {
            format!(
                "{name}: {} at {}, {:?} {:?} {:?}",
                it.wants, it.table, it.arrives_s, it.sits_s, it.leaves_s
            )
        }));
        let bottles: Vec<&str> = room.bottles.keys().map(Symbol::as_str).collect();
        lines.push(bottles.join(" "));
        let incidents = self.incidents.iter();
        lines.extend(incidents.map(|(at, what)| format!("{at} {what:?}")));
        lines.join("\n")
    }
}

struct Draw(ChaCha8Rng);

impl Draw {
    fn below(&mut self, bound: usize) -> usize {
        self.0.random_range(..bound)
    }

    fn one_in(&mut self, bound: usize) -> bool {
        self.below(bound) == 0
    }

    fn seconds(&mut self, from: f64, to: f64) -> f64 {
        // Tenths are easier to read.
        (self.0.random_range(from..=to) * 10.0).round() / 10.0
    }

    fn of<'a>(&mut self, names: &[&'a str]) -> &'a str {
        names[self.below(names.len())]
    }

    fn scene(&mut self) -> Scene {
        let vehicles = self.vehicles();
        let guests = self.guests();
        let bottles = self.bottles(&guests);
        let incidents = self.incidents(&vehicles, &bottles);
        let together = 1 + self.below(4);
        let noise = (!self.one_in(3)).then(|| NoiseRates {
            lost: self.below(31) as u32,
            late: self.below(31) as u32,
            twice: self.below(21) as u32,
            most_late: Time::from_secs(self.seconds(0.1, 3.0)),
        });
        let paper = Restaurant::of_the_paper();
        let room = RoomPlan {
            mover: paper.room().mover,
            vehicles,
            bottles,
            guests,
        };
        Scene {
            restaurant: paper.with_room(room).expect("such a restaurant can be"),
            together: NonZeroUsize::new(together).expect("at least one"),
            noise,
            incidents,
        }
    }

    /// Two to five, of which one to three carry; one watches at the door, and somebody takes orders.
    fn vehicles(&mut self) -> BTreeMap<Symbol, VehiclePlan> {
        let all = 2 + self.below(4);
        let carriers = (1 + self.below(3)).min(all - 1);
        let names = (1..=all).map(|number| Symbol::from(format!("k{number}")));
        let vehicles = names.enumerate().map(|(place, name)| {
            let plan = if place == 0 {
                made_of("entrance", &["watch"], &["eyes", "voice"])
            } else if place < all - carriers {
                made_of("table2", &["order"], &["base", "eyes", "voice"])
            } else {
                let start = self.of(&["kitchen", "kitchen", "table1", "table3"]);
                let orders_too = all - carriers == 1 || self.one_in(4);
                let can: &[&str] = match orders_too {
                    true => &["carry", "order"],
                    false => &["carry"],
                };
                made_of(start, can, &["arm", "base", "eyes", "tray", "voice"])
            };
            (name, plan)
        });
        vehicles.collect()
    }

    fn guests(&mut self) -> BTreeMap<Symbol, GuestPlan> {
        let names = (1..=1 + self.below(8)).map(|number| Symbol::from(format!("g{number}")));
        let guests = names.map(|name| {
            let arrives_s = self.seconds(1.0, 500.0);
            let sits_s = arrives_s + self.seconds(10.0, 30.0);
            let leaves_s = self
                .one_in(3)
                .then(|| sits_s + self.seconds(-5.0, 500.0).round());
            let plan = GuestPlan {
                table: Symbol::from(self.of(&TABLES)),
                wants: Symbol::from(self.of(&KINDS)),
                arrives_s: Some(arrives_s),
                sits_s: Some(sits_s).filter(|at| leaves_s.is_none_or(|leaves| *at < leaves)),
                leaves_s,
            };
            (name, plan)
        });
        guests.collect()
    }

    /// As many of each kind as are wanted, or some more, or one too few.
    fn bottles(&mut self, guests: &BTreeMap<Symbol, GuestPlan>) -> BTreeMap<Symbol, BottlePlan> {
        let mut bottles = BTreeMap::new();
        for kind in KINDS {
            let wanted = guests.values().filter(|it| it.wants == kind).count();
            let count = match self.below(6) {
                0 => wanted.saturating_sub(1),
                more => wanted + more / 2,
            };
            for number in 1..=count {
                let plan = BottlePlan {
                    kind: Symbol::from(kind),
                    place: Symbol::from("kitchen"),
                };
                bottles.insert(Symbol::from(format!("{kind}{number}")), plan);
            }
        }
        bottles
    }

    fn incidents(
        &mut self,
        vehicles: &BTreeMap<Symbol, VehiclePlan>,
        bottles: &BTreeMap<Symbol, BottlePlan>,
    ) -> Vec<(Time, Incident)> {
        let mut incidents = Vec::new();
        let names: Vec<&str> = vehicles.keys().map(Symbol::as_str).collect();
        let bottles: Vec<&str> = bottles.keys().map(Symbol::as_str).collect();
        // Who is down at a time is not killed once more.
        let mut killed = BTreeSet::new();
        for _ in 0..self.below(8) {
            let at = self.seconds(5.0, 900.0);
            let mut add = |at_s: f64, what| incidents.push((Time::from_secs(at_s), what));
            match self.below(7) {
                0 if !bottles.is_empty() => add(at, Incident::Take(self.of(&bottles).into())),
                1 if !bottles.is_empty() => {
                    let (bottle, place) = (self.of(&bottles).into(), self.of(&PLACES).into());
                    let edge = self.one_in(2);
                    let put = Incident::Put {
                        bottle,
                        place,
                        edge,
                    };
                    add(at, put);
                }
                2 => {
                    let table = self.of(&TABLES);
                    add(at, Incident::Block(table.into()));
                    let later = at + self.seconds(5.0, 200.0);
                    add(later, Incident::Free(table.into()));
                }
                3 => {
                    let place = self.of(&PLACES).into();
                    let whom = self.one_in(3).then(|| self.of(&names).into());
                    add(at, Incident::Spill(place, whom));
                }
                4 => add(at, Incident::Clear(self.of(&TABLES).into())),
                _ => {
                    let whom = self.of(&names);
                    if !killed.insert(whom) {
                        continue;
                    }
                    add(at, Incident::Kill(whom.into()));
                    if !self.one_in(4) {
                        let later = at + self.seconds(0.1, 60.0);
                        let remembers = !self.one_in(5);
                        add(later, Incident::Restart(whom.into(), remembers));
                    }
                }
            }
        }
        incidents.sort_by_key(|(at, _)| *at);
        incidents
    }
}

fn made_of(start: &str, can: &[&str], parts: &[&str]) -> VehiclePlan {
    let symbols = |names: &[&str]| names.iter().map(|name| Symbol::from(*name)).collect();
    let provides = match can.contains(&"order") {
        true => Restaurant::of_the_paper().room().vehicles[&Symbol::from("k2")]
            .provides
            .clone(),
        false => BTreeMap::new(),
    };
    VehiclePlan {
        start: Symbol::from(start),
        can: symbols(can),
        parts: symbols(parts),
        provides,
    }
}
