#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| motorlink::fuzzing::setup_file(bytes));
