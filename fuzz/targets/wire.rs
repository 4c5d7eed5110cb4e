//! What agents say to each other and to everybody.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[allow(dead_code, reason = "what users say has a target of their own")]
mod reading;
#[path = "../../agent_link/src/wire/mod.rs"]
#[allow(dead_code, unused_imports, reason = "all of it belongs to agent_link")]
mod wire;

fuzz_target!(|data: &[u8]| {
    reading::from_agents(data);
});
