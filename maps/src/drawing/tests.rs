use super::*;
use crate::{museum, scaled_map};

fn site(text: &str) -> Site {
    match Site::from_text("map", text) {
        Ok(site) => site,
        Err(findings) => unreachable!("{findings:?}"),
    }
}

/// Two rooms, a door, a way through it; what is `@` in the names of the map is `label`.
fn two_rooms(label: &str, far: &str) -> Site {
    let text = r#"{"type": "FeatureCollection", "name": @, "doors": {"d": {"open": true}}, "features": [
{"type": "Feature", "properties": {"id": 1, "metadata": {"area": "a", "kind": @, "label": @}}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
{"type": "Feature", "properties": {"id": 2, "metadata": {"area": "a"}}, "geometry": {"type": "Point", "coordinates": [0, 3]}},
{"type": "Feature", "properties": {"id": 3, "metadata": {"area": "b"}}, "geometry": {"type": "Point", "coordinates": [FAR, 3]}},
{"type": "Feature", "properties": {"id": 10, "startid": 1, "endid": 2, "cost": 3.0}},
{"type": "Feature", "properties": {"id": 11, "startid": 2, "endid": 1, "cost": 3.0}},
{"type": "Feature", "properties": {"id": 12, "startid": 2, "endid": 3, "cost": 4.0, "metadata": {"door": "d"}}},
{"type": "Feature", "properties": {"id": 13, "startid": 3, "endid": 2, "cost": 4.0, "metadata": {"door": "d"}}}]}"#;
    site(&text.replace('@', label).replace("FAR", far))
}

fn parsed(svg: &str) -> roxmltree::Document<'_> {
    match roxmltree::Document::parse(svg) {
        Ok(document) => document,
        Err(error) => unreachable!("{error}\n{svg}"),
    }
}

/// All texts that are drawn, without those that are shown under the pointer.
fn words_of(svg: &str) -> Vec<String> {
    let document = parsed(svg);
    let texts = document
        .descendants()
        .filter(|node| node.has_tag_name("text"));
    texts
        .filter_map(|node| node.text().map(str::to_owned))
        .collect()
}

/// Where the dot is that says this under the pointer.
fn dot(svg: &str, tip: &str) -> [f64; 2] {
    let document = parsed(svg);
    let dot = document.descendants().find(|node| {
        node.has_tag_name("circle") && node.descendants().any(|inner| inner.text() == Some(tip))
    });
    let dot = dot.expect("the node is drawn");
    ["cx", "cy"].map(|name| {
        dot.attribute(name)
            .and_then(|value| value.parse().ok())
            .expect("a number")
    })
}

#[test]
fn everything_in_the_museum_is_named_in_its_picture() {
    let site = site(museum::MAP);
    let words = words_of(&Picture::default().svg(&site));
    let named = |name: &str| {
        words
            .iter()
            .any(|text| text.split(' ').next() == Some(name))
    };
    let nodes = site.nodes().map(|node| node.name());
    let doors = site.doors().map(|door| door.name());
    for name in nodes
        .chain(doors)
        .chain(site.areas().map(|area| area.name()))
    {
        assert!(named(name.as_str()), "{name} is not in {words:?}");
    }
}

#[test]
fn east_is_right_and_north_is_up() {
    let svg = Picture::default().svg(&two_rooms("\"x\"", "4"));
    let [south, north, east] = ["n1: x (x), a", "n2, a", "n3, b"].map(|tip| dot(&svg, tip));
    assert!(north[1] < south[1] && (north[0] - south[0]).abs() < 0.2);
    assert!(east[0] > north[0] && (north[1] - east[1]).abs() < 0.2);
}

#[test]
fn a_map_is_always_drawn_alike() {
    let text = scaled_map(300, 9);
    let picture = Picture::default();
    assert_eq!(picture.svg(&site(&text)), picture.svg(&site(&text)));
}

#[test]
fn names_that_look_like_markup_stay_names() {
    let evil = r#""</text><script>\"&amp;\u0001\u0000\uffff🛗""#;
    let site = two_rooms(evil, "4");
    let svg = Picture::default().svg(&site);
    let document = parsed(&svg);
    assert!(
        !document
            .descendants()
            .any(|node| node.has_tag_name("script"))
    );
    let title = "</text><script>\"&amp;   🛗";
    assert!(
        words_of(&svg).iter().any(|text| text == title),
        "{:?}",
        words_of(&svg)
    );
}

#[test]
fn a_node_beyond_the_end_of_the_world_is_drawn_at_it() {
    // No passage is as long as that, so it stands alone in a map of one.
    let text = r#"{"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"id": 1, "metadata": {"area": "a"}}, "geometry": {"type": "Point", "coordinates": [1e308, -1e308]}}]}"#;
    let svg = Picture::default().svg(&site(text));
    parsed(&svg);
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}

#[test]
fn a_closed_door_is_drawn_closed_and_the_way_goes_round_it() {
    let site = site(museum::MAP);
    let mut picture = Picture::default();
    let direct = picture
        .find_route(&site, "n1", "n40")
        .expect("there is a way");
    let open = picture.svg(&site);
    picture.doors.insert("door3_5".into(), false);
    let round = picture
        .find_route(&site, "n1", "n40")
        .expect("there is another");
    assert!(round.length_m > direct.length_m);
    let closed = picture.svg(&site);
    assert!(open.contains("door3_5, open") && closed.contains("door3_5, closed"));
    picture.doors.insert("door6_8".into(), true);
    let staff = picture
        .find_route(&site, "n1", "n40")
        .expect("by the staff door");
    assert!(staff.length_m < round.length_m);
}

#[test]
fn a_one_way_passage_has_an_arrow_and_so_has_the_legend() {
    let both = two_rooms("\"x\"", "4");
    let text = r#"{"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"id": 1, "metadata": {"area": "a"}}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
{"type": "Feature", "properties": {"id": 2, "metadata": {"area": "a"}}, "geometry": {"type": "Point", "coordinates": [0, 3]}},
{"type": "Feature", "properties": {"id": 10, "startid": 1, "endid": 2, "cost": 3.0, "metadata": {"name": "there"}}},
{"type": "Feature", "properties": {"id": 11, "startid": 2, "endid": 1, "cost": 3.0, "metadata": {"name": "back"}}}]}"#;
    let arrows = |site: &Site| {
        let svg = Picture::default().svg(site);
        svg.matches("class=\"arrow\"").count()
    };
    assert_eq!([arrows(&both), arrows(&site(text))], [0, 2]);
}

#[test]
fn no_label_lies_on_another_or_on_a_dot() {
    let mut labels = Labels::on(400.0);
    labels.occupy_dot([200.0, 200.0], 5.0);
    let mut found = 0;
    while labels
        .beside([200.0, 200.0], 5.0, "a name", 11.0, f64::INFINITY)
        .is_some()
    {
        found += 1;
    }
    // Right and left, above and below: there is no room for more of them.
    assert!((2..=8).contains(&found), "{found}");
    assert!(
        labels
            .beside(
                [2.0, 2.0],
                5.0,
                "beyond the paper's edge",
                11.0,
                f64::INFINITY
            )
            .is_some_and(|placed| placed.anchor == "start")
    );
}

#[test]
fn neighbouring_areas_have_different_colours() {
    let site = site(&scaled_map(400, 2));
    let colours = ground::colours(&site);
    for door in site.doors() {
        let [one, other] = door.joins();
        assert_ne!(colours[one], colours[other], "{one} and {other}");
    }
}
