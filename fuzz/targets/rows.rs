//! A row of an agent's journal that says something else than what was written.
#![no_main]

use std::sync::LazyLock;

use agent_core::protocol::Rows;
use libfuzzer_sys::fuzz_target;

#[allow(dead_code, reason = "problems are for plans")]
mod level;
#[allow(dead_code, reason = "files have a target of their own")]
mod memory;

static WRITTEN: LazyLock<Rows> = LazyLock::new(memory::written);

fuzz_target!(|data: &[u8]| {
    memory::recall(&WRITTEN, data);
});
