//! The restaurant of the multitasking paper, as text: part of the program, as the museum is.

/// `map.geojson`.
pub const MAP: &str = include_str!("../restaurant/map.geojson");
/// `node.hddl`, its only level.
pub const DOMAIN: &str = include_str!("../restaurant/node.hddl");
/// `node.toml`.
pub const MODEL: &str = include_str!("../restaurant/node.toml");
/// `room.toml`: who and what is there.
pub const ROOM: &str = include_str!("../restaurant/room.toml");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vocabulary::missing_words;
    use crate::{Site, level_from_texts, whole_node_level};

    #[test]
    fn map_domain_and_execution_model_are_in_order_and_fit() {
        let site = Site::from_text("map.geojson", MAP).expect("the map is in order");
        let level = match level_from_texts(DOMAIN, MODEL, ["node.hddl", "node.toml"]) {
            Ok(level) => level,
            Err(findings) => {
                let lines: Vec<String> = findings.iter().map(ToString::to_string).collect();
                panic!("{}", lines.join("\n"));
            }
        };
        let missing = missing_words(&level.domain, &whole_node_level(&site));
        assert_eq!(missing, [""; 0]);
    }

    #[test]
    fn the_ways_are_as_long_as_the_documented_times_say() {
        let site = Site::from_text("map.geojson", MAP).expect("the map is in order");
        let seconds = |from: &str, to: &str| {
            let both = site.passages().find(|passage| {
                let ends = passage.ends().map(|end| end.as_str());
                ends.contains(&from) && ends.contains(&to)
            });
            both.map(|passage| passage.length_m() / 0.3)
        };
        for (from, to, wanted_s) in [
            ("kitchen", "table1", 40.0),
            ("kitchen", "table2", 48.0),
            ("table1", "table2", 23.0),
        ] {
            let found_s = seconds(from, to).expect("there is a way");
            assert!((found_s - wanted_s).abs() < 1e-9, "{from} {to} {found_s}");
        }
    }
}
