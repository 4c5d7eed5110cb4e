//! What a user can measure, each by one command: `intermezzo experiment --help`.
//!
//! Every experiment ends in a [`Report`]: tables that are printed, and written as CSV, JSON and Markdown
//! with pictures beside them.
#![cfg_attr(test, allow(clippy::unwrap_used))]

mod chart;
mod drive;
mod error;
mod machine;
mod onlooker;
mod replanning;
mod report;
mod restaurant;
mod scaling;
mod summary;
mod table;

pub use chart::{Chart, Line};
pub use error::ExperimentError;
pub use machine::machine;
pub use onlooker::Onlooker;
pub use replanning::{PAPER_MACHINE, PAPER_ROWS, PaperRow, replanning};
pub use report::{Report, WriteError};
pub use restaurant::{
    CHANCE, Case, Course, Deed, Noise, NoiseRates, PAPER_WAITS_S, RATIO_BAND, ROOM, Restaurants,
    Team, both_cases, restaurant,
};
pub use scaling::{MeasureMemory, SIZES, Scaling, memory_after_an_interruption, scaling};
pub use summary::Summary;
pub use table::{Cell, Table};
