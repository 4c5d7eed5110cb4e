//! The detailed level: from node to node, one area at a time.

use std::collections::BTreeMap;
use std::sync::Arc;

use agent_core::agent::MapsBelow;
use agent_core::model::{Fact, Map, Symbol};

use super::{MapWriter, atom};
use crate::site::{Node, Passage, Site, metres};

/// One area for the child agent, in the words of `node.hddl`: its nodes and passages, its doors
/// and what lies right behind them. `None` if there is no such area.
pub fn node_level(site: &Site, area: &str) -> Option<Map> {
    let area = site.area(area)?;
    Some(excerpt(
        site,
        site.passages_at(area.nodes()),
        area.nodes().filter_map(|node| site.node(node.as_str())),
        |passage| site.areas_of(passage).contains(&area.name()),
    ))
}

/// The maps of all areas, by area.
pub fn area_maps(site: &Site) -> BTreeMap<Symbol, Map> {
    site.areas()
        .filter_map(|area| {
            let map = node_level(site, area.name().as_str())?;
            Some((area.name().clone(), map))
        })
        .collect()
}

/// With so many areas all maps are made at once, which takes a few milliseconds.
const FEW: usize = 100;

/// The maps of all areas of a site: made beforehand if they are few, as to make one takes longer than
/// everything else that a robot waits for between two actions; of many, each when it is asked for.
#[derive(Clone, Debug)]
pub struct AreaMaps {
    site: Arc<Site>,
    made: Arc<BTreeMap<Symbol, Map>>,
}

impl AreaMaps {
    /// Those of this site.
    pub fn of(site: Arc<Site>) -> Self {
        let made = match site.areas().nth(FEW) {
            None => area_maps(&site),
            Some(_) => BTreeMap::new(),
        };
        Self {
            site,
            made: Arc::new(made),
        }
    }
}

impl MapsBelow for AreaMaps {
    fn map_of(&self, place: &Symbol) -> Option<Map> {
        let made = self.made.get(place).cloned();
        made.or_else(|| node_level(&self.site, place.as_str()))
    }
}

/// The whole site in the words of `node.hddl`, for an agent without a parent.
pub fn whole_node_level(site: &Site) -> Map {
    excerpt(site, site.passages().collect(), site.nodes(), |_| true)
}

/// What the child agent believes of itself when the robot stands at a node. `None` if there is
/// no such node.
pub fn node_start(site: &Site, node: &str) -> Option<Vec<Fact>> {
    Some(vec![atom("at", &[site.node(node)?.name()])])
}

/// These nodes, these passages, which are all that `belongs` accepts, and the nodes at their ends.
fn excerpt<'a>(
    site: &'a Site,
    passages: Vec<&'a Passage>,
    nodes: impl Iterator<Item = &'a Node>,
    belongs: impl Fn(&Passage) -> bool,
) -> Map {
    let ends = passages.iter().flat_map(|passage| passage.ends());
    let nodes: BTreeMap<&Symbol, &Node> = ends
        .filter_map(|end| site.node(end.as_str()))
        .chain(nodes)
        .map(|node| (node.name(), node))
        .collect();

    let mut map = MapWriter::default();
    for node in nodes.values() {
        map.object(node.name(), "node");
        map.object(node.area(), "area");
        map.fact("inside", &[node.name(), node.area()]);
        for (to, length_mm) in site.distances_mm(node, &belongs) {
            map.value("distance", &[node.name(), to], metres(length_mm));
        }
    }
    for passage in passages {
        add_passage(&mut map, site, passage);
    }
    map.finish()
}

fn add_passage(map: &mut MapWriter, site: &Site, passage: &Passage) {
    let name = passage.name();
    map.object(name, "arc");
    map.value("length", &[name], passage.length_m());
    for end in passage.ends() {
        // Until the robot stands on the arc and says how far it is.
        map.value("gap", &[name, end], passage.length_m());
    }
    for (from, to) in passage.directions() {
        match passage.door() {
            Some(door) => map.fact("gate", &[from, to, name, door]),
            None => {
                map.fact("link", &[from, to, name]);
                // Wherever it stands on the arc; a one-way arc is left at its far end only.
                map.fact("free", &[name, to]);
            }
        }
    }
    if let Some(door) = passage.door().and_then(|door| site.door(door.as_str())) {
        map.object(door.name(), "door");
        if door.is_open_at_first() {
            map.fact("open", &[door.name()]);
        }
    }
}
