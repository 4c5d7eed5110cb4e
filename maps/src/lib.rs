//! Maps and planning domains: the data, and the code that reads and checks them

mod domain;
mod drawing;
mod execution_model;
mod finding;
mod fingerprint;
mod levels;
pub mod museum;
mod place;
pub mod restaurant;
mod rmf;
mod scaled;
mod site;
mod vocabulary;

pub use domain::{Level, check_domain_dir, level_from_texts, read_level};
pub use drawing::Picture;
pub use finding::Finding;
pub use levels::{
    AreaMaps, area_level, area_maps, area_start, node_level, node_start, whole_node_level,
};
pub use place::{NotInOrder, Place};
pub use restaurant::Restaurant;
pub use rmf::{AreasBy, FromRmf, RmfOptions, from_rmf};
pub use scaled::{MOST_NODES, scaled_map};
pub use site::{Area, Door, Node, Passage, Route, Site, Summary, check_map};
