//! The node level: plans over nodes inside an area and instructs the executor
