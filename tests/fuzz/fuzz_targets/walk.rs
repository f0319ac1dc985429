//! One of the entry points, fed by libFuzzer.
#![no_main]

#[allow(dead_code, reason = "one target uses one of them")]
#[path = "../../entry_points.rs"]
mod entry_points;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entry_points::walk(bytes));
