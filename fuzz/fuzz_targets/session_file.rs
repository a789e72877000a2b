#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| motorlink_fuzz_checks::session_file(bytes));
