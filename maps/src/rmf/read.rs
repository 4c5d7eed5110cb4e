//! From YAML to vertices and passages. What cannot be read is a fault; what is not needed is noted.

use std::collections::BTreeMap;

use super::Notes;
use super::tree::{Tree, Value};
use crate::site::Faults;

/// More vertices than that are refused.
const MOST_VERTICES: usize = 100_000;
/// Two vertices may lie upon each other, but no passage is without length.
const LEAST_LENGTH_MM: u64 = 100;
/// Coordinates beyond that are no metres within a building.
const FURTHEST_M: f64 = 100_000.0;

/// One level of a building.
pub(super) struct Graph {
    pub(super) building: String,
    pub(super) level: String,
    pub(super) vertices: Vec<Vertex>,
    /// In the order of their first lanes.
    pub(super) passages: Vec<Passage>,
}

pub(super) struct Vertex {
    /// Counted from 0, as lanes do.
    pub(super) index: usize,
    pub(super) name: Option<String>,
    /// Ours: the area that it is to lie in.
    pub(super) area: Option<String>,
    pub(super) position_m: [f64; 2],
    pub(super) kind: Option<String>,
}

/// The lanes between two vertices.
pub(super) struct Passage {
    /// Places in [`Graph::vertices`].
    pub(super) ends: [usize; 2],
    /// From the first to the second, and back.
    pub(super) open_to: [bool; 2],
    pub(super) door: Option<String>,
    pub(super) length_mm: u64,
    /// For Nav2, each way.
    pub(super) speed_limit: [Option<f64>; 2],
}

struct Lane {
    line: usize,
    ends: [usize; 2],
    door: Option<String>,
    speed_limit: Option<f64>,
    both_ways: bool,
}

/// What a vertex can be for, by the property that says so; of several the first counts.
const KINDS: [(&str, &str); 7] = [
    ("lift", "lift"),
    ("is_charger", "charger"),
    ("dock_name", "dock"),
    ("pickup_dispenser", "pickup"),
    ("dropoff_ingestor", "dropoff"),
    ("is_parking_spot", "parking"),
    ("is_holding_point", "holding"),
];

/// Reads the level of that name, or the only one. `None` if there is nothing to go on with.
pub(super) fn read(
    tree: &Tree,
    wanted: Option<&str>,
    faults: &mut Faults,
    notes: &mut Notes,
) -> Option<Graph> {
    if tree.members().is_none() {
        faults.add(
            tree.line,
            "is no navigation graph: it must be a table with `levels`",
        );
        return None;
    }
    let (level, content) = level(tree, wanted, faults, notes)?;
    let [vertices, lanes] = ["vertices", "lanes"].map(|key| {
        let list = content.get(key).and_then(Tree::list);
        if list.is_none() {
            faults.add(
                content.line,
                format!("level {level} has no list of `{key}`"),
            );
        }
        list
    });
    let (vertices, lanes) = (vertices?, lanes?);
    if vertices.len() > MOST_VERTICES {
        let message = format!(
            "level {level} has {} vertices, of at most {MOST_VERTICES}",
            vertices.len()
        );
        faults.add(content.line, message);
        return None;
    }
    if is_building(vertices) {
        let message = "is a building of the traffic editor, not a navigation graph: \
                       `ros2 run rmf_building_map_tools building_map_generator nav FILE DIR` makes one";
        faults.add(content.line, message);
        return None;
    }
    let count = vertices.len();
    let vertices: Vec<Option<Vertex>> = vertices
        .iter()
        .enumerate()
        .map(|(index, tree)| read_vertex(index, tree, faults, notes))
        .collect();
    names_are_unique(&vertices, content.line, faults);
    let lanes: Vec<Lane> = lanes
        .iter()
        .enumerate()
        .filter_map(|(index, tree)| read_lane(index, tree, count, faults, notes))
        .collect();
    for (name, _) in tree
        .get("doors")
        .and_then(Tree::members)
        .unwrap_or_default()
    {
        let used = lanes.iter().any(|lane| lane.door.as_ref() == Some(name));
        let map = tree
            .get("doors")
            .and_then(|doors| doors.get(name))
            .and_then(|door| door.get("map"));
        let elsewhere = map.and_then(Tree::text).is_some_and(|map| map != level);
        if !used && !elsewhere {
            notes.say(format!("door {name} is on no lane: left out"));
        }
    }
    // Whoever cannot be read would shift the others.
    let vertices: Vec<Vertex> = vertices.into_iter().collect::<Option<_>>()?;
    let passages = join(&vertices, lanes, faults, notes);
    Some(Graph {
        building: tree
            .get("building_name")
            .and_then(Tree::text)
            .unwrap_or_default(),
        level,
        vertices,
        passages,
    })
}

fn level<'a>(
    tree: &'a Tree,
    wanted: Option<&str>,
    faults: &mut Faults,
    notes: &mut Notes,
) -> Option<(String, &'a Tree)> {
    let Some(levels) = tree.get("levels").and_then(Tree::members) else {
        faults.add(
            tree.line,
            "is no navigation graph: it has no table of `levels`",
        );
        return None;
    };
    let names: Vec<&str> = levels.iter().map(|(name, _)| name.as_str()).collect();
    let (name, content) = match (wanted, levels) {
        (Some(wanted), _) => {
            let found = levels.iter().find(|(name, _)| name == wanted);
            if found.is_none() {
                let message = format!("has no level {wanted}; it has {}", names.join(", "));
                faults.add(tree.line, message);
            }
            found?
        }
        (None, [only]) => only,
        (None, []) => {
            faults.add(tree.line, "has no level");
            return None;
        }
        (None, _) => {
            let message = format!(
                "has several levels: name one of {} (--level)",
                names.join(", ")
            );
            faults.add(tree.line, message);
            return None;
        }
    };
    if levels.len() > 1 {
        let others: Vec<&str> = names.into_iter().filter(|other| other != name).collect();
        notes.say(format!(
            "other levels, and the lifts to them, are left out: {}",
            others.join(", ")
        ));
    }
    Some((name.clone(), content))
}

/// There, a vertex has a height and a name before its properties.
fn is_building(vertices: &[Tree]) -> bool {
    let first = vertices.first().and_then(Tree::list).unwrap_or_default();
    first.len() >= 4 && matches!(first[3].value, Value::Text(_) | Value::Null)
}

fn read_vertex(
    index: usize,
    tree: &Tree,
    faults: &mut Faults,
    notes: &mut Notes,
) -> Option<Vertex> {
    let mut fault =
        |line: usize, message: &str| faults.add(line, format!("vertex {index} {message}"));
    let (x, y, properties) = match tree.list() {
        Some([x, y]) => (x, y, None),
        Some([x, y, properties]) => (x, y, Some(properties)),
        _ => {
            fault(tree.line, "must be [x, y, {its properties}]");
            return None;
        }
    };
    let position_m = [x, y].map(|tree| tree.number().filter(|value| value.abs() <= FURTHEST_M));
    if position_m.contains(&None) {
        fault(tree.line, "must begin with two coordinates in metres");
    }
    let mut vertex = Vertex {
        index,
        name: None,
        area: None,
        position_m: [0.0; 2],
        kind: None,
    };
    let mut rank = KINDS.len();
    for (key, value) in members(properties, &mut |line| {
        fault(line, "must end with a table of properties")
    }) {
        match key.as_str() {
            "name" | "area" => {
                let text = value.text();
                if text.is_none() && !matches!(value.value, Value::Null) {
                    fault(value.line, &format!("has a `{key}` that is not text"));
                }
                let text = text.filter(|text| !text.is_empty());
                if key == "name" {
                    vertex.name = text
                } else {
                    vertex.area = text
                }
            }
            _ => match KINDS.iter().position(|(known, _)| known == key) {
                Some(found) if says_so(value) => rank = rank.min(found),
                Some(_) => {}
                None => notes.unused(key, "vertices"),
            },
        }
    }
    vertex.kind = KINDS.get(rank).map(|(_, kind)| (*kind).to_owned());
    let [x, y] = position_m;
    vertex.position_m = [x?, y?];
    Some(vertex)
}

/// A flag that is set, or a name that is there.
fn says_so(value: &Tree) -> bool {
    match &value.value {
        Value::Bool(flag) => *flag,
        Value::Text(text) => !text.is_empty(),
        Value::Null => false,
        _ => true,
    }
}

/// The members of a table that may be missing or empty.
fn members<'a>(table: Option<&'a Tree>, fault: &mut dyn FnMut(usize)) -> &'a [(String, Tree)] {
    let Some(table) = table else { return &[] };
    table.members().unwrap_or_else(|| {
        if !matches!(table.value, Value::Null) {
            fault(table.line);
        }
        &[]
    })
}

fn names_are_unique(vertices: &[Option<Vertex>], line: usize, faults: &mut Faults) {
    let mut first: BTreeMap<&str, usize> = BTreeMap::new();
    for vertex in vertices.iter().flatten() {
        let Some(name) = &vertex.name else { continue };
        if let Some(other) = first.insert(name, vertex.index) {
            let message = format!(
                "vertices {other} and {} have the same name: {name}",
                vertex.index
            );
            faults.add(line, message);
        }
    }
}

fn read_lane(
    index: usize,
    tree: &Tree,
    vertices: usize,
    faults: &mut Faults,
    notes: &mut Notes,
) -> Option<Lane> {
    let mut fault =
        |line: usize, message: &str| faults.add(line, format!("lane {index} {message}"));
    let (from, to, properties) = match tree.list() {
        Some([from, to]) => (from, to, None),
        Some([from, to, properties]) => (from, to, Some(properties)),
        _ => {
            fault(tree.line, "must be [from, to, {its properties}]");
            return None;
        }
    };
    let ends = [from, to].map(|tree| tree.index());
    for end in ends {
        match end {
            Some(end) if end < vertices => {}
            Some(end) => fault(
                tree.line,
                &format!(
                    "leads to or from vertex {end}, which does not exist: there are {vertices}, counted from 0"
                ),
            ),
            None => fault(tree.line, "must begin with the numbers of two vertices"),
        }
    }
    let mut lane = Lane {
        line: tree.line,
        ends: [0; 2],
        door: None,
        speed_limit: None,
        both_ways: false,
    };
    for (key, value) in members(properties, &mut |line| {
        fault(line, "must end with a table of properties")
    }) {
        match key.as_str() {
            "door_name" => {
                let text = value.text();
                if text.is_none() && !matches!(value.value, Value::Null) {
                    fault(value.line, "has a `door_name` that is not text");
                }
                lane.door = text.filter(|text| !text.is_empty());
            }
            "is_bidirectional" => match value.value {
                Value::Bool(flag) => lane.both_ways = flag,
                _ => fault(
                    value.line,
                    "has an `is_bidirectional` that is neither true nor false",
                ),
            },
            "speed_limit" => match value.number() {
                Some(limit) => lane.speed_limit = Some(limit).filter(|limit| *limit > 0.0),
                None => fault(value.line, "has a `speed_limit` that is no number"),
            },
            // What happens at a dock is for a domain to say.
            _ => notes.unused(key, "lanes"),
        }
    }
    let [from, to] = ends;
    lane.ends = [
        from.filter(|end| *end < vertices)?,
        to.filter(|end| *end < vertices)?,
    ];
    if lane.ends[0] == lane.ends[1] {
        notes.say(format!(
            "lane {index} (line {}) leads from vertex {} to itself: left out",
            tree.line, lane.ends[0]
        ));
        return None;
    }
    Some(lane)
}

/// Lanes there and back are one passage.
fn join(
    vertices: &[Vertex],
    lanes: Vec<Lane>,
    faults: &mut Faults,
    notes: &mut Notes,
) -> Vec<Passage> {
    let mut known: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    let mut passages: Vec<Passage> = Vec::new();
    let mut twice = 0;
    for lane in lanes {
        let [from, to] = lane.ends;
        let at = *known
            .entry([from.min(to), from.max(to)])
            .or_insert_with(|| {
                let [one, other] = [from, to].map(|end| vertices[end].position_m);
                let length_m = (one[0] - other[0]).hypot(one[1] - other[1]);
                passages.push(Passage {
                    ends: [from, to],
                    open_to: [false; 2],
                    door: lane.door.clone(),
                    // Rounded up: a passage is not shorter than the straight line.
                    length_mm: ((length_m * 1000.0).ceil() as u64).max(LEAST_LENGTH_MM),
                    speed_limit: [None; 2],
                });
                passages.len() - 1
            });
        let passage = &mut passages[at];
        match (&passage.door, &lane.door) {
            (Some(one), Some(other)) if one != other => {
                let message = format!(
                    "between vertices {from} and {to} there are two doors, {one} and {other}: draw two ways"
                );
                faults.add(lane.line, message);
            }
            (None, Some(door)) | (Some(door), None) => {
                notes.say(format!("between vertices {from} and {to} door {door} is on one lane of several: taken to be on all"));
                passage.door = Some(door.clone());
            }
            _ => {}
        }
        let way = usize::from(passage.ends != lane.ends);
        twice += usize::from(passage.open_to[way]);
        for way in if lane.both_ways {
            vec![0, 1]
        } else {
            vec![way]
        } {
            passage.open_to[way] = true;
            passage.speed_limit[way] = lane.speed_limit.or(passage.speed_limit[way]);
        }
    }
    if twice > 0 {
        notes.say(format!("{twice} lanes are drawn twice: each is taken once"));
    }
    passages
}
