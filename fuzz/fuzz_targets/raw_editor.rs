#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| motorlink::fuzzing::raw_editor(bytes));
