//! What the rough level takes for distances: from the middle of an area to that of the next.

use std::collections::BTreeMap;

use agent_core::model::Symbol;

use crate::site::Site;

/// Going on to the next thing in an area is never free, however near it is.
const LEAST_VISIT_MM: u64 = 1000;

/// The lengths that the rough level plans with, in millimetres.
pub(super) struct Rough<'a> {
    /// From one area to the next through a door, in the directions in which it can be passed.
    pub(super) crossings: BTreeMap<(&'a Symbol, &'a Symbol, &'a Symbol), u64>,
    /// From the hub of its area to a node.
    pub(super) visits: BTreeMap<&'a Symbol, u64>,
    /// From a node through a door of its area to the other side.
    pub(super) legs: BTreeMap<(&'a Symbol, &'a Symbol), u64>,
    /// Through an area: from where the first door leads into it to the other side of the second.
    pub(super) throughs: BTreeMap<(&'a Symbol, &'a Symbol, &'a Symbol), u64>,
    /// From where a door leads into an area to a node of it.
    pub(super) inners: BTreeMap<(&'a Symbol, &'a Symbol, &'a Symbol), u64>,
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
                keep_least(&mut crossings, (from, to, door), length);
            }
        }
        // Each door of each area: the node on this side, and what it takes to the other.
        let mut sides: BTreeMap<&Symbol, Vec<Side<'_>>> = BTreeMap::new();
        for passage in site.passages() {
            let Some(door) = passage.door() else { continue };
            for (exit, _) in passage.directions() {
                if let Some(area) = site.node(exit.as_str()).map(crate::Node::area) {
                    sides.entry(area).or_default().push(Side {
                        door,
                        node: exit,
                        length_mm: passage.length_mm(),
                    });
                }
            }
        }
        let mut legs = BTreeMap::new();
        let mut throughs = BTreeMap::new();
        let mut inners = BTreeMap::new();
        for (area, sides) in &sides {
            for node in site
                .area(area.as_str())
                .iter()
                .flat_map(|area| area.nodes())
            {
                for side in sides {
                    let length = inside[node][side.node];
                    keep_least(&mut legs, (node, side.door), length + side.length_mm);
                    let length = LEAST_VISIT_MM.max(inside[side.node][node]);
                    keep_least(&mut inners, (*area, side.door, node), length);
                }
            }
            for first in sides {
                for second in sides {
                    let length = inside[first.node][second.node] + second.length_mm;
                    keep_least(&mut throughs, (*area, first.door, second.door), length);
                }
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
            legs,
            throughs,
            inners,
        }
    }
}

/// A door of an area.
struct Side<'a> {
    door: &'a Symbol,
    /// On this side of it.
    node: &'a Symbol,
    /// Of the passage through it.
    length_mm: u64,
}

fn keep_least<K: Ord>(lengths: &mut BTreeMap<K, u64>, key: K, length: u64) {
    lengths
        .entry(key)
        .and_modify(|known| *known = length.min(*known))
        .or_insert(length);
}
