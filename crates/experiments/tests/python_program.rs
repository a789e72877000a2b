//! A sequence as a program for the Python package, which runs the same text: `crates/python/tests/test_motorlink.py`.

use motorlink_experiments::{
    generate::{Program, python},
    plan::{Fleet, Plan},
    sequence::Sequence,
};
use motorlink_protocol::MotorId;

const SEQUENCE: &str = r#"{ "motorlink_sequence": 1, "name": "Two \"\"\" wheels", "limits": { "rpm": 200 }, "steps": [
    { "rpm": 60, "shape": "ramp", "for_s": 0.4 },
    { "repeat": 2, "steps": [{ "rpm": 60, "shape": "sine", "amplitude": 20, "hz": 4, "for_s": 0.25 }] }] }"#;

#[test]
fn a_python_program_has_the_sequence_the_motors_and_what_moves() {
    let second = MotorId::new(2).unwrap();
    let mut fleet = Fleet::of([MotorId::FIRST, second]);
    fleet.mirrored = vec![second];
    let sequence = Sequence::from_json(SEQUENCE).unwrap();
    let program = python(&Program {
        plan: &Plan::new(&sequence, &fleet).unwrap(),
        sequence: &sequence,
        port: "/dev/ttyUSB0",
    });
    let expected = include_str!("../../python/tests/generated.py");
    assert_eq!(program, expected);
    // A text of the sequence does not end the string that holds it.
    assert!(program.contains(r#"Two \"\"\" wheels"#));
}
