//! What a user can measure, each by one command: `intermezzo experiment --help`.
//!
//! Every experiment ends in a [`Report`]: tables that are printed, and written as CSV, JSON and Markdown
//! with pictures beside them.
#![cfg_attr(test, allow(clippy::unwrap_used))]

mod chart;
mod machine;
mod report;
mod summary;
mod table;

pub use chart::{Chart, Line};
pub use machine::machine;
pub use report::{Report, WriteError};
pub use summary::Summary;
pub use table::{Cell, Table};
