//! Restaurants to measure in: the paper's two cases, and evenings of any size.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;

use agent_core::model::Symbol;
use maps::Restaurant;
use maps::restaurant::{BottlePlan, GuestPlan, RoomPlan, VehiclePlan};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::ExperimentError;

/// An evening.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    /// Who and what is there.
    pub restaurant: Restaurant,
    /// How many goals a vehicle works on together; 1 is one after the other.
    pub together: NonZeroUsize,
    /// Whether the vehicles hear of each other.
    pub is_networked: bool,
}

/// How a crew serves.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Way {
    /// All goals of a vehicle together.
    Parallel,
    /// One after the other.
    Sequential,
}

impl Way {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Parallel => "parallel",
            Self::Sequential => "sequential",
        }
    }

    pub(super) fn together(self) -> NonZeroUsize {
        match self {
            Self::Parallel => vehicle::TOGETHER,
            Self::Sequential => NonZeroUsize::MIN,
        }
    }
}

fn made_of(start: &str, can: &[&str], parts: &[&str]) -> VehiclePlan {
    let symbols = |names: &[&str]| -> BTreeSet<Symbol> {
        names.iter().map(|name| Symbol::from(*name)).collect()
    };
    VehiclePlan {
        start: Symbol::from(start),
        can: symbols(can),
        parts: symbols(parts),
        provides: BTreeMap::new(),
    }
}

const ALL_PARTS: [&str; 5] = ["arm", "base", "eyes", "tray", "voice"];
const WITHOUT_ARM: [&str; 3] = ["base", "eyes", "voice"];

fn watcher() -> VehiclePlan {
    made_of("entrance", &["watch"], &["eyes", "voice"])
}

fn waiter() -> VehiclePlan {
    let mut waiter = made_of("table2", &["order"], &WITHOUT_ARM);
    waiter.provides = Restaurant::of_the_paper().room().vehicles[&Symbol::from("k2")]
        .provides
        .clone();
    waiter
}

fn carrier() -> VehiclePlan {
    made_of("kitchen", &["carry"], &ALL_PARTS)
}

/// The guest whose drink is being fetched when the other one sits down, as the paper calls them.
pub(super) const FIRST: &str = "cc";
/// The guest whose waiting time the paper gives.
pub(super) const SECOND: &str = "lzh1";
/// The second guest sits down then.
pub(super) const SITS_S: f64 = 20.0;

fn bottles(kinds: &[(&str, usize)]) -> BTreeMap<Symbol, BottlePlan> {
    let all = kinds.iter().flat_map(|(kind, count)| {
        (1..=*count).map(move |number| {
            let bottle = BottlePlan {
                kind: Symbol::from(*kind),
                place: Symbol::from("kitchen"),
            };
            (Symbol::from(format!("{kind}{number}")), bottle)
        })
    });
    all.collect()
}

fn of_the_paper(
    vehicles: impl IntoIterator<Item = (&'static str, VehiclePlan)>,
) -> Result<Restaurant, ExperimentError> {
    let first = GuestPlan {
        table: Symbol::from("table1"),
        wants: Symbol::from("drink-a"),
        sits_s: Some(0.0),
        ..GuestPlan::default()
    };
    let second = GuestPlan {
        table: Symbol::from("table2"),
        wants: Symbol::from("drink-b"),
        sits_s: Some(SITS_S),
        ..GuestPlan::default()
    };
    let paper = Restaurant::of_the_paper();
    let room = RoomPlan {
        mover: paper.room().mover,
        vehicles: vehicles
            .into_iter()
            .map(|(name, plan)| (Symbol::from(name), plan))
            .collect(),
        bottles: bottles(&[("drink-a", 1), ("drink-b", 1)]),
        guests: BTreeMap::from([(Symbol::from(FIRST), first), (Symbol::from(SECOND), second)]),
    };
    paper.with_room(room).map_err(ExperimentError::findings)
}

/// Case 1: three vehicles, networked.
pub(super) fn case_1() -> Result<Setting, ExperimentError> {
    let vehicles = [("k1", watcher()), ("k2", waiter()), ("k3", carrier())];
    Ok(Setting {
        restaurant: of_the_paper(vehicles)?,
        together: Way::Parallel.together(),
        is_networked: true,
    })
}

/// Case 2: the carrier alone, which takes orders, too.
pub(super) fn case_2() -> Result<Setting, ExperimentError> {
    let alone = made_of("kitchen", &["carry", "order"], &ALL_PARTS);
    Ok(Setting {
        restaurant: of_the_paper([("k3", alone)])?,
        together: Way::Sequential.together(),
        is_networked: false,
    })
}

/// How long after one guest the next one comes, at most.
const NEXT_GUEST_S: f64 = 60.0;
/// From the entrance to the table.
const TO_THE_TABLE_S: f64 = 15.0;

/// An evening of so many guests, with a watcher, a waiter and so many carriers. The same seed has the same
/// guests, whoever serves.
pub(super) fn evening(
    guests: usize,
    carriers: usize,
    way: Way,
    seed: u64,
) -> Result<Setting, ExperimentError> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let kinds = ["cola", "juice", "water"];
    let tables = ["table1", "table2", "table3"];
    let mut at_s = 0.0;
    let mut plans = BTreeMap::new();
    for number in 1..=guests {
        let plan = GuestPlan {
            table: Symbol::from(tables[random.random_range(..tables.len())]),
            wants: Symbol::from(kinds[random.random_range(..kinds.len())]),
            arrives_s: Some(at_s),
            sits_s: Some(at_s + TO_THE_TABLE_S),
            leaves_s: None,
        };
        plans.insert(Symbol::from(format!("g{number}")), plan);
        at_s += NEXT_GUEST_S * random.random::<f64>();
    }
    let fixed = [("k1".to_owned(), watcher()), ("k2".to_owned(), waiter())];
    let carriers = (0..carriers).map(|number| (format!("k{}", number + 3), carrier()));
    let paper = Restaurant::of_the_paper();
    let room = RoomPlan {
        mover: paper.room().mover,
        vehicles: (fixed.into_iter().chain(carriers))
            .map(|(name, plan)| (Symbol::from(name), plan))
            .collect(),
        bottles: bottles(&kinds.map(|kind| {
            let wanted = plans.values().filter(|plan| plan.wants == kind);
            (kind, wanted.count())
        })),
        guests: plans,
    };
    Ok(Setting {
        restaurant: paper.with_room(room).map_err(ExperimentError::findings)?,
        together: way.together(),
        is_networked: true,
    })
}
