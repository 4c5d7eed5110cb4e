//! Whether the features of a map fit together.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::Symbol;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::faults::Faults;
use super::read::{Drawing, EdgeFeature, NodeFeature};

/// Lengths are often given to two decimals.
const TOLERANCE_M: f64 = 0.01;

/// Adds everything that is wrong to `faults`.
pub(super) fn check(drawing: &Drawing, faults: &mut Faults) {
    if drawing.nodes.is_empty() && drawing.unreadable.is_empty() {
        faults.add(0, "the map has no nodes");
    }
    ids_are_unique(drawing, faults);
    names_are_unique(drawing, faults);
    let ends = ends_of_edges(drawing, faults);
    let doors: BTreeSet<&Symbol> = drawing.doors.iter().map(|door| &door.name).collect();
    for edge in &drawing.edges {
        if let Some((start, end)) = ends.get(&edge.origin.number) {
            edge_fits_its_ends(edge, start, end, &doors, faults);
        }
    }
    directions_agree(drawing, faults);
    doors_are_used(drawing, &ends, faults);
    areas_are_used(drawing, faults);
    areas_hold_together(drawing, &ends, faults);
}

/// The nodes at the ends of each edge, by the edge's place in the file.
type Ends<'a> = BTreeMap<usize, (&'a NodeFeature, &'a NodeFeature)>;

fn ids_are_unique(drawing: &Drawing, faults: &mut Faults) {
    let nodes = drawing.nodes.iter().map(|node| (node.id, &node.origin));
    let edges = drawing.edges.iter().map(|edge| (edge.id, &edge.origin));
    let mut features: Vec<_> = nodes.chain(edges).collect();
    features.sort_by_key(|(_, origin)| origin.number);
    let mut first = BTreeMap::new();
    for (id, origin) in features {
        if let Some(other) = first.get(&id) {
            faults.about(origin, format!("has the id of {other}"));
        } else {
            first.insert(id, origin);
        }
    }
}

/// The domains know objects by name alone, whatever they are.
fn names_are_unique(drawing: &Drawing, faults: &mut Faults) {
    let mut first: BTreeMap<&Symbol, String> = BTreeMap::new();
    for node in &drawing.nodes {
        if let Some(other) = first.get(&node.name) {
            faults.about(&node.origin, format!("has the name of {other}"));
        } else {
            first.insert(&node.name, node.origin.to_string());
        }
    }
    for node in &drawing.nodes {
        claim(&mut first, &node.area, "area", node.origin.line, faults);
    }
    for edge in &drawing.edges {
        claim(&mut first, &edge.name, "passage", edge.origin.line, faults);
        if let Some(door) = &edge.door {
            claim(&mut first, door, "door", edge.origin.line, faults);
        }
    }
}

fn claim<'a>(
    first: &mut BTreeMap<&'a Symbol, String>,
    name: &'a Symbol,
    kind: &str,
    line: usize,
    faults: &mut Faults,
) {
    let claimed = format!("{kind} {name}");
    match first.get(name) {
        Some(other) if *other != claimed => {
            faults.add(line, format!("{claimed} has the name of {other}"));
        }
        Some(_) => {}
        None => {
            first.insert(name, claimed);
        }
    }
}

fn ends_of_edges<'a>(drawing: &'a Drawing, faults: &mut Faults) -> Ends<'a> {
    let mut nodes: BTreeMap<u64, &NodeFeature> = BTreeMap::new();
    for node in &drawing.nodes {
        nodes.entry(u64::from(node.id)).or_insert(node);
    }
    let unreadable = |id| u32::try_from(id).is_ok_and(|id| drawing.unreadable.contains(&id));
    let mut ends = Ends::new();
    for edge in &drawing.edges {
        if edge.start == edge.end {
            faults.about(
                &edge.origin,
                format!("leads from node {} to itself", edge.start),
            );
            continue;
        }
        for (what, id) in [("starts", edge.start), ("ends", edge.end)] {
            if !nodes.contains_key(&id) && !unreadable(id) {
                faults.about(
                    &edge.origin,
                    format!("{what} at node {id}, which does not exist"),
                );
            }
        }
        if let (Some(start), Some(end)) = (nodes.get(&edge.start), nodes.get(&edge.end)) {
            ends.insert(edge.origin.number, (*start, *end));
        }
    }
    ends
}

fn edge_fits_its_ends(
    edge: &EdgeFeature,
    start: &NodeFeature,
    end: &NodeFeature,
    doors: &BTreeSet<&Symbol>,
    faults: &mut Faults,
) {
    let [dx, dy] = [0, 1].map(|axis| end.position_m[axis] - start.position_m[axis]);
    let straight_m = dx.hypot(dy);
    if let Some(length_m) = edge
        .length_m
        .filter(|length| *length < straight_m - TOLERANCE_M)
    {
        let message = format!("is {length_m} m long, though its ends are {straight_m:.3} m apart",);
        faults.about(&edge.origin, message);
    }
    match &edge.door {
        None if start.area != end.area && !edge.door_unclear => {
            let message = format!("joins {} and {} without a door", start.area, end.area);
            faults.about(&edge.origin, message);
        }
        Some(door) if start.area == end.area => {
            let message = format!("has {door}, but both its ends lie in {}", start.area);
            faults.about(&edge.origin, message);
        }
        _ => {}
    }
    if let Some(door) = &edge.door
        && !doors.contains(door)
    {
        let message = format!("has {door}, which is missing from the map's `doors`");
        faults.about(&edge.origin, message);
    }
}

/// Edges of one name are the two directions of one passage.
fn directions_agree(drawing: &Drawing, faults: &mut Faults) {
    let mut passages: BTreeMap<&Symbol, Vec<&EdgeFeature>> = BTreeMap::new();
    for edge in &drawing.edges {
        passages.entry(&edge.name).or_default().push(edge);
    }
    for (name, edges) in passages {
        let Some((first, others)) = edges.split_first() else {
            continue;
        };
        for (index, edge) in others.iter().enumerate() {
            if index > 0 || (edge.start, edge.end) != (first.end, first.start) {
                let message = format!(
                    "has the name of {}, but is not its way back: {name} may name one edge, \
                     or two between the same nodes",
                    first.origin
                );
                faults.about(&edge.origin, message);
                continue;
            }
            if let (Some(length_m), Some(back_m)) = (first.length_m, edge.length_m)
                && (length_m - back_m).abs() > TOLERANCE_M
            {
                let message = format!(
                    "is {back_m} m long, but {length_m} m in the other direction, {}",
                    first.origin
                );
                faults.about(&edge.origin, message);
            }
            if first.door != edge.door && !first.door_unclear && !edge.door_unclear {
                let [there, back] = [first, edge].map(|edge| match &edge.door {
                    Some(door) => door.as_str(),
                    None => "no door",
                });
                let message = format!(
                    "has {back}, but {there} in the other direction, {}",
                    first.origin
                );
                faults.about(&edge.origin, message);
            }
        }
    }
}

fn doors_are_used(drawing: &Drawing, ends: &Ends<'_>, faults: &mut Faults) {
    let mut joined: BTreeMap<&Symbol, BTreeSet<&Symbol>> = BTreeMap::new();
    for edge in &drawing.edges {
        let Some(door) = &edge.door else { continue };
        let areas = joined.entry(door).or_default();
        if let Some((start, end)) = ends.get(&edge.origin.number) {
            let more: BTreeSet<_> = [&start.area, &end.area].into_iter().collect();
            if areas.is_empty() {
                *areas = more;
            } else if *areas != more && start.area != end.area {
                let known: Vec<_> = areas.iter().map(|area| area.as_str()).collect();
                let message = format!(
                    "joins {} and {} by {door}, which already joins {}",
                    start.area,
                    end.area,
                    known.join(" and ")
                );
                faults.about(&edge.origin, message);
            }
        }
    }
    for door in &drawing.doors {
        if !joined.contains_key(&door.name) {
            faults.add(door.line, format!("door {} is on no edge", door.name));
        }
    }
}

fn areas_are_used(drawing: &Drawing, faults: &mut Faults) {
    let mut nodes_of: BTreeMap<&Symbol, Vec<&NodeFeature>> = BTreeMap::new();
    for node in &drawing.nodes {
        nodes_of.entry(&node.area).or_default().push(node);
    }
    for area in &drawing.areas {
        let nodes = nodes_of.get(&area.name).map_or(&[][..], Vec::as_slice);
        if nodes.is_empty() {
            faults.add(area.line, format!("area {} has no node", area.name));
        }
        let Some([west, south, east, north]) = area.rectangle_m else {
            continue;
        };
        for node in nodes {
            let [x, y] = node.position_m;
            if !(west..=east).contains(&x) || !(south..=north).contains(&y) {
                let message = format!("lies at {x}, {y}, outside the rectangle of {}", area.name);
                faults.about(&node.origin, message);
            }
        }
    }
}

/// An area is crossed from any of its nodes to any other, and every area can be left and come
/// back to once all doors are open: else the rough level would plan what the detailed one cannot do.
fn areas_hold_together(drawing: &Drawing, ends: &Ends<'_>, faults: &mut Faults) {
    let mut inside: DiGraph<&NodeFeature, ()> = DiGraph::new();
    let mut between: DiGraph<&Symbol, ()> = DiGraph::new();
    let mut nodes: BTreeMap<u32, NodeIndex> = BTreeMap::new();
    let mut areas: BTreeMap<&Symbol, NodeIndex> = BTreeMap::new();
    for node in &drawing.nodes {
        nodes
            .entry(node.id)
            .or_insert_with(|| inside.add_node(node));
        areas
            .entry(&node.area)
            .or_insert_with(|| between.add_node(&node.area));
    }
    for (start, end) in ends.values() {
        if start.area == end.area {
            inside.add_edge(nodes[&start.id], nodes[&end.id], ());
        } else {
            between.add_edge(areas[&start.area], areas[&end.area], ());
        }
    }

    let mut parts: BTreeMap<&Symbol, Vec<Vec<&NodeFeature>>> = BTreeMap::new();
    for part in kosaraju_scc(&inside) {
        let part: Vec<&NodeFeature> = part.into_iter().map(|index| inside[index]).collect();
        parts.entry(&part[0].area).or_default().push(part);
    }
    for (area, parts) in parts {
        let (_, rest) = largest(parts, |node| node.origin.number);
        for node in rest {
            let message =
                format!("and the rest of {area} cannot be reached from each other inside it");
            faults.about(&node.origin, message);
        }
    }

    let mut lines: BTreeMap<&Symbol, usize> = BTreeMap::new();
    for node in &drawing.nodes {
        lines.entry(&node.area).or_insert(node.origin.line);
    }
    let line_of = |area: &Symbol| lines.get(area).copied().unwrap_or(1);
    let parts = kosaraju_scc(&between)
        .into_iter()
        .map(|part| part.into_iter().map(|index| between[index]).collect())
        .collect();
    let (main, rest) = largest(parts, line_of);
    for area in rest {
        let alone = between.neighbors_undirected(areas[area]).next().is_none();
        let message = match main.first() {
            Some(other) if !alone => format!(
                "area {area} and area {other} cannot be reached from each other, \
                 even with all doors open"
            ),
            _ => format!("area {area} is joined to no other area"),
        };
        faults.add(line_of(area), message);
    }
}

/// The part with the most members, of equal ones the one that is drawn first; and all members of
/// the others.
fn largest<T: Copy>(mut parts: Vec<Vec<T>>, place: impl Fn(T) -> usize) -> (Vec<T>, Vec<T>) {
    for part in &mut parts {
        part.sort_by_key(|member| place(*member));
    }
    let first = |part: &Vec<T>| part.first().map(|member| place(*member));
    parts.sort_by_key(|part| (std::cmp::Reverse(part.len()), first(part)));
    let mut parts = parts.into_iter();
    let main = parts.next().unwrap_or_default();
    (main, parts.flatten().collect())
}
