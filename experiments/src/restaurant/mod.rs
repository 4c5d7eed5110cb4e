//! The restaurant: several guests at once, by vehicles together or by one alone.

mod team;

pub use team::{ROOM, Team};
