//! A file that is said to be a journal.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[allow(dead_code, reason = "problems are for plans")]
mod level;
#[allow(dead_code, reason = "rows have a target of their own")]
mod memory;

fuzz_target!(
    // A panic of the database is caught and means that the file is damaged; here it must not abort.
    init: std::panic::set_hook(Box::new(|_| {})),
    |data: &[u8]| {
        memory::open(data);
    }
);
