//! From text to features. What cannot be read is a finding and left out.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::Symbol;
use geojson::{Feature, GeometryValue, JsonObject, JsonValue};
use serde::Deserialize;
use serde_json::value::RawValue;

use super::faults::{Faults, Origin};
use super::fields::{Fields, symbol};
use super::lines::Lines;

/// A map as far as it could be read: nothing in here has been compared with anything else.
pub(super) struct Drawing {
    pub(super) name: String,
    pub(super) nodes: Vec<NodeFeature>,
    pub(super) edges: Vec<EdgeFeature>,
    pub(super) doors: Vec<DoorMember>,
    pub(super) areas: Vec<AreaMember>,
    /// Ids of features that could not be read, so that nobody is told that they do not exist.
    pub(super) unreadable: BTreeSet<u32>,
}

pub(super) struct NodeFeature {
    pub(super) origin: Origin,
    pub(super) id: u32,
    pub(super) name: Symbol,
    pub(super) area: Symbol,
    pub(super) kind: Option<String>,
    pub(super) label: Option<String>,
    pub(super) position_m: [f64; 2],
}

pub(super) struct EdgeFeature {
    pub(super) origin: Origin,
    pub(super) id: u32,
    pub(super) start: u64,
    pub(super) end: u64,
    pub(super) name: Symbol,
    pub(super) named: bool,
    /// `None` if the edge says nothing usable, which has been found already.
    pub(super) length_m: Option<f64>,
    pub(super) door: Option<Symbol>,
    /// It names a door, but nobody can tell which; that has been found already.
    pub(super) door_unclear: bool,
}

pub(super) struct DoorMember {
    pub(super) line: usize,
    pub(super) name: Symbol,
    pub(super) open: bool,
}

pub(super) struct AreaMember {
    pub(super) line: usize,
    pub(super) name: Symbol,
    pub(super) rectangle_m: Option<[f64; 4]>,
}

/// The members are kept as text, because where a piece of the text lies says what line it is on.
#[derive(Deserialize)]
struct Collection<'a> {
    #[serde(rename = "type", default, borrow)]
    kind: Option<&'a RawValue>,
    #[serde(default, borrow)]
    name: Option<&'a RawValue>,
    #[serde(default, borrow)]
    doors: Option<&'a RawValue>,
    #[serde(default, borrow)]
    areas: Option<&'a RawValue>,
    #[serde(default, borrow)]
    features: Option<&'a RawValue>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DoorState {
    open: bool,
}

#[derive(Deserialize)]
struct AreaDrawing {
    rectangle_m: Option<[f64; 4]>,
}

/// `None` if there is nothing to go on with.
pub(super) fn read(text: &str, faults: &mut Faults) -> Option<Drawing> {
    let lines = Lines::of(text);
    let collection: Collection<'_> = match serde_json::from_str(text) {
        Ok(collection) => collection,
        Err(error) => {
            faults.add(error.line().max(1), format!("is not GeoJSON: {error}"));
            return None;
        }
    };
    let kind = collection.kind.and_then(text_of);
    if kind.as_deref() != Some("FeatureCollection") {
        faults.add(0, "is not GeoJSON: its type must be \"FeatureCollection\"");
        return None;
    }
    let features: Vec<&RawValue> = match collection.features.map(|raw| raw.get()) {
        None => {
            faults.add(0, "is not GeoJSON: it has no `features`");
            return None;
        }
        Some(list) => match serde_json::from_str(list) {
            Ok(features) => features,
            Err(_) => {
                faults.add(lines.of_piece(list), "`features` must be a list");
                return None;
            }
        },
    };
    let mut drawing = Drawing {
        name: collection.name.and_then(text_of).unwrap_or_default(),
        nodes: Vec::new(),
        edges: Vec::new(),
        doors: Vec::new(),
        areas: Vec::new(),
        unreadable: BTreeSet::new(),
    };
    read_doors(collection.doors, &lines, &mut drawing, faults);
    read_areas(collection.areas, &lines, &mut drawing, faults);
    for (index, raw) in features.into_iter().enumerate() {
        let origin = Origin {
            line: lines.of_piece(raw.get()),
            number: index + 1,
            called: String::new(),
        };
        read_feature(raw.get(), origin, &mut drawing, faults);
    }
    name_the_nameless(&mut drawing.edges);
    Some(drawing)
}

fn text_of(raw: &RawValue) -> Option<String> {
    serde_json::from_str(raw.get()).ok()
}

fn members<'a>(
    what: &str,
    raw: Option<&'a RawValue>,
    lines: &Lines<'_>,
    faults: &mut Faults,
) -> BTreeMap<String, &'a RawValue> {
    let Some(raw) = raw else {
        return BTreeMap::new();
    };
    serde_json::from_str(raw.get()).unwrap_or_else(|_| {
        let line = lines.of_piece(raw.get());
        faults.add(
            line,
            format!("`{what}` must be an object with a member for each"),
        );
        BTreeMap::new()
    })
}

fn read_doors(
    raw: Option<&RawValue>,
    lines: &Lines<'_>,
    drawing: &mut Drawing,
    faults: &mut Faults,
) {
    for (name, raw) in members("doors", raw, lines, faults) {
        let line = lines.of_piece(raw.get());
        let state = serde_json::from_str::<DoorState>(raw.get());
        if state.is_err() {
            let message = format!("door {name} must say {{\"open\": true}} or {{\"open\": false}}");
            faults.add(line, message);
        }
        match symbol(&name) {
            Ok(name) => drawing.doors.push(DoorMember {
                line,
                name,
                // A door that does not say is named above; take it for open to find the rest.
                open: state.map_or(true, |state| state.open),
            }),
            Err(message) => faults.add(line, format!("door {message}")),
        }
    }
}

fn read_areas(
    raw: Option<&RawValue>,
    lines: &Lines<'_>,
    drawing: &mut Drawing,
    faults: &mut Faults,
) {
    for (name, raw) in members("areas", raw, lines, faults) {
        let line = lines.of_piece(raw.get());
        let rectangle_m = match serde_json::from_str::<AreaDrawing>(raw.get()) {
            Ok(area) => area.rectangle_m,
            Err(_) => {
                let message = "must have `rectangle_m`: [west, south, east, north], in metres";
                faults.add(line, format!("area {name} {message}"));
                None
            }
        };
        match symbol(&name) {
            Ok(name) => drawing.areas.push(AreaMember {
                line,
                name,
                rectangle_m,
            }),
            Err(message) => faults.add(line, format!("area {message}")),
        }
    }
}

fn read_feature(text: &str, mut origin: Origin, drawing: &mut Drawing, faults: &mut Faults) {
    let feature = match serde_json::from_str::<Feature>(text) {
        Ok(feature) => feature,
        Err(error) => {
            let id = serde_json::from_str::<JsonValue>(text)
                .ok()
                .and_then(|value| u32::try_from(value["properties"]["id"].as_u64()?).ok());
            drawing.unreadable.extend(id);
            if let Some(id) = id {
                origin.called = format!("the feature with id {id}");
            }
            // The position in `error` is one in this feature, not in the file.
            let error = error.to_string();
            let reason = error.split(" at line ").next().unwrap_or_default();
            return faults.about(&origin, format!("is not GeoJSON: {reason}"));
        }
    };
    let none = JsonObject::new();
    let properties = feature.properties.as_ref().unwrap_or(&none);
    let geometry = feature.geometry.as_ref().map(|geometry| &geometry.value);
    let role = match role_of(geometry, properties) {
        Ok(role) => role,
        Err(kind) => {
            let message = format!("is a {kind}: a node must be a Point, an edge a LineString");
            return faults.about(&origin, message);
        }
    };
    let metadata = properties.get("metadata");
    let mut fields = Fields {
        properties,
        metadata: metadata.and_then(JsonValue::as_object).unwrap_or(&none),
        origin: &mut origin,
        faults,
    };
    let (called, what) = match role {
        Role::Node(_) => ("node", "a node"),
        Role::Edge => ("edge", "an edge"),
        Role::Neither => return,
    };
    let Some(id) = fields.id(what) else { return };
    fields.origin.called = format!("{called} {id}");
    if metadata.is_some_and(|value| !value.is_object()) {
        fields.fault("has a `metadata` that is not an object");
    }
    let name = fields.name("name");
    if let Some(name) = &name {
        fields.origin.called = format!("{called} {id} {name}");
    }
    match role {
        Role::Node(position) => match fields.node(id, name, position) {
            Some(node) => drawing.nodes.push(node),
            None => drawing.unreadable.extend([id]),
        },
        _ => drawing.edges.extend(fields.edge(id, name)),
    }
}

enum Role<'a> {
    /// At this position; empty if it has none.
    Node(&'a [f64]),
    Edge,
    /// A wall, a note: Nav2 ignores these too.
    Neither,
}

/// A geometry that is neither for nodes nor for edges, yet not one for drawings, is an error.
fn role_of<'a>(
    geometry: Option<&'a GeometryValue>,
    properties: &JsonObject,
) -> Result<Role<'a>, &'static str> {
    let is_edge = properties.contains_key("startid") || properties.contains_key("endid");
    match geometry {
        Some(GeometryValue::LineString { .. } | GeometryValue::MultiLineString { .. }) => {
            Ok(Role::Edge)
        }
        Some(GeometryValue::Point { coordinates }) if !is_edge => {
            Ok(Role::Node(coordinates.as_slice()))
        }
        None if is_edge => Ok(Role::Edge),
        None if properties.contains_key("id") => Ok(Role::Node(&[])),
        None | Some(GeometryValue::Polygon { .. } | GeometryValue::MultiPolygon { .. }) => {
            Ok(Role::Neither)
        }
        Some(other) => Err(other.type_name()),
    }
}

/// Two edges without a name are one passage if they are each other's way back; it is called after
/// the smaller id.
fn name_the_nameless(edges: &mut [EdgeFeature]) {
    let mut first: BTreeMap<(u64, u64), u32> = BTreeMap::new();
    let mut edges: Vec<&mut EdgeFeature> = edges.iter_mut().filter(|edge| !edge.named).collect();
    edges.sort_by_key(|edge| edge.id);
    for edge in edges {
        match first.remove(&(edge.end, edge.start)) {
            Some(id) => edge.name = Symbol::from(format!("arc{id}")),
            None => {
                first.insert((edge.start, edge.end), edge.id);
            }
        }
    }
}
