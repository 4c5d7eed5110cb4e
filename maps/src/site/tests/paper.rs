use super::*;

#[test]
fn nodes_are_n1_to_n40_and_arcs_are_arc1_to_arc63() {
    let site = museum();
    let nodes: Vec<_> = site.nodes().map(|node| node.name().to_string()).collect();
    assert_eq!(
        nodes,
        (1..=40).map(|id| format!("n{id}")).collect::<Vec<_>>()
    );
    assert!(
        site.nodes()
            .all(|node| node.name().as_str() == format!("n{}", node.id()))
    );
    let arcs: Vec<_> = site.passages().map(|arc| arc.name().to_string()).collect();
    assert_eq!(
        arcs,
        (1..=63).map(|id| format!("arc{id}")).collect::<Vec<_>>()
    );
}

#[test]
fn nodes_lie_in_the_areas_that_the_text_names() {
    let site = museum();
    for (node, area) in [
        ("n1", "area1"),
        ("n6", "area1"),
        ("n4", "area1"),
        ("n12", "area3"),
        ("n13", "area2"),
        ("n28", "area4"),
        ("n29", "area7"),
        ("n38", "area8"),
        ("n35", "area8"),
        ("n40", "area8"),
        ("n10", "area3"),
    ] {
        assert_eq!(
            site.node(node).map(|node| node.area().as_str()),
            Some(area),
            "{node}"
        );
    }
}

#[test]
fn arc5_and_arc59_are_where_the_experiments_interrupt_the_robot() {
    let site = museum();
    for (arc, ends, area) in [
        ("arc5", ["n1", "n6"], "area1"),
        ("arc59", ["n35", "n40"], "area8"),
    ] {
        let arc = site.passage(arc).expect("it is on the map");
        assert_eq!(arc.ends().map(Symbol::as_str), ends);
        assert_eq!(site.areas_of(arc).map(Symbol::as_str), [area, area]);
    }
}

#[test]
fn a_door_between_n6_and_n10_joins_area1_and_area3() {
    let site = museum();
    let (arc, _) = site
        .neighbours("n6")
        .find(|(_, node)| node.name().as_str() == "n10")
        .expect("they are neighbours");
    let door = arc
        .door()
        .and_then(|door| site.door(door.as_str()))
        .expect("it has a door");
    assert_eq!(door.joins().map(Symbol::as_str), ["area1", "area3"]);
    assert!(door.is_open_at_first());
}

#[test]
fn the_shortest_way_from_n1_to_n40_begins_with_n6_and_n10() {
    let site = museum();
    let open = |arc: &Passage| {
        let door = arc.door().and_then(|door| site.door(door.as_str()));
        door.is_none_or(Door::is_open_at_first)
    };
    let there = site.route("n1", "n40", open).expect("there is one");
    assert_eq!(there.nodes[..3], ["n1", "n6", "n10"].map(Symbol::from));
    let mut back = site.route("n40", "n1", open).expect("there is one");
    assert_eq!(back.nodes[..2], ["n40", "n35"].map(Symbol::from));
    back.nodes.reverse();
    assert_eq!(there, back);
    assert!((there.length_m - 56.4).abs() < 0.05, "{}", there.length_m);
}

#[test]
fn only_the_staff_door_is_closed() {
    let site = museum();
    let closed: Vec<_> = site
        .doors()
        .filter(|door| !door.is_open_at_first())
        .collect();
    assert_eq!(closed.len(), 1);
    assert_eq!(closed[0].name().as_str(), "door6_8");
}
