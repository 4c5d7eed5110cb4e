//! The area level: plans over areas and instructs a child agent
