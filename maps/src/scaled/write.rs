//! A museum as the text of a map.

use std::fmt::{self, Write};

use super::floor::{DEPTH_M, Doorway, Floor, WIDTH_M};
use super::room::{Arc, Rooms, Spot, What};

/// Two nodes can be drawn upon each other where an area is crowded, but no arc is without length.
const LEAST_LENGTH_M: f64 = 0.1;

pub(super) fn write(name: &str, floor: &Floor, rooms: &Rooms) -> String {
    let mut text = String::new();
    // Writing into a string does not fail.
    let _ = features(&mut text, name, floor, rooms);
    text
}

fn features(out: &mut String, name: &str, floor: &Floor, rooms: &Rooms) -> fmt::Result {
    writeln!(out, r#"{{"type": "FeatureCollection", "name": "{name}","#)?;
    writeln!(
        out,
        r#""crs": {{"type": "name", "properties": {{"name": "urn:ogc:def:crs:EPSG::3857"}}}},"#
    )?;
    writeln!(out, r#""areas": {{"#)?;
    for area in 0..floor.areas {
        let [west, south] = floor.corner_m(area);
        let (east, north) = (west + WIDTH_M, south + DEPTH_M);
        let comma = if area + 1 < floor.areas { "," } else { "}," };
        let number = area + 1;
        writeln!(
            out,
            r#"  "area{number}": {{"rectangle_m": [{west:?}, {south:?}, {east:?}, {north:?}]}}{comma}"#
        )?;
    }
    write!(out, r#""doors": {{"#)?;
    for (index, door) in floor.doors.iter().enumerate() {
        let comma = if index > 0 { "," } else { "" };
        let (name, open) = (name_of(*door), door.open);
        write!(out, "{comma}\n  \"{name}\": {{\"open\": {open}}}")?;
    }
    writeln!(out, "}},\n\"features\": [")?;
    for (index, node) in rooms.nodes.iter().enumerate() {
        let comma = if index > 0 { ",\n" } else { "" };
        write!(out, "{comma}")?;
        point(out, index + 1, node)?;
    }
    let base = first_id(rooms.nodes.len().max(rooms.arcs.len()));
    for (index, arc) in rooms.arcs.iter().enumerate() {
        for (back, ends) in [(false, arc.ends), (true, [arc.ends[1], arc.ends[0]])] {
            let id = (1 + usize::from(back)) * base + index + 1;
            writeln!(out, ",")?;
            line(out, id, index + 1, Arc { ends, ..*arc }, rooms)?;
        }
    }
    writeln!(out, "\n]}}")
}

fn point(out: &mut String, number: usize, node: &Spot) -> fmt::Result {
    let area = node.area + 1;
    let (kind, label) = match &node.what {
        What::Thing("exhibit") => ("exhibit", format!("exhibit {number}")),
        What::Thing(kind) => (*kind, kind.replace('_', " ")),
        What::DoorTo(behind, door) => {
            let staff = if door.open { "" } else { "staff door " };
            ("door_side", format!("{staff}to area{}", behind + 1))
        }
    };
    let [x, y] = node.position_m;
    write!(
        out,
        r#"{{"type": "Feature", "properties": {{"id": {number}, "frame": "map", "metadata": {{"name": "n{number}", "area": "area{area}", "kind": "{kind}", "label": "{label}"}}}}, "geometry": {{"type": "Point", "coordinates": [{x:?}, {y:?}]}}}}"#
    )
}

fn line(out: &mut String, id: usize, number: usize, arc: Arc, rooms: &Rooms) -> fmt::Result {
    let [from, to] = arc.ends.map(|end| end + 1);
    // Rounded up: an arc is not shorter than the straight line.
    let length_m = (rooms.length_m(arc).max(LEAST_LENGTH_M) * 1000.0).ceil() / 1000.0;
    let door = arc.door.map_or_else(String::new, |door| {
        format!(r#", "door": "{}""#, name_of(door))
    });
    let [[x, y], [u, v]] = arc.ends.map(|end| rooms.nodes[end].position_m);
    write!(
        out,
        r#"{{"type": "Feature", "properties": {{"id": {id}, "startid": {from}, "endid": {to}, "cost": {length_m:?}, "metadata": {{"name": "arc{number}"{door}}}}}, "geometry": {{"type": "MultiLineString", "coordinates": [[[{x:?}, {y:?}], [{u:?}, {v:?}]]]}}}}"#
    )
}

fn name_of(door: Doorway) -> String {
    format!("door{}_{}", door.one + 1, door.other + 1)
}

/// The round number above all numbers of nodes and arcs; the way there of arc 5 gets this and 5,
/// the way back twice this and 5.
fn first_id(most: usize) -> usize {
    let mut id = 1000;
    while id <= most {
        id *= 10;
    }
    id
}
