//! See `checks`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../agent_core/tests/corpus/checks.rs"]
#[allow(dead_code, reason = "each target uses its own part")]
mod checks;

fuzz_target!(|data: &[u8]| checks::domain(&String::from_utf8_lossy(data)));
