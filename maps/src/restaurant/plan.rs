//! Who and what is in a restaurant when it opens, and whether that can be.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::language::nearest;
use agent_core::model::{Pattern, Symbol};

use crate::{Level, Site};

/// Names that are parts of keys already, or of those who are no vehicles.
const TAKEN: [&str; 13] = [
    "alive",
    "clock",
    "event",
    "facts",
    "goal",
    "instruction",
    "intermezzo",
    "report",
    "room",
    "supervisor",
    "team",
    "user",
    "world",
];
/// What a vehicle can be made of (`docs/executor.md`).
pub const PARTS: [&str; 5] = ["arm", "base", "eyes", "tray", "voice"];

/// So quick that nothing is seen of it: then a way takes its length divided by the speed.
const AT_ONCE: f64 = 1e9;

/// What is in a restaurant beside its map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoomPlan {
    /// How every base drives.
    pub mover: MoverPlan,
    /// By name.
    pub vehicles: BTreeMap<Symbol, VehiclePlan>,
    /// By name.
    pub bottles: BTreeMap<Symbol, BottlePlan>,
    /// By name.
    pub guests: BTreeMap<Symbol, GuestPlan>,
}

/// How a base drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoverPlan {
    /// Top speed, in metres a second.
    pub speed_m_s: f64,
    /// How quickly it gains speed.
    pub acceleration_m_s2: f64,
    /// How quickly it loses speed.
    pub deceleration_m_s2: f64,
    /// How quickly it turns on the spot.
    pub turn_rate_rad_s: f64,
}

impl Default for MoverPlan {
    /// That of the paper's vehicles, of which nothing but the speed is known.
    fn default() -> Self {
        Self {
            speed_m_s: 0.3,
            acceleration_m_s2: AT_ONCE,
            deceleration_m_s2: AT_ONCE,
            turn_rate_rad_s: AT_ONCE,
        }
    }
}

/// A vehicle: what it is and where.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VehiclePlan {
    /// Where it stands at first; for good, if it has no base.
    pub start: Symbol,
    /// Its skills: objects of the domain.
    pub can: BTreeSet<Symbol>,
    /// What it is made of, of [`PARTS`].
    pub parts: BTreeSet<Symbol>,
    /// By predicate: the task that finds out such a fact. Variables are the predicate's parameters.
    pub provides: BTreeMap<Symbol, Pattern>,
}

/// A bottle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BottlePlan {
    /// What is in it.
    pub kind: Symbol,
    /// Where it stands at first.
    pub place: Symbol,
}

/// A guest. Who has no times comes when somebody says so.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GuestPlan {
    /// Where this guest will sit.
    pub table: Symbol,
    /// What this guest will say when asked.
    pub wants: Symbol,
    /// When this guest stands in the entrance, in seconds after the beginning.
    pub arrives_s: Option<f64>,
    /// When this guest sits down.
    pub sits_s: Option<f64>,
    /// When this guest goes.
    pub leaves_s: Option<f64>,
}

impl RoomPlan {
    /// All kinds of drink that there are or that anybody wants.
    pub fn kinds(&self) -> BTreeSet<&Symbol> {
        let there = self.bottles.values().map(|bottle| &bottle.kind);
        there
            .chain(self.guests.values().map(|guest| &guest.wants))
            .collect()
    }

    /// All that cannot be, each with the key of the entry that says so.
    pub(super) fn faults(&self, site: &Site, level: &Level) -> Vec<(String, String)> {
        let mut faults = Faults {
            site,
            level,
            found: Vec::new(),
        };
        faults.mover(&self.mover);
        for (name, vehicle) in &self.vehicles {
            faults.vehicle(name, vehicle);
        }
        for (name, bottle) in &self.bottles {
            faults.place(format!("bottle.{name}.place"), &bottle.place);
        }
        for (name, guest) in &self.guests {
            faults.guest(name, guest);
        }
        faults.names(self);
        faults.found
    }
}

struct Faults<'a> {
    site: &'a Site,
    level: &'a Level,
    found: Vec<(String, String)>,
}

impl Faults<'_> {
    fn add(&mut self, key: String, message: impl Into<String>) {
        self.found.push((key, message.into()));
    }

    fn mover(&mut self, mover: &MoverPlan) {
        for (key, value) in [
            ("speed_m_s", mover.speed_m_s),
            ("acceleration_m_s2", mover.acceleration_m_s2),
            ("deceleration_m_s2", mover.deceleration_m_s2),
            ("turn_rate_rad_s", mover.turn_rate_rad_s),
        ] {
            if !(value.is_finite() && value > 0.0) {
                self.add(
                    format!("mover.{key}"),
                    "must be positive, or nobody arrives",
                );
            }
        }
    }

    fn place(&mut self, key: String, place: &Symbol) {
        if self.site.node(place.as_str()).is_none() {
            let known = self.site.nodes().map(|node| node.name().as_str());
            let hint = hint(place, known);
            self.add(key, format!("`{place}` is not a place of the map{hint}"));
        }
    }

    fn vehicle(&mut self, name: &Symbol, vehicle: &VehiclePlan) {
        let key = |part: &str| format!("vehicle.{name}.{part}");
        let fits = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if !name.as_str().chars().all(fits) {
            self.add(
                format!("vehicle.{name}"),
                "a vehicle's name has letters, digits, `-` and `_` only",
            );
        }
        if TAKEN.contains(&name.as_str()) {
            self.add(
                format!("vehicle.{name}"),
                format!("`{name}` means something else on the wire; choose another name"),
            );
        }
        self.place(key("start"), &vehicle.start);
        for part in &vehicle.parts {
            if !PARTS.iter().any(|known| part == known) {
                let hint = hint(part, PARTS);
                let known = PARTS.join(", ");
                self.add(
                    key(&format!("parts.{part}")),
                    format!("`{part}` is not a part: there are {known}{hint}"),
                );
            }
        }
        for skill in &vehicle.can {
            let constants = &self.level.domain.constants;
            if constants.get(skill).is_none_or(|kind| kind != "skill") {
                let known = constants.iter().filter(|(_, kind)| *kind == "skill");
                let hint = hint(skill, known.map(|(name, _)| name.as_str()));
                self.add(
                    key(&format!("can.{skill}")),
                    format!("`{skill}` is not a skill of the domain{hint}"),
                );
            }
        }
        for (predicate, task) in &vehicle.provides {
            let asked = &self.level.model.asked;
            if !asked.contains(predicate) {
                let hint = hint(predicate, asked.iter().map(Symbol::as_str));
                self.add(
                    key("provides"),
                    format!("`{predicate}` is not `asked` in the execution model{hint}"),
                );
            }
            let tasks = &self.level.domain.tasks;
            let parameters = tasks.get(&task.name);
            if parameters.is_none_or(|parameters| parameters.len() != task.args.len()) {
                let hint = hint(&task.name, tasks.keys().map(Symbol::as_str));
                self.add(
                    key("provides"),
                    format!(
                        "the domain has no task `{}` of {} argument(s){hint}",
                        task.name,
                        task.args.len()
                    ),
                );
            }
        }
    }

    fn guest(&mut self, name: &Symbol, guest: &GuestPlan) {
        let key = |part: &str| format!("guest.{name}.{part}");
        let table = self.site.node(guest.table.as_str());
        if table.is_none_or(|node| node.kind() != Some("table")) {
            let known = self
                .site
                .nodes()
                .filter(|node| node.kind() == Some("table"));
            let hint = hint(&guest.table, known.map(|node| node.name().as_str()));
            let message = format!("`{}` is not a table of the map{hint}", guest.table);
            self.add(key("table"), message);
        }
        let times = [
            ("arrives_s", guest.arrives_s),
            ("sits_s", guest.sits_s),
            ("leaves_s", guest.leaves_s),
        ];
        let mut last = 0.0;
        for (part, time) in times {
            let Some(time) = time else { continue };
            if !time.is_finite() || time < last {
                self.add(key(part), "is before what comes before it");
            }
            last = time;
        }
    }

    fn names(&mut self, plan: &RoomPlan) {
        let vehicles = plan.vehicles.keys().map(|name| ("vehicle", name));
        let bottles = plan.bottles.keys().map(|name| ("bottle", name));
        let guests = plan.guests.keys().map(|name| ("guest", name));
        let kinds = plan.kinds().into_iter().map(|name| ("kind", name));
        let mut seen: BTreeMap<&Symbol, &str> = BTreeMap::new();
        for (what, name) in vehicles.chain(bottles).chain(guests).chain(kinds) {
            let on_the_map = self.site.node(name.as_str()).is_some()
                || self.site.passage(name.as_str()).is_some()
                || self.site.area(name.as_str()).is_some()
                || self.site.door(name.as_str()).is_some();
            let constant = self.level.domain.constants.contains_key(name);
            if let Some(other) = seen.insert(name, what) {
                self.add(
                    format!("{what}.{name}"),
                    format!("`{name}` is the name of a {other} already"),
                );
            } else if on_the_map || constant {
                self.add(
                    format!("{what}.{name}"),
                    format!("`{name}` is the name of something of the map or the domain already"),
                );
            }
        }
    }
}

pub(super) fn hint<'a>(name: &Symbol, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(name.as_str(), known)
        .map_or_else(String::new, |near| format!("; did you mean `{near}`?"))
}
