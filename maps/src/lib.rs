//! Maps and planning domains: the data, and the code that reads and checks them

mod finding;
mod levels;
mod site;

pub use finding::Finding;
pub use levels::{area_level, area_maps, area_start, node_level, node_start, whole_node_level};
pub use site::{Area, Door, Node, Passage, Route, Site, Summary, check_map};
