use super::*;

#[test]
fn a_sound_map_has_no_findings() {
    assert_findings(&findings(&with(GATE, &sound())), &[]);
}

#[test]
fn nodes_know_their_area_their_place_and_what_people_call_them() {
    let site = museum();
    let toilet = site.node("n28").expect("it is on the map");
    assert_eq!(toilet.id(), 28);
    assert_eq!(toilet.area().as_str(), "area4");
    assert_eq!((toilet.kind(), toilet.label()), (Some("toilet"), "toilet"));
    assert_eq!(toilet.position_m(), [30.5, 19.0]);
    assert!(site.node("n41").is_none());
}

#[test]
fn two_edges_of_one_name_are_one_passage() {
    let site = museum();
    let arc = site.passage("arc5").expect("it is on the map");
    assert!(!arc.is_one_way());
    assert_eq!(arc.directions().count(), 2);
    assert_eq!(arc.other_end("n6").map(Symbol::as_str), Some("n1"));
    assert_eq!(arc.other_end("n7"), None);
    assert_eq!(arc.length_m(), 7.762);
}

#[test]
fn an_edge_without_a_way_back_is_a_one_way_passage() {
    let mut features = sound();
    features.push(edge(15, 2, 1, r#""name": "slide", "length_m": 4.5"#));
    let site = Site::from_text("f", &with(GATE, &features)).expect("sound");
    let slide = site.passage("slide").expect("it is on the map");
    assert!(slide.is_one_way());
    assert_eq!(slide.ends().map(Symbol::as_str), ["n2", "n1"]);
    let ways = |node| site.neighbours(node).count();
    assert_eq!((ways("n1"), ways("n2"), ways("n3")), (1, 3, 1));
    assert_eq!(site.summary().one_way, 1);
}

#[test]
fn edges_drawn_for_nav2_without_names_or_lengths_get_theirs_from_ids_and_costs() {
    let features = [
        r#"{"type": "Feature", "properties": {"id": 1, "metadata": {"area": "Hall"}}, "geometry": {"type": "Point", "coordinates": [0, 0]}}"#,
        r#"{"type": "Feature", "properties": {"id": 2, "metadata": {"area": "Hall"}}, "geometry": {"type": "Point", "coordinates": [4, 0]}}"#,
        r#"{"type": "Feature", "properties": {"id": 7, "startid": 1, "endid": 2, "cost": 4.5}, "geometry": null}"#,
        r#"{"type": "Feature", "properties": {"id": 9, "startid": 2, "endid": 1, "cost": 4.5}, "geometry": null}"#,
    ];
    let site = Site::from_text("f", &with("", &features.map(String::from))).expect("sound");
    let arc = site.passage("arc7").expect("called after the smaller id");
    assert_eq!((arc.length_m(), arc.is_one_way()), (4.5, false));
    assert_eq!(site.passages().count(), 1);
    assert_eq!(
        site.node("n1").map(|node| node.area().as_str()),
        Some("hall")
    );
}

#[test]
fn features_that_are_neither_node_nor_edge_are_left_alone() {
    let wall = r#"{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]}}"#;
    assert_findings(&changed(99, wall.into()), &[]);
}

#[test]
fn a_map_is_summed_up_in_one_line() {
    assert_eq!(
        museum().summary().to_string(),
        "8 areas, 40 nodes, 63 passages, 10 doors (1 closed)"
    );
}

#[test]
fn a_file_that_is_not_there_is_a_finding() {
    let found = check_map("no/such/map.geojson");
    assert_eq!(found.len(), 1);
    assert!(
        found[0].message.starts_with("cannot be read"),
        "{}",
        found[0]
    );
}
