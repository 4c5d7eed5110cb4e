//! An execution model beside a domain in which nothing is wrong.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[allow(dead_code, reason = "problems are for plans")]
mod level;

fuzz_target!(|data: &[u8]| {
    let toml = String::from_utf8_lossy(data);
    let names = ["lamps.hddl", "lamps.toml"];
    if let Err(findings) = maps::level_from_texts(level::LEVEL, &toml, names) {
        assert!(!findings.is_empty(), "refused without a finding");
    }
});
