use std::collections::BTreeSet;

use proptest::prelude::*;

use super::*;

const OFFICE: &str = include_str!("../../examples/office.rmf.yaml");

fn made(text: &str, options: &RmfOptions) -> FromRmf {
    match from_rmf("graph.yaml", text, options) {
        Ok(made) => made,
        Err(findings) => unreachable!("{findings:?}\n{text}"),
    }
}

/// What is said of a text, with the lines.
fn refused(text: &str) -> Vec<String> {
    match from_rmf("graph.yaml", text, &RmfOptions::default()) {
        Ok(made) => unreachable!("taken: {}", made.map),
        Err(findings) => findings.iter().map(ToString::to_string).collect(),
    }
}

/// A level of vertices in a row, a metre apart, with these lanes.
fn row(vertices: usize, lanes: &str) -> String {
    let vertices: Vec<String> = (0..vertices).map(|x| format!("[{x}, 0, {{}}]")).collect();
    let vertices = vertices.join(", ");
    format!(
        "building_name: row\nlevels:\n  L1:\n    vertices: [{vertices}]\n    lanes: [{lanes}]\n"
    )
}

/// Lanes there and back along a row.
fn along(range: std::ops::Range<usize>) -> String {
    let lanes: Vec<String> = range
        .map(|at| format!("[{at}, {}, {{}}], [{}, {at}, {{}}]", at + 1, at + 1))
        .collect();
    lanes.join(", ")
}

/// The areas, each with its nodes.
fn areas(made: &FromRmf) -> Vec<(String, Vec<String>)> {
    let areas = made.site.areas();
    let named = areas.map(|area| {
        (
            area.name().to_string(),
            area.nodes().map(ToString::to_string).collect(),
        )
    });
    named.collect()
}

#[test]
fn the_rooms_of_the_office_are_what_its_doors_divide() {
    let made = made(OFFICE, &RmfOptions::default());
    let of = |node: &str| made.site.node(node).map(|node| node.area().clone());
    assert_eq!(of("reception"), of("charger1"));
    assert_eq!(of("lift_lobby"), of("lift1_l1"));
    let rooms = [
        "charger1",
        "lift_lobby",
        "office_101",
        "office_102",
        "office_103",
        "meeting_room",
        "coffee_machine",
        "shelf_a",
    ];
    let different: BTreeSet<_> = rooms.iter().map(|node| of(node)).collect();
    assert_eq!(different.len(), rooms.len());
    assert_eq!(made.site.areas().count(), rooms.len());
    // No door is made up, and none is lost.
    assert_eq!(made.site.doors().count(), 8);
    assert_eq!(made.start, "charger1");
    assert_eq!(made.level, "L1");
}

#[test]
fn what_vertices_are_for_and_are_called_is_kept() {
    let made = made(OFFICE, &RmfOptions::default());
    let node = |name: &str| made.site.node(name).expect("it is on the map");
    assert_eq!(node("coffee_machine").label(), "coffee machine");
    assert_eq!(node("coffee_machine").kind(), Some("pickup"));
    assert_eq!(node("charger1").kind(), Some("charger"));
    assert_eq!(node("lift1_l1").kind(), Some("lift"));
    assert_eq!(node("shelf_b").position_m(), [34.5, 2.5]);
    let shelves = made.site.passages().filter(|passage| passage.is_one_way());
    assert_eq!(shelves.count(), 3);
    assert!(
        made.map.contains(r#""abs_speed_limit": 0.8"#),
        "{}",
        made.map
    );
    assert!(
        made.notes
            .iter()
            .any(|note| note.contains("`mutex` of 3 lanes")),
        "{:?}",
        made.notes
    );
}

#[test]
fn by_names_what_begins_alike_lies_together() {
    let options = RmfOptions {
        areas_by: AreasBy::Names,
        ..RmfOptions::default()
    };
    let text = "levels: {L1: {vertices: [[0, 0, {name: lab_1}], [1, 0, {}], [5, 0, {name: lab_2}], \
                [9, 0, {name: hall}], [10, 0, {name: x, area: hall}]], lanes: [\
                [0, 1, {}], [1, 0, {}], [1, 2, {}], [2, 1, {}], [2, 3, {}], [3, 2, {}], [3, 4, {}], [4, 3, {}]]}}";
    let made = made(text, &options);
    let expected = [
        ("area_hall", vec!["hall", "x"]),
        ("area_lab", vec!["lab_1", "n2", "lab_2"]),
    ];
    let expected = expected.map(|(area, nodes)| {
        (
            area.to_owned(),
            nodes.into_iter().map(str::to_owned).collect(),
        )
    });
    assert_eq!(areas(&made), expected);
    assert!(made.site.door("gate_lab_hall").is_some(), "{}", made.map);
}

#[test]
fn a_long_corridor_is_cut_and_its_gates_stand_open() {
    let text = row(40, &along(0..39));
    let made = made(&text, &RmfOptions::default());
    assert!(
        made.site.areas().all(|area| area.nodes().count() <= 16),
        "{:?}",
        areas(&made)
    );
    assert!(
        made.site.areas().all(|area| area.nodes().count() >= 5),
        "{:?}",
        areas(&made)
    );
    assert!(made.site.doors().all(crate::Door::is_open_at_first));
    assert!(
        made.notes
            .iter()
            .any(|note| note.contains("gates are made up"))
    );
}

#[test]
fn a_door_with_a_way_round_it_is_still_a_border() {
    // A ring of six with a door between 0 and 5.
    let lanes = format!(
        "{}, [0, 5, {{door_name: d}}], [5, 0, {{door_name: d}}]",
        along(0..5)
    );
    let made = made(&row(6, &lanes), &RmfOptions::default());
    let door = made.site.door("d").expect("it is not lost");
    assert_ne!(door.joins()[0], door.joins()[1]);
    assert_eq!(made.site.areas().count(), 2);
}

#[test]
fn a_door_in_a_one_way_ring_is_left_out_and_said_to_be() {
    // Lanes round a ring of four; the door is on a short cut across it.
    let lanes = "[0, 1], [1, 2], [2, 3], [3, 0], [0, 2, {door_name: d}], [2, 0, {door_name: d}]";
    let made = made(&row(4, lanes), &RmfOptions::default());
    assert_eq!(made.site.doors().count(), 0);
    assert_eq!(made.site.areas().count(), 1);
    assert!(
        made.notes
            .iter()
            .any(|note| note.starts_with("door d between vertices 0 and 2")),
        "{:?}",
        made.notes
    );
}

#[test]
fn what_cannot_be_reached_and_left_again_is_left_out() {
    let lanes = format!("{}, [2, 3, {{}}]", along(0..2));
    let made = made(&row(4, &lanes), &RmfOptions::default());
    assert_eq!(made.site.nodes().count(), 3);
    assert!(
        made.notes.iter().any(|note| note.contains("left out: 3")),
        "{:?}",
        made.notes
    );
}

#[test]
fn a_lane_may_be_said_to_lead_both_ways() {
    let made = made(
        &row(2, "[0, 1, {is_bidirectional: true}]"),
        &RmfOptions::default(),
    );
    assert_eq!(
        made.site
            .passages()
            .filter(|passage| !passage.is_one_way())
            .count(),
        1
    );
}

#[test]
fn names_become_names_of_hddl_and_none_is_there_twice() {
    let text = "levels: {L1: {vertices: [[0, 0, {name: Büro 7}], [1, 0, {name: b_ro_7}], [2, 0, {name: 101}], [3, 0, {name: area1}], [4, 0, {name: n6}], [5, 0]], \
                lanes: [[0, 1, {is_bidirectional: true}], [1, 2, {is_bidirectional: true}], [2, 3, {is_bidirectional: true}], [3, 4, {is_bidirectional: true}], [4, 5, {is_bidirectional: true}]]}}";
    let made = made(text, &RmfOptions::default());
    let names: Vec<String> = made
        .site
        .nodes()
        .map(|node| node.name().to_string())
        .collect();
    assert_eq!(names, ["b_ro_7", "b_ro_7_2", "n101", "area1", "n6", "n6_2"]);
    assert!(made.site.area("area1_2").is_some());
}

#[test]
fn every_fault_is_named_with_its_line() {
    let text = "\
levels:
  L1:
    vertices:
    - [0, 0, {name: a}]
    - [one, 0, {}]
    - [1, 1.0e+300, {}]
    - {x: 3}
    - [3, 0, {name: a, area: [7]}]
    lanes:
    - [0, 1, {door_name: {}}]
    - [1, 9, {}]
    - [1]
    - [-1, 0.5, {speed_limit: fast}]
    - [0, 1, nothing]
";
    let found = refused(text);
    let expected = [
        (3, "vertices 0 and 4 have the same name: a"),
        (5, "vertex 1 must begin with two coordinates in metres"),
        (6, "vertex 2 must begin with two coordinates in metres"),
        (7, "vertex 3 must be [x, y, {its properties}]"),
        (8, "vertex 4 has a `area` that is not text"),
        (10, "lane 0 has a `door_name` that is not text"),
        (11, "lane 1 leads to or from vertex 9, which does not exist"),
        (12, "lane 2 must be [from, to, {its properties}]"),
        (13, "lane 3 must begin with the numbers of two vertices"),
        (13, "lane 3 has a `speed_limit` that is no number"),
        (14, "lane 4 must end with a table of properties"),
    ];
    for (line, message) in expected {
        let said = found
            .iter()
            .any(|fault| fault.starts_with(&format!("graph.yaml:{line}: {message}")));
        assert!(said, "{line}: {message} is not among {found:#?}");
    }
}

#[test]
fn a_text_that_is_no_graph_is_refused_in_words() {
    let cases = [
        ("", "is no navigation graph"),
        ("[1, 2]", "is no navigation graph"),
        ("levels: {}", "has no level"),
        ("levels: {L1: {}}", "has no list of `vertices`"),
        ("levels: {L1: {vertices: [], lanes: []}}", "has no lane"),
        (
            "levels: {L1: {vertices: [[0, 0]], lanes: []}}",
            "has no lane",
        ),
        ("levels: {a: {}, b: {}}", "several levels: name one of a, b"),
        (
            "levels: {L1: {vertices: [[1, 2, 0, name, {}]], lanes: []}}",
            "building of the traffic editor",
        ),
        ("levels:\n  L1: [", "is not YAML"),
        ("a: 1\na: 2", "is not YAML"),
        (
            "levels: {L1: {vertices: [[.nan, 0]], lanes: []}}",
            "is not YAML: non-finite float",
        ),
    ];
    for (text, expected) in cases {
        let found = refused(text);
        assert!(
            found.iter().any(|fault| fault.contains(expected)),
            "{text:?}: {found:?}"
        );
    }
    let found = refused("a: 1\nb: 2\nlevels:\n  L1: [");
    assert!(found[0].starts_with("graph.yaml:"), "{found:?}");
}

#[test]
fn a_text_made_to_exhaust_the_reader_is_refused() {
    let deep = "[".repeat(200_000);
    assert!(refused(&deep)[0].contains("is not YAML"));
    let mut laughs = "a0: &a0 [ha, ha, ha, ha, ha, ha, ha, ha, ha, ha]\n".to_owned();
    for level in 1..12 {
        let before = format!("*a{}, ", level - 1).repeat(10);
        laughs.push_str(&format!(
            "a{level}: &a{level} [{}]\n",
            before.trim_end_matches(", ")
        ));
    }
    assert!(refused(&laughs)[0].contains("is not YAML"));
}

#[test]
fn doors_that_differ_there_and_back_are_a_fault() {
    let found = refused(&row(2, "[0, 1, {door_name: a}], [1, 0, {door_name: b}]"));
    assert!(found[0].contains("two doors, a and b"), "{found:?}");
}

#[test]
fn another_level_is_taken_if_it_is_named() {
    let text = row(3, &along(0..2))
        + "  L2: {vertices: [[0, 0, {name: roof}], [0, 9]], lanes: [[0, 1], [1, 0]]}\n";
    let options = |level: &str| RmfOptions {
        level: Some(level.to_owned()),
        ..RmfOptions::default()
    };
    let made = made(&text, &options("L2"));
    assert_eq!((made.site.nodes().count(), made.site.name()), (2, "row L2"));
    assert!(
        made.notes.iter().any(|note| note.ends_with("left out: L1")),
        "{:?}",
        made.notes
    );
    let missing = from_rmf("graph.yaml", &text, &options("L3"))
        .err()
        .unwrap_or_default();
    assert!(
        missing
            .iter()
            .any(|fault| fault.message.contains("it has L1, L2")),
        "{missing:?}"
    );
}

fn random_graph() -> impl Strategy<Value = String> {
    let vertex = (
        -50i32..50,
        -50i32..50,
        prop_oneof![Just(None), "[a-c]_[0-9]{3}".prop_map(Some)],
    );
    (proptest::collection::vec(vertex, 2..40), 1usize..120).prop_flat_map(|(vertices, lanes)| {
        let count = vertices.len();
        let lane = (0..count, 0..count, 0u8..12, any::<bool>());
        (Just(vertices), proptest::collection::vec(lane, lanes)).prop_map(|(vertices, lanes)| {
            let mut text = "levels:\n  L1:\n    vertices:\n".to_owned();
            for (index, (x, y, name)) in vertices.iter().enumerate() {
                let name = name
                    .as_ref()
                    .map_or_else(String::new, |name| format!("name: {name}{index}"));
                text.push_str(&format!("    - [{x}, {y}, {{{name}}}]\n"));
            }
            text.push_str("    lanes:\n");
            for (from, to, door, both) in lanes {
                // One door for each pair, so that there and back agree.
                let door = if door < 3 {
                    format!("door_name: d{}, ", (from * to + from + to) % 4)
                } else {
                    String::new()
                };
                text.push_str(&format!(
                    "    - [{from}, {to}, {{{door}is_bidirectional: {both}}}]\n"
                ));
            }
            text
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 64, ..ProptestConfig::default() })]

    /// Whatever the lanes are like: the map that is made of them passes all that `map check` looks for.
    #[test]
    fn every_graph_that_is_in_order_makes_a_map_that_is(text in random_graph(), most_nodes in 2usize..20, by_names: bool) {
        let areas_by = if by_names { AreasBy::Names } else { AreasBy::Doors };
        let options = RmfOptions { level: None, areas_by, most_nodes };
        match from_rmf("graph.yaml", &text, &options) {
            Ok(made) => {
                let again = from_rmf("graph.yaml", &text, &options);
                prop_assert_eq!(again.map(|again| again.map), Ok(made.map));
            }
            Err(findings) => {
                for finding in findings {
                    let fair = finding.message.contains("two doors") || finding.message.contains("has no lane");
                    prop_assert!(fair, "{}", finding);
                }
            }
        }
    }
}
