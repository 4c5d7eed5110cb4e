//! See `checks`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../agent_core/tests/corpus/checks.rs"]
#[allow(dead_code, reason = "each target uses its own part")]
mod checks;

static LAMPS: std::sync::LazyLock<agent_core::model::Domain> = std::sync::LazyLock::new(|| {
    agent_core::language::parse_domain(checks::DOMAIN).expect("nothing is wrong with it")
});

fuzz_target!(|data: &[u8]| checks::pieces(&String::from_utf8_lossy(data), &LAMPS));
