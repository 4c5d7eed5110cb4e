//! A plan for a small problem, and the same text taken for a domain or a problem by the judge.
#![no_main]

use libfuzzer_sys::fuzz_target;

mod level;

fuzz_target!(|data: &[u8]| {
    let text = String::from_utf8_lossy(data);
    let _ = plan_checker::check(level::LEVEL, level::PROBLEM, &text);
    let _ = plan_checker::check_sequence(level::LEVEL, level::PROBLEM, &text);
    let _ = plan_checker::check(&text, level::PROBLEM, "==>\nroot\n<==");
    let _ = plan_checker::check(level::LEVEL, &text, "==>\nroot\n<==");
});
