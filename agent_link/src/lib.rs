//! Everything that waits: the zenoh session and keys, the wire types and the one driver loop.
//!
//! An agent is a value that takes inputs and gives outputs and never waits
//! ([`Machine`](agent_core::protocol::Machine)). Here is what connects such values: [`drive`] is
//! the one loop that they all run in, whatever their level.
//!
//! ```no_run
//! use std::time::Duration;
//! use agent_link::{Clock, Inspect, Keys, Wiring, drive_agent, epoch_now, interrupted, runtime, session};
//! use agent_core::protocol::{Durable, Input, Machine, Output, Reply, Row, Rows, Unreadable};
//! # use agent_core::model::Time;
//! # struct Child;
//! # impl Inspect for Child {}
//! # impl Machine for Child {
//! #     type In = std::convert::Infallible;
//! #     type Out = std::convert::Infallible;
//! #     fn handle(&mut self, _: Time, _: Input<Self::In>) -> Option<Reply> { None }
//! #     fn poll_output(&mut self) -> Option<Output<Self::Out>> { None }
//! #     fn wake_at(&self) -> Option<Time> { None }
//! # }
//! # impl Durable for Child {
//! #     fn write_down(&mut self) -> Vec<Row> { Vec::new() }
//! #     fn recall(&mut self, _: &Rows) -> Result<(), Unreadable> { Ok(()) }
//! # }
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! runtime()?.block_on(async {
//!     let connect = vec!["tcp/127.0.0.1:7447".to_owned()];
//!     let session = session::open(&session::Role::Client { connect }, None).await?;
//!     let keys = Keys::new("museum")?;
//!     let clock = Clock::of_world(&session, &keys, Duration::from_secs(10)).await?;
//!     let wiring = Wiring {
//!         executors: vec!["executor".to_owned()],
//!         ..Wiring::new(&keys, "child", epoch_now())
//!     };
//!     drive_agent(Child, None, wiring, &session, clock, interrupted()).await?;
//!     session::close(session).await;
//!     Ok::<(), Box<dyn std::error::Error>>(())
//! })
//! # }
//! ```
//!
//! What can be relied on:
//!
//! - Instructions, reports and local messages are queries with an acknowledgement: sent until they
//!   are answered, applied once and in order, and a repeated one gets the same answer again. A
//!   process that was replaced by a later one of the same name is refused, and ends.
//! - Facts that nobody ordered are published and numbered; a superior that is new or has missed
//!   one asks for all.
//! - Events, verdicts on plain puts and snapshots are for people, and may be lost on the way.
//! - What users type is limited in size and depth, and what cannot be read is refused with a
//!   reason. It never reaches a machine.
//! - What users send waits in a lane of its own, behind what agents say, and is looked at no more than
//!   so often; emergencies have a rate for each sender and one for all. Whoever asks too much is told.
//! - Nothing but a router listens, and a router only on this machine, unless told otherwise.
//!
//! - With a journal, nothing that depends on what was not written down leaves the process, save what
//!   stops something; so a process that is started again is to its neighbours as one that was slow.
//!   Without one, what was accepted is forgotten when the process ends.
#![cfg_attr(test, allow(clippy::unwrap_used))]

mod channel;
mod client;
mod clock;
mod driver;
mod facts;
mod incoming;
mod inspect;
mod inspect_agent;
mod inspect_alternatives;
mod inspect_vehicle;
mod keys;
mod limit_options;
mod link;
mod mailbox;
mod neighbours;
pub mod options;
mod process;
mod publisher;
mod question;
mod queue;
mod quota;
pub mod registry;
mod role;
pub mod session;
pub mod wire;
mod wiring;
mod writer;

pub use agent_journal as journal;
pub use client::{Client, ClientError, Events};
pub use clock::{Clock, ClockError, ClockService, epoch_now};
pub use driver::{Memory, drive, drive_agent, drive_vehicle};
pub use inspect::{Inspect, View};
pub use keys::{AgentKeys, Keys, NameError};
pub use process::{interrupted, runtime, stdin_ended};
pub use quota::{Limits, Rate};
pub use role::{
    RoleError, drive_agent_in_world, drive_in_world, drive_vehicle_in_world, log_to_stderr,
    run_role,
};
pub use session::Session;
pub use wiring::{LinkError, Wiring, next_epoch};
