//! The rough level: from area to area, and what there is in each.

use agent_core::model::{Fact, Map, Symbol};

use super::rough::Rough;
use super::{MapWriter, atom, far};
use crate::site::{Site, metres};

/// The whole site for the parent agent, in the words of `area.hddl`.
///
/// The middle of an area is its *hub*: the node with the least total distance to the others of
/// its area. Crossing is from hub to hub, a visit from the hub to a node: the rough costs of a rough
/// plan. Where the robot has come in, or stands, is known, `leg`, `through` and `inner` are exact.
pub fn area_level(site: &Site) -> Map {
    let rough = Rough::of(site);
    let mut map = MapWriter::default();
    for node in site.nodes() {
        map.object(node.name(), "node");
        map.fact("located", &[node.name(), node.area()]);
    }
    for door in site.doors() {
        map.object(door.name(), "door");
        if door.is_open_at_first() {
            map.fact("open", &[door.name()]);
        }
    }
    for ((from, to, door), length_mm) in &rough.crossings {
        map.fact("joins", &[from, to, door]);
        map.value("crossing", &[from, to, door], metres(*length_mm));
    }
    for (node, length_mm) in &rough.visits {
        map.value("visit", &[node], metres(*length_mm));
    }
    for ((node, door), length_mm) in &rough.legs {
        map.value("leg", &[node, door], metres(*length_mm));
    }
    for ((area, first, second), length_mm) in &rough.throughs {
        map.value("through", &[area, first, second], metres(*length_mm));
    }
    for ((area, door, node), length_mm) in &rough.inners {
        map.value("inner", &[area, door, node], metres(*length_mm));
    }
    for area in site.areas() {
        map.object(area.name(), "area");
    }
    if far::can_be_listed(site) {
        for area in site.areas() {
            for (node, length_mm) in far::least_lengths(site, area) {
                map.value("distance", &[area.name(), node], metres(length_mm));
            }
        }
        map.finish()
    } else {
        let mut map = map.finish();
        map.facts
            .add_landmarks(far::landmarks(site, Symbol::from("distance")));
        map
    }
}

/// What the parent agent believes of itself when the robot stands at a node. `None` if there is
/// no such node.
pub fn area_start(site: &Site, node: &str) -> Option<Vec<Fact>> {
    let node = site.node(node)?;
    Some(vec![atom("in", &[node.area()]), atom("at", &[node.name()])])
}
