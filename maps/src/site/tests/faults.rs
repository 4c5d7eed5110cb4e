use super::*;

#[test]
fn text_that_is_not_geojson() {
    assert_findings(&findings("nodes: 40"), &["f:1: is not GeoJSON: "]);
    assert_findings(&findings("{\"type\":\n \"Feat"), &["f:2: is not GeoJSON: "]);
    assert_findings(&findings("{\"type\": \"Feature\"}"), &["its type must be"]);
    assert_findings(
        &findings("{\"type\": \"FeatureCollection\"}"),
        &["no `features`"],
    );
    assert_findings(
        &findings("{\"type\": \"FeatureCollection\",\n\"features\": 3}"),
        &["f:2: `features` must be a list"],
    );
    assert_findings(&findings(&with("", &[])), &["the map has no nodes"]);
}

#[test]
fn a_feature_that_is_not_geojson() {
    assert_findings(
        &changed(
            99,
            r#"{"type": "Feature", "properties": {"id": 4}, "geometry": {"type": "Point"}}"#.into(),
        ),
        &[
            "f:10: the feature with id 4 (feature 8) is not GeoJSON: Encountered geometry type: `Point` with no `coordinates`",
        ],
    );
    assert_findings(
        &changed(99, "17".into()),
        &["f:10: feature 8 is not GeoJSON"],
    );
    assert_findings(
        &changed(99, r#"{"type": "Feature", "properties": {"id": 4}, "geometry": {"type": "MultiPoint", "coordinates": [[1, 2]]}}"#.into()),
        &["feature 8 is a MultiPoint: a node must be a Point"],
    );
}

#[test]
fn ids_that_nav2_could_not_use() {
    let no_id = node("1", "n9", "hall", "[0, 0]").replace("\"id\": 1, ", "");
    assert_findings(
        &changed(99, no_id),
        &["feature 8 is meant as a node, but has no `properties.id`"],
    );
    for id in ["\"n4\"", "1.5", "-4", "null"] {
        let found = changed(99, node(id, "n9", "hall", "[0, 0]"));
        assert_findings(&found, &["which is not a whole number"]);
    }
    assert_findings(
        &changed(
            99,
            edge(4_294_967_296, 1, 2, r#""name": "arc9", "length_m": 4"#),
        ),
        &["has the id 4294967296; the largest that Nav2 knows is 4294967295"],
    );
}

#[test]
fn ids_used_twice_by_nodes_or_by_a_node_and_an_edge() {
    assert_findings(
        &changed(99, node("1", "n9", "hall", "[0, 0]")),
        &["f:10: node 1 n9 (feature 8) has the id of node 1 n1 (feature 1)"],
    );
    assert_findings(
        &changed(99, edge(3, 1, 2, r#""name": "arc9", "length_m": 4"#)),
        &["edge 3 arc9 (feature 8) has the id of node 3 n3 (feature 3)"],
    );
}

#[test]
fn names_used_twice() {
    let mut features = sound();
    features[1] = node("2", "N1", "hall", "[4, 0]");
    assert_findings(
        &findings(&with(GATE, &features)),
        &["node 2 n1 (feature 2) has the name of node 1 n1 (feature 1)"],
    );
    assert_findings(
        &changed(0, node("1", "hall", "hall", "[0, 0]")),
        &[
            "area hall has the name of node 1 hall (feature 1)",
            "area hall has the name of",
        ],
    );
    assert_findings(
        &changed(99, edge(15, 1, 2, r#""name": "arc1", "length_m": 4"#)),
        &[
            "edge 15 arc1 (feature 8) has the name of edge 11 arc1 (feature 4), but is not its way back",
        ],
    );
}

#[test]
fn a_name_for_edges_that_are_not_each_others_way_back() {
    let way_back = "but is not its way back";
    // In the same direction, in the other one for the second time, and between other nodes.
    for (from, to) in [(1, 2), (2, 1)] {
        let found = changed(99, edge(15, from, to, r#""name": "arc1", "length_m": 4"#));
        assert_findings(&found, &[way_back]);
    }
    let mut features = sound();
    features.push(node("4", "n4", "hall", "[0, 4]"));
    for (id, from, to) in [(15, 1, 4), (16, 4, 2)] {
        features.push(edge(id, from, to, r#""name": "arc9", "length_m": 6"#));
    }
    assert_findings(&findings(&with(GATE, &features)), &[way_back]);
}

#[test]
fn names_that_the_domains_cannot_have() {
    for name in ["the arc", "2nd", "", "gr\u{fc}n"] {
        let found = changed(
            99,
            edge(15, 1, 2, &format!(r#""name": "{name}", "length_m": 4"#)),
        );
        assert_findings(&found, &["is not a name of HDDL"]);
    }
}

#[test]
fn an_edge_to_a_node_that_does_not_exist() {
    assert_findings(
        &changed(99, edge(15, 1, 77, r#""name": "arc9", "length_m": 4"#)),
        &["f:10: edge 15 arc9 (feature 8) ends at node 77, which does not exist"],
    );
    let no_end = edge(15, 1, 2, r#""name": "arc9", "length_m": 4"#).replace("\"endid\": 2, ", "");
    assert_findings(&changed(99, no_end), &["has no `endid`, the id of a node"]);
}

#[test]
fn an_edge_without_a_length() {
    let about = "edge 15 arc9 (feature 8) ";
    for (metadata, message) in [
        ("", "has no length"),
        (r#", "length_m": 0"#, "has `length_m` 0, which is no length"),
        (
            r#", "length_m": -3"#,
            "has `length_m` -3, which is no length",
        ),
        (
            r#", "length_m": "3""#,
            "has `length_m` \"3\", which is no length",
        ),
        (
            r#", "length_m": 1e300"#,
            "has `length_m` 1e+300, which is no length",
        ),
    ] {
        let found = changed(99, edge(15, 1, 2, &format!(r#""name": "arc9"{metadata}"#)));
        assert_findings(&found, &[&format!("{about}{message}")]);
    }
    let free = edge(15, 1, 2, r#""name": "arc9""#);
    for (cost, message) in [
        ("0", "has no length"),
        ("-2", "has `cost` -2, which is no length"),
    ] {
        let found = changed(
            99,
            free.replace("\"endid\"", &format!("\"cost\": {cost}, \"endid\"")),
        );
        assert_findings(&found, &[&format!("{about}{message}")]);
    }
}

#[test]
fn an_edge_shorter_than_the_straight_line_by_more_than_a_centimetre() {
    let with_length = |length: &str| {
        changed(
            99,
            edge(
                15,
                1,
                2,
                &format!(r#""name": "arc9", "length_m": {length}"#),
            ),
        )
    };
    assert_findings(&with_length("3.991"), &[]);
    assert_findings(
        &with_length("3.98"),
        &["edge 15 arc9 (feature 8) is 3.98 m long, though its ends are 4.000 m apart"],
    );
}

#[test]
fn a_node_without_an_area_or_coordinates() {
    let no_area = node("4", "n4", "hall", "[0, 0]").replace(", \"area\": \"hall\"", "");
    assert_findings(
        &changed(99, no_area),
        &["node 4 n4 (feature 8) lies in no area"],
    );
    assert_findings(
        &changed(99, node("4", "n4", "hall", "[0]")),
        &["the feature with id 4 (feature 8) is not GeoJSON: "],
    );
    let nowhere = r#"{"type": "Feature", "properties": {"id": 4, "metadata": {"name": "n4", "area": "hall"}}, "geometry": null}"#;
    assert_findings(
        &changed(99, nowhere.into()),
        &["node 4 n4 (feature 8) has no coordinates"],
    );
    assert_findings(
        &changed(99, node("4", "n4", "hall", "[1e999, 0]")),
        &["f:10: feature 8 is not GeoJSON: number out of range"],
    );
}

#[test]
fn doors_without_an_edge_and_edges_with_an_unknown_door() {
    let doors = format!("{GATE},\n\"hatch\": {{\"open\": true}}");
    assert_findings(
        &findings(&with(&doors, &sound())),
        &["f:2: door hatch is on no edge"],
    );
    assert_findings(
        &findings(&with("", &sound())),
        &[
            "edge 13 arc2 (feature 6) has gate, which is missing",
            "edge 14 arc2",
        ],
    );
    assert_findings(
        &findings(&with(r#""gate": {"open": "yes"}"#, &sound())),
        &["f:1: door gate must say"],
    );
}

#[test]
fn doors_inside_an_area_and_areas_joined_without_one() {
    assert_findings(
        &changed(
            99,
            edge(15, 1, 2, r#""name": "arc9", "length_m": 4, "door": "gate""#),
        ),
        &["edge 15 arc9 (feature 8) has gate, but both its ends lie in hall"],
    );
    assert_findings(
        &changed(99, edge(15, 1, 3, r#""name": "arc9", "length_m": 8"#)),
        &["edge 15 arc9 (feature 8) joins hall and yard without a door"],
    );
}

#[test]
fn one_door_between_two_pairs_of_areas() {
    let mut features = sound();
    features.push(node("4", "n4", "cellar", "[8, 4]"));
    for (id, from, to) in [(15, 3, 4), (16, 4, 3)] {
        features.push(edge(
            id,
            from,
            to,
            r#""name": "arc9", "length_m": 4, "door": "gate""#,
        ));
    }
    assert_findings(
        &findings(&with(GATE, &features)),
        &[
            "joins yard and cellar by gate, which already joins hall and yard",
            "joins cellar and yard",
        ],
    );
}

#[test]
fn an_area_that_is_joined_to_no_other() {
    let mut features = sound();
    features.push(node("4", "n4", "cellar", "[8, 4]"));
    assert_findings(
        &findings(&with(GATE, &features)),
        &["f:10: area cellar is joined to no other area"],
    );
    // It can be entered, but not left.
    features.push(edge(
        15,
        3,
        4,
        r#""name": "arc9", "length_m": 4, "door": "trap""#,
    ));
    assert_findings(
        &findings(&with(
            &format!("{GATE}, \"trap\": {{\"open\": true}}"),
            &features,
        )),
        &["area cellar and area hall cannot be reached from each other, even with all doors open"],
    );
}

#[test]
fn a_node_that_cannot_be_reached_from_the_others_inside_its_area() {
    let message =
        "node 4 n4 (feature 8) and the rest of hall cannot be reached from each other inside it";
    let mut features = sound();
    features.push(node("4", "n4", "hall", "[0, 4]"));
    assert_findings(&findings(&with(GATE, &features)), &[message]);
    features.push(edge(15, 1, 4, r#""name": "arc9", "length_m": 4"#));
    assert_findings(&findings(&with(GATE, &features)), &[message]);
    features.push(edge(16, 4, 1, r#""name": "arc9", "length_m": 4"#));
    assert_findings(&findings(&with(GATE, &features)), &[]);
}

#[test]
fn directions_that_disagree_in_length_or_door() {
    assert_findings(
        &changed(4, edge(12, 2, 1, r#""name": "arc1", "length_m": 5"#)),
        &[
            "edge 12 arc1 (feature 5) is 5 m long, but 4 m in the other direction, edge 11 arc1 (feature 4)",
        ],
    );
    let doors = format!("{GATE}, \"hatch\": {{\"open\": true}}");
    let mut features = sound();
    features[6] = edge(
        14,
        3,
        2,
        r#""name": "arc2", "length_m": 4, "door": "hatch""#,
    );
    assert_findings(
        &findings(&with(&doors, &features)),
        &["edge 14 arc2 (feature 7) has hatch, but gate in the other direction"],
    );
}

#[test]
fn an_edge_from_a_node_to_itself() {
    assert_findings(
        &changed(99, edge(15, 1, 1, r#""name": "loop", "length_m": 4"#)),
        &["edge 15 loop (feature 8) leads from node 1 to itself"],
    );
}

#[test]
fn areas_drawn_where_their_nodes_are_not() {
    let text = with(GATE, &sound()).replace(
        "\"features\"",
        "\"areas\": {\"hall\": {\"rectangle_m\": [0, 0, 3, 3]},\n\"attic\": {}, \"yard\": {\"rectangle_m\": 3}},\n\"features\"",
    );
    assert_findings(
        &findings(&text),
        &[
            "f:3: area yard must have `rectangle_m`",
            "f:3: area attic has no node",
            "f:6: node 2 n2 (feature 2) lies at 4, 0, outside the rectangle of hall",
        ],
    );
}

#[test]
fn all_faults_of_a_file_are_told_at_once_in_the_order_of_its_lines() {
    let mut features = sound();
    features[1] = node("1", "n2", "hall", "[4, 0]");
    features[2] = node("3", "n1", "yard", "[8, 0]");
    features[4] = edge(12, 2, 1, r#""name": "arc1""#);
    features.push(edge(15, 1, 1, r#""name": "loop", "length_m": 4"#));
    let doors = format!("{GATE}, \"hatch\": {{\"open\": true}}");
    assert_findings(
        &findings(&with(&doors, &features)),
        &[
            "f:1: door hatch is on no edge",
            "f:4: node 1 n2 (feature 2) has the id of node 1 n1",
            "f:5: node 3 n1 (feature 3) has the name of node 1 n1",
            "f:5: area yard is joined to no other area",
            "f:6: edge 11 arc1 (feature 4) ends at node 2, which does not exist",
            "f:7: edge 12 arc1 (feature 5) has no length",
            "f:7: edge 12 arc1 (feature 5) starts at node 2",
            "f:8: edge 13 arc2 (feature 6) starts at node 2",
            "f:9: edge 14 arc2 (feature 7) ends at node 2",
            "f:10: edge 15 loop (feature 8) leads from node 1 to itself",
        ],
    );
}

#[test]
fn a_node_that_cannot_be_read_is_not_also_missed_by_its_edges() {
    let found = changed(1, node("2", "n2", "hall", "[\"east\", 0]"));
    assert!(
        !found.iter().any(|one| one.contains("does not exist")),
        "{found:#?}"
    );
}
