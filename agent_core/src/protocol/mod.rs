//! One vocabulary for parent and child, child and robot, and for any number of storeys between.

mod delivery;
mod durable;
mod event;
mod goal;
mod instruction;
mod machine;
mod station;

pub use delivery::{Envelope, Heard, Inbox, Outbox, Receipt};
pub use durable::{Durable, Ledger, Row, Rows, Unreadable, read_row, read_rows};
pub use event::{Event, Happening, Resumption};
pub use goal::{Command, GoalId, GoalRequest, Rejection, Urgency};
pub use instruction::{ActionId, Answer, Instruction, Report, ReportBody};
pub use machine::{Input, Machine, Output, Reply};
pub use station::{Arrival, Effect, Response, Station, last_epoch};
