//! The example of `motorlink-bus` drives a virtual motor, through the terminal that it opens by itself.

#[allow(dead_code, reason = "its main() is not called")]
#[path = "../../bus/examples/spin.rs"]
mod spin;

use crate::program::Program;

#[test]
fn the_example_turns_the_wheel_and_stops_it() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("wire.log");
    let program = Program::start(&["--log", log.to_str().unwrap()]);
    spin::spin(program.slave.to_str().unwrap()).unwrap();
    let wire = std::fs::read_to_string(log).unwrap();
    // +50 rpm and no acceleration of its own; and the brake.
    let drives = wire.matches("01 64 00 32 00 00 00 00 00").count();
    let brakes = wire.matches("01 64 00 00 00 00 00 FF 00").count();
    // 50 Hz for two seconds is 100; a busy machine sends fewer.
    assert!(drives >= 50 && brakes >= 3, "{drives} and {brakes}");
}

#[test]
fn the_example_says_that_nobody_answers() {
    let program = Program::start(&["--ids", "2"]);
    let error = spin::spin(program.slave.to_str().unwrap()).unwrap_err();
    assert_eq!(error.to_string(), "no answer");
}
