//! The place that scenarios happen in: three areas in a ring, two nodes and one door each.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use agent_core::agent::{Agent, Configuration, MapsBelow};
use agent_core::model::{Map, Symbol};
use agent_core::planner::{AnyPlanner, PlannerKind, Settings};
use executor_sim::{Controller, Faults, Floor, MoverSpec, Place, World};
use maps::{Level, Site};

/// Everything that is the same in all scenarios, read once.
pub struct Ground {
    site: Arc<Site>,
    floor: Floor,
    area: Level,
    node: Level,
    /// With one child and with two, by planner.
    parent: [Starters; 2],
    /// Whoever is in charge of everything else, and of one area.
    child: [Starters; 2],
}

/// The maps of all areas.
#[derive(Debug)]
struct AreaMaps(BTreeMap<Symbol, Map>);

impl MapsBelow for AreaMaps {
    fn map_of(&self, place: &Symbol) -> Option<Map> {
        self.0.get(place).cloned()
    }
}

/// Agents that have just been made, one with each planner.
struct Starters([Agent<AnyPlanner>; 2]);

impl Starters {
    fn new(configuration: &Configuration) -> Self {
        Self([PlannerKind::Naive, PlannerKind::Graph].map(|kind| {
            let planner = AnyPlanner::new(kind, Settings::default());
            Agent::new(configuration.clone(), planner)
        }))
    }

    fn start(&self, epoch: u64, kind: PlannerKind) -> Agent<AnyPlanner> {
        let agent = match kind {
            PlannerKind::Naive => &self.0[0],
            PlannerKind::Graph => &self.0[1],
        };
        agent.clone().for_epoch(epoch)
    }
}

/// Its doors.
pub const DOORS: [&str; 3] = ["d1", "d2", "d3"];
/// Its nodes; the robot starts at the first.
pub const NODES: [&str; 6] = ["n1", "n2", "n3", "n4", "n5", "n6"];
/// The area that a second child is in charge of.
const EAST: &str = "a2";

impl Default for Ground {
    fn default() -> Self {
        Self::new()
    }
}

impl Ground {
    /// Reads it.
    ///
    /// # Panics
    /// If it is not in order, which a test would tell.
    pub fn new() -> Self {
        let site = Site::from_text("ring", &ring()).expect("the ring is in order");
        let site = Arc::new(site);
        let level = |domain: &str, model: &str, name: &str| {
            let files = [format!("{name}.hddl"), format!("{name}.toml")];
            maps::level_from_texts(domain, model, [&files[0], &files[1]])
                .expect("the museum's domains are in order")
        };
        let area = level(maps::museum::AREA_DOMAIN, maps::museum::AREA_MODEL, "area");
        let node = level(maps::museum::NODE_DOMAIN, maps::museum::NODE_MODEL, "node");
        let east = BTreeMap::from([(Symbol::from(EAST), Symbol::from("east"))]);
        let maps_below = Arc::new(AreaMaps(maps::area_maps(&site)));
        let parent = |wings| {
            let parent = parent_agent::configuration(&site, &area, NODES[0], "child", wings, 0);
            Configuration {
                maps_below: maps_below.clone(),
                ..parent.expect("the robot starts from a node")
            }
        };
        let child = |name| {
            child_agent::configuration(&site, &node, NODES[0], "executor", name, 0)
                .expect("the robot starts from a node")
        };
        Self {
            floor: Floor::try_from(&*site).expect("the ring is a floor"),
            parent: [BTreeMap::new(), east].map(|wings| Starters::new(&parent(wings))),
            child: ["child", "east"].map(|name| Starters::new(&child(name))),
            site,
            area,
            node,
        }
    }

    /// Its map.
    pub fn site(&self) -> &Site {
        &self.site
    }

    /// The levels of parent and child.
    pub fn levels(&self) -> [&Level; 2] {
        [&self.area, &self.node]
    }

    /// A parent that has just been started.
    pub fn parent(&self, epoch: u64, planner: PlannerKind, two: bool) -> Agent<AnyPlanner> {
        self.parent[usize::from(two)].start(epoch, planner)
    }

    /// A child that has just been started: the one in charge of one area, or that of all others.
    pub fn child(&self, east: bool, epoch: u64, planner: PlannerKind) -> Agent<AnyPlanner> {
        self.child[usize::from(east)].start(epoch, planner)
    }

    /// A controller that has just been started.
    ///
    /// # Panics
    /// If the museum's domains are not for a robot, which a test would tell.
    pub fn controller(&self, faults: Faults) -> Controller {
        Controller::new(
            &self.node.domain,
            &self.node.model,
            self.floor.clone(),
            faults,
        )
        .expect("the museum's domains are for a robot")
    }

    /// The world in the morning. Without hindsight no sensor tells afterwards what was done.
    ///
    /// # Panics
    /// If the robot starts nowhere, which a test would tell.
    pub fn world(&self, hindsight: bool) -> World {
        let spec = MoverSpec::default();
        let world = World::new(self.floor.clone(), spec, Place::at(NODES[0]))
            .expect("the robot starts from a node");
        if hindsight {
            world
        } else {
            world.without_hindsight()
        }
    }
}

/// The map: `n1 n2 | n3 n4 | n5 n6 |`, each bar a door, and the last leads back to the first.
fn ring() -> String {
    let corners = [
        [2.0, 0.0],
        [5.0, 0.0],
        [8.0, 2.0],
        [8.0, 5.0],
        [3.0, 7.0],
        [0.0, 4.0],
    ];
    let mut features = String::new();
    for (n, [x, y]) in corners.iter().enumerate() {
        let (id, area) = (n + 1, n / 2 + 1);
        let _ = write!(
            features,
            r#"{{"type": "Feature", "properties": {{"id": {id}, "metadata": {{"name": "n{id}", "area": "a{area}"}}}}, "geometry": {{"type": "Point", "coordinates": [{x}, {y}]}}}},"#
        );
    }
    for (n, from) in corners.iter().enumerate() {
        let next = (n + 1) % corners.len();
        let to = corners[next];
        let door = if n % 2 == 1 {
            format!(r#", "door": "d{}""#, n / 2 + 1)
        } else {
            String::new()
        };
        for (back, [a, b], [p, q]) in [
            (0, [n + 1, next + 1], [*from, to]),
            (1, [next + 1, n + 1], [to, *from]),
        ] {
            let id = 100 + 2 * n + back;
            let _ = write!(
                features,
                r#"{{"type": "Feature", "properties": {{"id": {id}, "startid": {a}, "endid": {b}, "metadata": {{"name": "w{}", "length_m": 6{door}}}}}, "geometry": {{"type": "LineString", "coordinates": [[{}, {}], [{}, {}]]}}}},"#,
                n + 1,
                p[0],
                p[1],
                q[0],
                q[1]
            );
        }
    }
    let features = features.trim_end_matches(',');
    format!(
        r#"{{"type": "FeatureCollection", "name": "ring", "doors": {{"d1": {{"open": true}}, "d2": {{"open": true}}, "d3": {{"open": true}}}}, "features": [{features}]}}"#
    )
}
