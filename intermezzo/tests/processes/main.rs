//! The command as users run it: real processes on this machine, synchronised by what they say.
#![allow(clippy::unwrap_used, clippy::panic)]

mod harness;

mod demo;
mod ending;
mod evening;
mod goals;
mod locked;
mod locked_team;
mod measuring;
mod refusals;
mod restart;
mod side_by_side;
mod supervision;
mod team;
mod typing;
mod zenoh_command;
