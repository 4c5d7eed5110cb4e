//! The museum, as part of the program, so that a demonstration needs no folder.

/// The files of the place and their texts, as they stand in `maps/museum`.
pub const FILES: [(&str, &str); 5] = [
    ("map.geojson", MAP),
    ("area.hddl", AREA_DOMAIN),
    ("area.toml", AREA_MODEL),
    ("node.hddl", NODE_DOMAIN),
    ("node.toml", NODE_MODEL),
];

/// The map.
pub const MAP: &str = include_str!("../museum/map.geojson");
/// The domain of the area level.
pub const AREA_DOMAIN: &str = include_str!("../museum/area.hddl");
/// The execution model of the area level.
pub const AREA_MODEL: &str = include_str!("../museum/area.toml");
/// The domain of the node level.
pub const NODE_DOMAIN: &str = include_str!("../museum/node.hddl");
/// The execution model of the node level.
pub const NODE_MODEL: &str = include_str!("../museum/node.toml");
