mod faults;
mod paper;
mod reading;
mod strange;

use super::*;

const MUSEUM: &str = include_str!("../../../museum/map.geojson");

fn museum() -> Site {
    Site::from_text("map.geojson", MUSEUM).expect("the museum has no faults")
}

/// A map of the given features: two areas, a node in each, and whatever is added.
fn with(doors: &str, features: &[String]) -> String {
    format!(
        "{{\"type\": \"FeatureCollection\", \"doors\": {{{doors}}},\n\"features\": [\n{}\n]}}",
        features.join(",\n")
    )
}

fn node(id: &str, name: &str, area: &str, position: &str) -> String {
    format!(
        r#"{{"type": "Feature", "properties": {{"id": {id}, "metadata": {{"name": "{name}", "area": "{area}"}}}}, "geometry": {{"type": "Point", "coordinates": {position}}}}}"#
    )
}

fn edge(id: u64, from: u32, to: u32, metadata: &str) -> String {
    format!(
        r#"{{"type": "Feature", "properties": {{"id": {id}, "startid": {from}, "endid": {to}, "metadata": {{{metadata}}}}}, "geometry": {{"type": "LineString", "coordinates": [[0, 0], [1, 1]]}}}}"#
    )
}

/// Three nodes on a line, 4 m apart; a door between the second and the third.
fn sound() -> Vec<String> {
    vec![
        node("1", "n1", "hall", "[0, 0]"),
        node("2", "n2", "hall", "[4, 0]"),
        node("3", "n3", "yard", "[8, 0]"),
        edge(11, 1, 2, r#""name": "arc1", "length_m": 4"#),
        edge(12, 2, 1, r#""name": "arc1", "length_m": 4"#),
        edge(13, 2, 3, r#""name": "arc2", "length_m": 4, "door": "gate""#),
        edge(14, 3, 2, r#""name": "arc2", "length_m": 4, "door": "gate""#),
    ]
}

const GATE: &str = r#""gate": {"open": false}"#;

fn findings(text: &str) -> Vec<String> {
    let findings = Site::from_text("f", text).err().unwrap_or_default();
    findings.iter().map(ToString::to_string).collect()
}

/// What is found when one line of the sound map is another, or one more.
fn changed(line: usize, text: String) -> Vec<String> {
    let mut features = sound();
    if line < features.len() {
        features[line] = text;
    } else {
        features.push(text);
    }
    findings(&with(GATE, &features))
}

#[track_caller]
fn assert_findings(found: &[String], expected: &[&str]) {
    let same = found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|(found, expected)| found.contains(expected));
    assert!(same, "found {found:#?}\nrather than {expected:#?}");
}
