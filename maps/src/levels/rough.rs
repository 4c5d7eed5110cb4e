//! What the rough level takes for distances: from the middle of an area to that of the next.

use std::collections::BTreeMap;

use agent_core::model::Symbol;
use pathfinding::prelude::dijkstra_all;

use crate::site::Site;

/// Going on to the next thing in an area is never free, however near it is.
const LEAST_VISIT_MM: u64 = 1000;

/// The lengths that the rough level plans with, in millimetres.
pub(super) struct Rough<'a> {
    /// From one area to the next through a door, in the directions in which it can be passed.
    pub(super) crossings: BTreeMap<(&'a Symbol, &'a Symbol, &'a Symbol), u64>,
    /// From the hub of its area to a node.
    pub(super) visits: BTreeMap<&'a Symbol, u64>,
    site: &'a Site,
}

/// The middle of an area, and how far it is from there to each of its nodes without leaving it.
struct Hub<'a> {
    node: &'a Symbol,
    out: BTreeMap<&'a Symbol, u64>,
}

impl<'a> Rough<'a> {
    pub(super) fn of(site: &'a Site) -> Self {
        // From each node of an area to each other, without leaving it.
        let inside: BTreeMap<&Symbol, BTreeMap<&Symbol, u64>> = site
            .nodes()
            .map(|node| {
                let distances = site.distances_mm(node, |passage| passage.door().is_none());
                (node.name(), distances)
            })
            .collect();
        let hubs: BTreeMap<&Symbol, Hub<'_>> = site
            .areas()
            .filter_map(|area| {
                let total = |node: &Symbol| inside[node].values().sum::<u64>();
                let node = area.nodes().min_by_key(|node| (total(node), *node))?;
                let out = inside[node].clone();
                Some((area.name(), Hub { node, out }))
            })
            .collect();

        let mut crossings = BTreeMap::new();
        for passage in site.passages() {
            let Some(door) = passage.door() else { continue };
            for (exit, entry) in passage.directions() {
                let [from, to] =
                    [exit, entry].map(|end| site.node(end.as_str()).map(crate::Node::area));
                let (Some(from), Some(to)) = (from, to) else {
                    continue;
                };
                // Inside an area every node is reached from every other (`Site`).
                let length =
                    hubs[from].out[exit] + passage.length_mm() + inside[entry][hubs[to].node];
                crossings
                    .entry((from, to, door))
                    .and_modify(|known: &mut u64| *known = length.min(*known))
                    .or_insert(length);
            }
        }
        let visits = hubs
            .values()
            .flat_map(|hub| &hub.out)
            .map(|(node, length)| (*node, LEAST_VISIT_MM.max(*length)))
            .collect();
        Self {
            crossings,
            visits,
            site,
        }
    }

    /// The least sum of crossings from an area to each, all doors open; to itself 0.
    fn between_areas(&self, from: &'a Symbol) -> BTreeMap<&'a Symbol, u64> {
        let steps = |area: &&'a Symbol| {
            let area = *area;
            self.crossings
                .iter()
                .filter(move |((from, _, _), _)| *from == area)
                .map(|((_, to, _), length)| (*to, *length))
                .collect::<Vec<_>>()
        };
        dijkstra_all(&from, steps)
            .into_iter()
            .map(|(area, (_, length))| (area, length))
            .chain([(from, 0)])
            .collect()
    }

    /// The least that crossings and a visit cost from an area to each node, all doors open. So it
    /// is never above the cost of a plan made of them, as long as the robot is not there already.
    pub(super) fn least_costs(&self, from: &'a Symbol) -> Vec<(&'a Symbol, u64)> {
        let areas = self.between_areas(from);
        self.site
            .nodes()
            .filter_map(|node| {
                let visit = self.visits.get(node.name())?;
                Some((node.name(), areas.get(node.area())? + visit))
            })
            .collect()
    }
}
