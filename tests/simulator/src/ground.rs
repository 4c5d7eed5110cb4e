//! The place that scenarios happen in: three areas in a ring, two nodes and one door each.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use agent_core::agent::{Agent, Configuration};
use agent_core::model::Symbol;
use agent_core::planner::{AnyPlanner, PlannerKind, Settings};
use executor_sim::{Controller, Faults, Floor, MoverSpec, Place, World};
use maps::{Level, Site};

/// Everything that is the same in all scenarios, read once.
pub struct Ground {
    site: Arc<Site>,
    floor: Floor,
    area: Level,
    node: Level,
    parent: [Configuration; 2],
    child: Configuration,
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
        let parent = |wings| {
            parent_agent::configuration(&site, &area, NODES[0], "child", wings, 0)
                .expect("the robot starts from a node")
        };
        let child = child_agent::configuration(&site, &node, NODES[0], "executor", "child", 0)
            .expect("the robot starts from a node");
        Self {
            floor: Floor::try_from(&*site).expect("the ring is a floor"),
            parent: [parent(BTreeMap::new()), parent(east)],
            child,
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
        agent(self.parent[usize::from(two)].clone(), epoch, planner)
    }

    /// A child of that name that has just been started.
    pub fn child(&self, name: &str, epoch: u64, planner: PlannerKind) -> Agent<AnyPlanner> {
        let mut configuration = self.child.clone();
        configuration.name = name.into();
        agent(configuration, epoch, planner)
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

fn agent(mut configuration: Configuration, epoch: u64, kind: PlannerKind) -> Agent<AnyPlanner> {
    configuration.epoch = epoch;
    Agent::new(configuration, AnyPlanner::new(kind, Settings::default()))
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
