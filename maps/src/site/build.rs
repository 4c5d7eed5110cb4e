//! From a drawing without faults to a site.

use std::collections::BTreeMap;

use agent_core::model::Symbol;
use petgraph::graph::{DiGraph, NodeIndex};

use super::Site;
use super::parts::{Area, Door, Node, Passage};
use super::read::Drawing;

/// `drawing` has passed `check`, so that every edge has its ends and its length, and every door
/// an edge.
pub(super) fn build(mut drawing: Drawing) -> Site {
    drawing.nodes.sort_by_key(|node| node.id);
    drawing.edges.sort_by_key(|edge| edge.id);
    let mut site = Site {
        name: drawing.name,
        graph: DiGraph::new(),
        nodes: BTreeMap::new(),
        passages: Vec::new(),
        passage_indices: BTreeMap::new(),
        doors: BTreeMap::new(),
        areas: BTreeMap::new(),
    };
    let mut by_id: BTreeMap<u64, NodeIndex> = BTreeMap::new();
    for node in drawing.nodes {
        let area = site.areas.entry(node.area.clone());
        area.or_insert_with(|| Area {
            name: node.area.clone(),
            nodes: Vec::new(),
            rectangle_m: None,
        })
        .nodes
        .push(node.name.clone());
        let index = site.graph.add_node(Node {
            id: node.id,
            name: node.name.clone(),
            area: node.area,
            kind: node.kind,
            label: node.label,
            position_m: node.position_m,
        });
        by_id.insert(u64::from(node.id), index);
        site.nodes.insert(node.name, index);
    }
    for area in drawing.areas {
        if let Some(known) = site.areas.get_mut(&area.name) {
            known.rectangle_m = area.rectangle_m;
        }
    }
    let open: BTreeMap<Symbol, bool> = drawing
        .doors
        .into_iter()
        .map(|door| (door.name, door.open))
        .collect();
    for edge in drawing.edges {
        let (start, end) = (by_id[&edge.start], by_id[&edge.end]);
        if let Some(index) = site.passage_indices.get(&edge.name) {
            site.passages[*index].one_way = false;
            site.graph.add_edge(start, end, *index);
            continue;
        }
        if let Some(door) = &edge.door {
            site.doors.entry(door.clone()).or_insert_with(|| Door {
                name: door.clone(),
                joins: [start, end].map(|index| site.graph[index].area.clone()),
                open: open.get(door).copied().unwrap_or(true),
            });
        }
        let index = site.passages.len();
        site.passages.push(Passage {
            name: edge.name.clone(),
            ends: [start, end].map(|index| site.graph[index].name.clone()),
            length_mm: millimetres(edge.length_m.unwrap_or_default()),
            door: edge.door,
            one_way: true,
        });
        site.passage_indices.insert(edge.name, index);
        site.graph.add_edge(start, end, index);
    }
    site
}

fn millimetres(length_m: f64) -> u64 {
    // Between 1 and a thousand million: `read` accepts no other length.
    (length_m * 1000.0).round() as u64
}
