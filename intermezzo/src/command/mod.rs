//! What each command does.

pub(crate) mod check;
pub(crate) mod control;
pub(crate) mod demo;
pub(crate) mod experiment;
pub(crate) mod files;
pub(crate) mod from_rmf;
pub(crate) mod goal;
pub(crate) mod plan;
pub(crate) mod scale;
pub(crate) mod secure;
pub(crate) mod status;
pub(crate) mod svg;
mod team;
pub(crate) mod up;
pub(crate) mod watch;
