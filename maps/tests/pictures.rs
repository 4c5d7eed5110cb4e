//! The pictures in the repository are those of the maps beside them.

use std::fs;
use std::path::Path;

use maps::{Picture, Site};

fn is_drawn_as(file: &str, picture: &str, start: &str, goal: &str, closed: Option<&str>) {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR"));
    let site = Site::read(dir.join(file)).expect("the map is in order");
    let mut drawing = Picture {
        start: Some(start.into()),
        ..Picture::default()
    };
    drawing
        .doors
        .extend(closed.map(|door| (door.into(), false)));
    drawing.route = drawing.find_route(&site, start, goal);
    assert!(drawing.route.is_some(), "no way from {start} to {goal}");
    let drawn = drawing.svg(&site);
    let kept = fs::read_to_string(dir.join(picture)).unwrap_or_default();
    let closed = closed.map_or_else(String::new, |door| format!(" --closed {door}"));
    assert!(
        drawn == kept,
        "maps/{picture} is out of date: \
         intermezzo map svg maps/{file} --start {start} --route {start} {goal}{closed} -o maps/{picture}"
    );
}

#[test]
fn the_museum_looks_as_its_picture_shows() {
    is_drawn_as("museum/map.geojson", "museum/museum.svg", "n1", "n40", None);
}

#[test]
fn the_office_looks_as_its_picture_shows() {
    is_drawn_as(
        "examples/office.geojson",
        "examples/office.svg",
        "charger1",
        "shelf_b",
        None,
    );
}

#[test]
fn the_map_of_the_office_is_what_its_navigation_graph_makes() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let graph = fs::read_to_string(dir.join("office.rmf.yaml")).expect("the graph is there");
    let made = maps::from_rmf("office.rmf.yaml", &graph, &maps::RmfOptions::default());
    let made = made.expect("the graph is in order");
    let kept = fs::read_to_string(dir.join("office.geojson")).unwrap_or_default();
    assert!(
        made.map == kept,
        "maps/examples/office.geojson is out of date: \
         intermezzo map from-rmf maps/examples/office.rmf.yaml -o maps/examples/office.geojson"
    );
}
