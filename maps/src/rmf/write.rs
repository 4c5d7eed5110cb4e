//! A partitioned graph as the text of a map.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Write};

use serde_json::Value;

use super::Notes;
use super::names::Names;
use super::partition::Plan;
use super::read::{Graph, Passage};

/// The text, and the name of a node where a robot could start.
pub(super) fn write(graph: &Graph, plan: &Plan, notes: &mut Notes) -> (String, String) {
    let sheet = Sheet::of(graph, plan, notes);
    let mut text = String::new();
    // Writing into a string does not fail.
    let _ = sheet.features(&mut text);
    (text, sheet.start())
}

/// All that has a name on the map.
struct Sheet<'a> {
    graph: &'a Graph,
    areas: Vec<String>,
    /// Of each vertex: its name and its area, unless it is left out.
    nodes: Vec<Option<(String, usize)>>,
    /// Both ends on the map; each with its name and its door.
    passages: Vec<(String, Option<String>, &'a Passage)>,
    doors: BTreeSet<String>,
}

impl<'a> Sheet<'a> {
    fn of(graph: &'a Graph, plan: &Plan, notes: &mut Notes) -> Self {
        let mut names = Names::default();
        // What people know by name comes first, so that it keeps its name.
        let mut nodes: Vec<Option<(String, usize)>> = vec![None; graph.vertices.len()];
        for named in [true, false] {
            for (index, vertex) in graph.vertices.iter().enumerate() {
                if let Some(area) = plan.area_of[index]
                    && vertex.name.is_some() == named
                {
                    let wanted = vertex
                        .name
                        .clone()
                        .unwrap_or_else(|| format!("n{}", index + 1));
                    nodes[index] = Some((names.claim(&wanted, 'n'), area));
                }
            }
        }
        let areas: Vec<String> = plan
            .names
            .iter()
            .enumerate()
            .map(|(number, name)| {
                let number = number + 1;
                let name = name
                    .as_ref()
                    .map_or_else(|| format!("area{number}"), |name| format!("area_{name}"));
                names.claim(&name, 'a')
            })
            .collect();
        let area_of = |vertex: usize| nodes[vertex].as_ref().map(|(_, area)| *area);
        // A door joins two areas and no more; one that leads to several places is several doors.
        let mut known: BTreeMap<(Option<&str>, [usize; 2]), String> = BTreeMap::new();
        let mut seen: BTreeSet<&str> = BTreeSet::new();
        let mut gates = 0;
        let mut doors: Vec<Option<String>> = vec![None; graph.passages.len()];
        for real in [true, false] {
            for (index, passage) in graph.passages.iter().enumerate() {
                let [Some(one), Some(other)] = passage.ends.map(area_of) else {
                    continue;
                };
                let door = passage
                    .door
                    .as_deref()
                    .filter(|_| !plan.doorless.contains(&index));
                if one == other || door.is_some() != real {
                    continue;
                }
                let joined = [one.min(other), one.max(other)];
                let name = known.entry((door, joined)).or_insert_with(|| match door {
                    Some(door) => {
                        let name = names.claim(door, 'd');
                        if !seen.insert(door) {
                            notes.say(format!(
                                "door {door} leads to several areas: it is {name}, too"
                            ));
                        }
                        name
                    }
                    None => {
                        gates += 1;
                        // gate1_2 between area1 and area2, gate_lab_hall between area_lab and area_hall.
                        let [one, other] =
                            joined.map(|area| areas[area].trim_start_matches("area"));
                        let other = other.trim_start_matches('_');
                        names.claim(&format!("gate{one}_{other}"), 'g')
                    }
                });
                doors[index] = Some(name.clone());
            }
        }
        if gates > 0 {
            notes.say(format!(
                "{gates} gates are made up where areas meet without a door; they are open"
            ));
        }
        let passages = graph
            .passages
            .iter()
            .zip(&doors)
            .filter(|(passage, _)| passage.ends.iter().all(|end| nodes[*end].is_some()));
        let passages: Vec<_> = passages
            .enumerate()
            .map(|(index, (passage, door))| {
                (
                    names.claim(&format!("arc{}", index + 1), 'a'),
                    door.clone(),
                    passage,
                )
            })
            .collect();
        let doors = passages
            .iter()
            .filter_map(|(_, door, _)| door.clone())
            .collect();
        Self {
            graph,
            areas,
            nodes,
            passages,
            doors,
        }
    }

    fn start(&self) -> String {
        let rank = |kind: Option<&str>| match kind {
            Some("charger") => 0,
            Some("parking") => 1,
            _ => 2,
        };
        let nodes = self.graph.vertices.iter().zip(&self.nodes);
        let nodes = nodes
            .filter_map(|(vertex, node)| Some((rank(vertex.kind.as_deref()), &node.as_ref()?.0)));
        // The first of the best.
        nodes
            .min_by_key(|(rank, _)| *rank)
            .map(|(_, name)| name.clone())
            .unwrap_or_default()
    }

    fn features(&self, out: &mut String) -> fmt::Result {
        let name = format!("{} {}", self.graph.building, self.graph.level);
        writeln!(
            out,
            r#"{{"type": "FeatureCollection", "name": {},"#,
            text(name.trim())
        )?;
        writeln!(
            out,
            r#""crs": {{"type": "name", "properties": {{"name": "urn:ogc:def:crs:EPSG::3857"}}}},"#
        )?;
        write!(out, r#""doors": {{"#)?;
        for (index, door) in self.doors.iter().enumerate() {
            let comma = if index > 0 { "," } else { "" };
            write!(out, "{comma}\n  {}: {{\"open\": true}}", text(door))?;
        }
        writeln!(out, "}},\n\"features\": [")?;
        let mut comma = "";
        for (index, node) in self.nodes.iter().enumerate() {
            if let Some((name, area)) = node {
                write!(out, "{comma}")?;
                self.point(out, index, name, &self.areas[*area])?;
                comma = ",\n";
            }
        }
        let base = first_id(self.nodes.len().max(self.passages.len()));
        for (index, (name, door, passage)) in self.passages.iter().enumerate() {
            for way in [0, 1] {
                if passage.open_to[way] {
                    writeln!(out, ",")?;
                    self.line(
                        out,
                        (1 + way) * base + index + 1,
                        name,
                        door.as_deref(),
                        passage,
                        way,
                    )?;
                }
            }
        }
        writeln!(out, "\n]}}")
    }

    fn point(&self, out: &mut String, index: usize, name: &str, area: &str) -> fmt::Result {
        let vertex = &self.graph.vertices[index];
        let kind = vertex
            .kind
            .as_ref()
            .map_or_else(String::new, |kind| format!(r#", "kind": {}"#, text(kind)));
        let label = vertex
            .name
            .as_ref()
            .map_or_else(String::new, |name| format!(r#", "label": {}"#, text(name)));
        let [x, y] = vertex.position_m.map(rounded);
        write!(
            out,
            r#"{{"type": "Feature", "properties": {{"id": {}, "frame": "map", "metadata": {{"name": {}, "area": {}{kind}{label}}}}}, "geometry": {{"type": "Point", "coordinates": [{x:?}, {y:?}]}}}}"#,
            index + 1,
            text(name),
            text(area),
        )
    }

    fn line(
        &self,
        out: &mut String,
        id: usize,
        name: &str,
        door: Option<&str>,
        passage: &Passage,
        way: usize,
    ) -> fmt::Result {
        let [from, to] = if way == 0 {
            passage.ends
        } else {
            [passage.ends[1], passage.ends[0]]
        };
        let length_m = passage.length_mm as f64 / 1000.0;
        let door = door.map_or_else(String::new, |door| format!(r#", "door": {}"#, text(door)));
        let limit = passage.speed_limit[way].map_or_else(String::new, |limit| {
            format!(r#", "abs_speed_limit": {limit:?}"#)
        });
        let [[x, y], [u, v]] =
            [from, to].map(|end| self.graph.vertices[end].position_m.map(rounded));
        let (from, to) = (from + 1, to + 1);
        write!(
            out,
            r#"{{"type": "Feature", "properties": {{"id": {id}, "startid": {from}, "endid": {to}, "cost": {length_m:?}, "metadata": {{"name": {}{door}{limit}}}}}, "geometry": {{"type": "MultiLineString", "coordinates": [[[{x:?}, {y:?}], [{u:?}, {v:?}]]]}}}}"#,
            text(name),
        )
    }
}

/// To the millimetre.
fn rounded(metres: f64) -> f64 {
    // No minus before a zero.
    (metres * 1000.0).round() / 1000.0 + 0.0
}

fn text(words: &str) -> String {
    Value::from(words).to_string()
}

/// The round number above all numbers of nodes and passages; the way there of `arc5` gets this and 5,
/// the way back twice this and 5.
fn first_id(most: usize) -> usize {
    let mut id = 1000;
    while id <= most {
        id *= 10;
    }
    id
}
