//! One vocabulary for parent and child, child and robot, and for any number of storeys between.

mod delivery;
mod event;
mod goal;
mod instruction;
mod machine;

pub use delivery::{Envelope, Inbox, Outbox, Receipt};
pub use event::{Event, Happening, Resumption};
pub use goal::{Command, GoalId, GoalRequest, Rejection, Urgency};
pub use instruction::{ActionId, Answer, Instruction, Report};
pub use machine::{Input, Machine, Output, Reply};
