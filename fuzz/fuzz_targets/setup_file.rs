#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| motorlink_hostile::setup_file(bytes));
