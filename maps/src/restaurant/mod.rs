//! Restaurants: one level of planning, and several vehicles. That of the multitasking paper is part
//! of the program, as the museum is.

mod plan;
mod read;

use std::path::Path;
use std::sync::Arc;

use agent_core::model::{Fact, FactChange, Map, Symbol};

use crate::fingerprint::fingerprint;
use crate::vocabulary::missing_words;
use crate::{
    Finding, Level, NotInOrder, Site, level_from_texts, node_start, read_level, whole_node_level,
};

pub use plan::{BottlePlan, GuestPlan, MoverPlan, PARTS, RoomPlan, VehiclePlan};

/// `map.geojson`.
pub const MAP: &str = include_str!("../../restaurant/map.geojson");
/// `node.hddl`, its only level.
pub const DOMAIN: &str = include_str!("../../restaurant/node.hddl");
/// `node.toml`.
pub const MODEL: &str = include_str!("../../restaurant/node.toml");
/// `room.toml`: who and what is there.
pub const ROOM: &str = include_str!("../../restaurant/room.toml");

/// The files of a restaurant.
const FILES: [&str; 4] = ["map.geojson", "node.hddl", "node.toml", "room.toml"];

/// A map, the level that all its vehicles plan on, and who and what is there.
///
/// Invariant, kept by whatever makes one: what is there fits map and domain, and the domain has the
/// words for it.
#[derive(Clone, Debug)]
pub struct Restaurant {
    name: String,
    fingerprint: String,
    site: Arc<Site>,
    level: Level,
    room: RoomPlan,
}

/// What a vehicle knows when the restaurant opens.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleStart {
    /// All places, ways, bottles, guests, kinds and vehicles, and what never changes of them.
    pub map: Map,
    /// Where it stands, what it holds and can do, and where all bottles stand.
    pub facts: Vec<Fact>,
}

impl Restaurant {
    /// Reads a folder with `map.geojson`, `node.hddl`, `node.toml` and `room.toml`.
    ///
    /// # Errors
    /// Everything that is wrong with any of the files.
    pub fn read(dir: impl AsRef<Path>) -> Result<Self, Vec<Finding>> {
        let dir = dir.as_ref();
        let name = dir.file_name().map(|name| name.to_string_lossy());
        // What cannot be read is a finding below.
        let texts = FILES.map(|file| std::fs::read(dir.join(file)).unwrap_or_default());
        let file = dir.join("room.toml").display().to_string();
        let room = std::fs::read_to_string(dir.join("room.toml"));
        let room = room.map_err(|error| finding(&file, format!("cannot be read: {error}")));
        Self::from_parts(
            name.unwrap_or_default().as_ref(),
            fingerprint(&texts.each_ref().map(Vec::as_slice)),
            Site::read(dir.join("map.geojson")),
            read_level(dir, "node"),
            (&file, room),
        )
    }

    /// The restaurant in a folder, or that of the paper if none is named.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn open(dir: Option<&Path>) -> Result<Self, NotInOrder> {
        dir.map_or_else(
            || Ok(Self::of_the_paper()),
            |dir| Self::read(dir).map_err(NotInOrder),
        )
    }

    /// The restaurant of the paper, which is part of the program.
    pub fn of_the_paper() -> Self {
        let [map, hddl, toml, room] = FILES;
        // The texts do not change once the program is built, and a test reads them.
        let texts = [MAP, DOMAIN, MODEL, ROOM];
        Self::from_parts(
            "restaurant",
            fingerprint(&texts.map(str::as_bytes)),
            Site::from_text(map, MAP),
            level_from_texts(DOMAIN, MODEL, [hddl, toml]),
            (room, Ok(ROOM.to_owned())),
        )
        .expect("the restaurant is in order")
    }

    fn from_parts(
        name: &str,
        fingerprint: String,
        site: Result<Site, Vec<Finding>>,
        level: Result<Level, Vec<Finding>>,
        (file, room): (&str, Result<String, Finding>),
    ) -> Result<Self, Vec<Finding>> {
        let room = room.map_err(|finding| vec![finding]);
        let (for_site, for_level) = (site.as_ref().ok(), level.as_ref().ok());
        let room = room.and_then(|text| read::read_room(file, &text, for_site, for_level));
        match (site, level, room) {
            (Ok(site), Ok(level), Ok(room)) => {
                let restaurant = Self {
                    name: match site.name() {
                        "" => name.to_owned(),
                        name => name.to_owned(),
                    },
                    fingerprint,
                    site: Arc::new(site),
                    level,
                    room,
                };
                restaurant.unspoken(file).map(|()| restaurant)
            }
            (site, level, room) => {
                let found = [site.err(), level.err(), room.err()];
                Err(found.into_iter().flatten().flatten().collect())
            }
        }
    }

    /// The same place with others in it.
    ///
    /// # Errors
    /// What cannot be.
    pub fn with_room(&self, room: RoomPlan) -> Result<Self, Vec<Finding>> {
        let faults = room.faults(&self.site, &self.level);
        if !faults.is_empty() {
            let faults = faults.into_iter();
            let findings = faults.map(|(key, message)| finding(&key, message));
            return Err(findings.collect());
        }
        let fingerprint = fingerprint(&[
            self.fingerprint.as_bytes(),
            // Nobody reads it; it is other for another plan.
            format!("{room:?}").as_bytes(),
        ]);
        let restaurant = Self {
            room,
            fingerprint,
            ..self.clone()
        };
        restaurant.unspoken("room").map(|()| restaurant)
    }

    fn unspoken(&self, file: &str) -> Result<(), Vec<Finding>> {
        let mut missing = missing_words(&self.level.domain, &self.map());
        for name in self.room.vehicles.keys() {
            let known = self.start(name.as_str()).unwrap_or_else(|| VehicleStart {
                map: Map::default(),
                facts: Vec::new(),
            });
            let predicates = &self.level.domain.predicates;
            let strange = known.facts.iter().filter(|fact| {
                let parameters = predicates.get(&fact.name);
                parameters.is_none_or(|parameters| parameters.len() != fact.args.len())
            });
            missing.extend(strange.map(|fact| format!("the domain cannot say {fact}")));
        }
        missing.sort();
        missing.dedup();
        if missing.is_empty() {
            return Ok(());
        }
        let missing = missing.into_iter();
        Err(missing.map(|message| finding(file, message)).collect())
    }

    /// What the map calls it; if that is nothing, what its folder is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Of the texts that it was read from: what was written down in one place makes no sense in
    /// another.
    pub fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// Its map.
    pub fn site(&self) -> &Arc<Site> {
        &self.site
    }

    /// What its vehicles plan with.
    pub fn level(&self) -> &Level {
        &self.level
    }

    /// Who and what is in it when it opens.
    pub fn room(&self) -> &RoomPlan {
        &self.room
    }

    /// The places on a vehicle's tray, in their order: what the domain has of the type `slot`.
    pub fn slots(&self) -> impl Iterator<Item = &Symbol> {
        let constants = self.level.domain.constants.iter();
        constants.filter_map(|(name, kind)| (kind == "slot").then_some(name))
    }

    /// Places, ways and things, and what never changes of them.
    fn map(&self) -> Map {
        let mut map = whole_node_level(&self.site);
        let mut object = |name: &Symbol, kind: &str| {
            map.objects.insert(name.clone(), Symbol::from(kind));
        };
        for vehicle in self.room.vehicles.keys() {
            object(vehicle, "vehicle");
        }
        for guest in self.room.guests.keys() {
            object(guest, "guest");
        }
        for kind in self.room.kinds() {
            object(kind, "kind");
        }
        for bottle in self.room.bottles.keys() {
            object(bottle, "bottle");
        }
        for (name, bottle) in &self.room.bottles {
            map.facts
                .apply(&FactChange::Add(fact("of", &[name, &bottle.kind])));
        }
        for node in self.site.nodes() {
            // A place of another kind is just a place.
            let kinds = ["table", "counter", "entrance"];
            if let Some(kind) = node.kind().filter(|kind| kinds.contains(kind)) {
                map.facts
                    .apply(&FactChange::Add(fact(kind, &[node.name()])));
            }
        }
        map
    }

    /// What a vehicle knows at the beginning. `None` if there is no such vehicle.
    pub fn start(&self, vehicle: &str) -> Option<VehicleStart> {
        let vehicle = self.room.vehicles.get(vehicle)?;
        let mut facts = node_start(&self.site, vehicle.start.as_str())?;
        facts.extend(vehicle.can.iter().map(|skill| fact("able", &[skill])));
        // Who has no hand has none in the way either: a vehicle drives with its hand free.
        facts.push(fact("hand-free", &[]));
        if vehicle.parts.contains("tray") {
            facts.extend(self.slots().map(|slot| fact("empty", &[slot])));
        }
        let bottles = self.room.bottles.iter();
        facts.extend(bottles.map(|(name, bottle)| fact("stands", &[name, &bottle.place])));
        let map = self.map();
        Some(VehicleStart { map, facts })
    }
}

fn finding(file: &str, message: String) -> Finding {
    Finding {
        file: file.to_owned(),
        place: String::new(),
        message,
        excerpt: String::new(),
    }
}

fn fact(name: &str, args: &[&Symbol]) -> Fact {
    Fact {
        name: Symbol::from(name),
        args: args.iter().copied().cloned().collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The texts of the restaurant of the paper with another `room.toml`.
    fn refused(room: &str) -> String {
        let level = level_from_texts(DOMAIN, MODEL, ["node.hddl", "node.toml"]);
        let site = Site::from_text("map.geojson", MAP);
        let room = ("room.toml", Ok(room.to_owned()));
        let read = Restaurant::from_parts("r", String::new(), site, level, room);
        let findings = read.err().unwrap_or_default();
        let lines: Vec<String> = findings.iter().map(ToString::to_string).collect();
        lines.join("\n")
    }

    #[test]
    fn a_vehicle_knows_at_first_where_it_stands_what_it_can_do_and_where_the_bottles_are() {
        let restaurant = Restaurant::of_the_paper();
        let k3 = restaurant.start("k3").expect("there is such a vehicle");
        let says = |text: &str| k3.facts.iter().any(|fact| fact.to_string() == text);
        for text in [
            "(at kitchen)",
            "(able carry)",
            "(hand-free)",
            "(empty slot3)",
            "(stands cola1 kitchen)",
        ] {
            assert!(says(text), "{text}");
        }
        assert_eq!(k3.map.objects.get("ann").map(Symbol::as_str), Some("guest"));
        let never_changes =
            |name, args: &[&str]| k3.map.facts.holds(&Fact::new(name, args.iter().copied()));
        assert!(never_changes("of", &["cola1", "cola"]));
        assert!(never_changes("counter", &["kitchen"]));
        let k1 = restaurant.start("k1").expect("there is such a vehicle");
        assert!(!k1.facts.iter().any(|fact| fact.name == "empty"));
        assert!(restaurant.start("k9").is_none());
    }

    #[test]
    fn the_paper_s_restaurant_is_what_its_folder_says() {
        let dir = concat!(env!("CARGO_MANIFEST_DIR"), "/restaurant");
        let read = Restaurant::read(dir).expect("the restaurant is in order");
        assert_eq!(read.fingerprint(), Restaurant::of_the_paper().fingerprint());
        assert_eq!(read.room(), Restaurant::of_the_paper().room());
    }

    #[test]
    fn what_cannot_be_is_said_with_its_line() {
        let wrong = "[vehicle.k3]\nstart = \"kitchn\"\nparts = [\"base\", \"leg\"]\n\
            [bottle]\nann = { kind = \"cola\", place = \"kitchen\" }\n\
            [guest]\nann = { table = \"kitchen\", wants = \"cola\", arrives_s = 5.0, leaves_s = 2.0 }\n";
        let findings = refused(wrong);
        for part in [
            "room.toml:2:9: vehicle.k3.start: `kitchn` is not a place of the map; did you mean `kitchen`?",
            "room.toml:3:18: vehicle.k3.parts.leg: `leg` is not a part",
            "room.toml:7:17: guest.ann.table: `kitchen` is not a table",
            "guest.ann.leaves_s: is before what comes before it",
            "guest.ann: `ann` is the name of a bottle already",
        ] {
            assert!(findings.contains(part), "{part}\n---\n{findings}");
        }
    }

    #[test]
    fn no_vehicle_is_called_as_something_else_on_the_wire_is() {
        for name in ["room", "team", "goal"] {
            let findings = refused(&format!(
                "[vehicle.{name}]\nstart = \"kitchen\"\nparts = []\n"
            ));
            let words = format!("vehicle.{name}: `{name}` means something else");
            assert!(findings.contains(&words), "{findings}");
        }
    }

    #[test]
    fn what_cannot_be_read_is_said_with_its_line_too() {
        let findings = refused("[vehicle.k3]\nstrat = \"kitchen\"\n");
        assert!(
            findings.starts_with("room.toml:2:1: unknown field `strat`"),
            "{findings}"
        );
        let findings = refused(
            "[vehicle.k3]\nstart = \"kitchen\"\nparts = []\ncan = [\"fly\"]\n\
             provides = { wants = \"(fnd ?g)\" }\n",
        );
        for part in [
            "room.toml:4:8: vehicle.k3.can.fly: `fly` is not a skill",
            "vehicle.k3.provides: the domain has no task `fnd` of 1 argument(s); did you mean `find`?",
        ] {
            assert!(findings.contains(part), "{part}\n---\n{findings}");
        }
    }

    #[test]
    fn map_domain_and_execution_model_are_in_order_and_fit() {
        let site = Site::from_text("map.geojson", MAP).expect("the map is in order");
        let level = match level_from_texts(DOMAIN, MODEL, ["node.hddl", "node.toml"]) {
            Ok(level) => level,
            Err(findings) => {
                let lines: Vec<String> = findings.iter().map(ToString::to_string).collect();
                panic!("{}", lines.join("\n"));
            }
        };
        let missing = missing_words(&level.domain, &whole_node_level(&site));
        assert_eq!(missing, [""; 0]);
    }

    #[test]
    fn the_ways_are_as_long_as_the_documented_times_say() {
        let site = Site::from_text("map.geojson", MAP).expect("the map is in order");
        let seconds = |from: &str, to: &str| {
            let both = site.passages().find(|passage| {
                let ends = passage.ends().map(|end| end.as_str());
                ends.contains(&from) && ends.contains(&to)
            });
            both.map(|passage| passage.length_m() / 0.3)
        };
        for (from, to, wanted_s) in [
            ("kitchen", "table1", 40.0),
            ("kitchen", "table2", 48.0),
            ("table1", "table2", 23.0),
        ] {
            let found_s = seconds(from, to).expect("there is a way");
            assert!((found_s - wanted_s).abs() < 1e-9, "{from} {to} {found_s}");
        }
    }
}
