use proptest::prelude::*;

use super::*;

/// JSON that has something to do with a map, and often enough something wrong.
fn json() -> impl Strategy<Value = serde_json::Value> {
    use serde_json::{Value, json};
    let key = prop::sample::select(vec![
        "type",
        "features",
        "doors",
        "areas",
        "properties",
        "geometry",
        "metadata",
        "id",
        "startid",
        "endid",
        "name",
        "area",
        "door",
        "length_m",
        "cost",
        "coordinates",
        "open",
        "rectangle_m",
    ]);
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        (0..5_u64).prop_map(Value::from),
        any::<f64>().prop_map(|number| json!(number)),
        prop::sample::select(vec![
            "FeatureCollection",
            "Feature",
            "Point",
            "LineString",
            "n1",
            "Ä"
        ])
        .prop_map(Value::from),
    ];
    leaf.prop_recursive(5, 40, 6, move |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..5).prop_map(Value::from),
            prop::collection::vec((key.clone(), inner), 0..6).prop_map(|members| members
                .into_iter()
                .map(|(k, v)| (k.to_owned(), v))
                .collect()),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_text_is_too_strange_to_be_answered(text in ".*") {
        let _ = findings(&text);
    }

    #[test]
    fn no_features_are_too_strange_to_be_answered(features in prop::collection::vec(json(), 0..4)) {
        let features: Vec<String> = features.iter().map(ToString::to_string).collect();
        let _ = findings(&with(GATE, &[sound(), features].concat()));
    }

    #[test]
    fn the_museum_with_some_of_its_text_exchanged_is_read_or_refused(
        cuts in prop::collection::vec((0..MUSEUM.len(), 0..12_usize, "[0-9n\",:{}a-]{0,6}"), 1..4),
    ) {
        let mut text = MUSEUM.to_owned();
        for (at, length, insert) in cuts {
            // The museum is ASCII, and so is what is put in.
            let at = at.min(text.len());
            text.replace_range(at..(at + length).min(text.len()), &insert);
        }
        if let Ok(site) = Site::from_text("f", &text) {
            for area in site.areas() {
                prop_assert!(crate::node_level(&site, area.name().as_str()).is_some());
            }
            let _ = crate::area_level(&site);
        }
    }

    #[test]
    fn the_museum_without_some_of_its_lines_is_read_or_refused(
        gone in prop::collection::btree_set(22..188_usize, 1..30),
    ) {
        let lines: Vec<&str> = MUSEUM.lines().collect();
        let kept: Vec<&str> = lines[..lines.len() - 1]
            .iter()
            .enumerate()
            .filter(|(index, _)| !gone.contains(index))
            .map(|(_, line)| *line)
            .collect();
        let text = format!("{}\n]}}", kept.join("\n").trim_end_matches(','));
        if let Ok(site) = Site::from_text("f", &text) {
            let _ = crate::area_level(&site);
            let _ = crate::area_maps(&site);
        }
    }
}
