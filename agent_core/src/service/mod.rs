//! What vehicles do together: tasks that are given to one of them, and facts that all of them know.
//!
//! Two services, after the restaurant paper (section 2.2), each a part of every vehicle and none of
//! them a process of its own:
//!
//! - [`TaskService`]: a task is published by whoever needs it done, and by nobody else decided on.
//!   Vehicles say at what cost they could do it, one of them gets it.
//! - [`StateService`]: facts are told with their source and their age, so what an action protects is
//!   monitored by the eyes of all, and what is not known is asked for.
//!
//! Both are values without clock, randomness or network. They speak [`Message`]s, of which any may
//! be lost, late or repeated: each of them says the whole of something, so that the next one makes
//! up for it.

mod message;
mod state;
mod task;

pub use message::{Award, Bid, Body, Message, Offer, TaskId, Tasks, Told};
pub use state::{Known, StateOutput, StateService};
pub use task::{
    Heard, NewTask, Outcome, Published, Stage, Taken, TaskOutput, TaskService, Times, Unwilling,
};
