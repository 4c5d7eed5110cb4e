//! Agents in a small world, without anything else.

mod confirm;
mod ended;
pub(in crate::agent) mod history;
mod hold;
mod leave;
mod reborn;
mod restart;
mod rig;
mod task_trees;
pub(in crate::agent) mod toy;
mod uncertain;

use rig::{Rig, boss};
