//! Motors of each model through the terminal.

use std::time::Duration;

use crate::program::{Program, motorlink};
use motorlink_protocol::{
    MotorId, Setpoint, SpeedTarget,
    family::{Mode, Model, Reading, Request},
};

const ONE: MotorId = MotorId::FIRST;

#[test]
fn each_of_four_motors_of_a_model_answers_in_its_own_frames() {
    for model in Model::ALL {
        let program = Program::start(&["--model", model.spec().key, "--ids", "1,2,3,4"]);
        let port = program.port();
        for address in 1..=4 {
            let id = MotorId::new(address).unwrap();
            let reading = port.ask_of(model, Request::Query { id });
            assert_eq!(reading.map(|reading| reading.id()), Some(id), "{model}");
        }
    }
}

#[test]
fn a_motor_at_another_baud_answers_nothing() {
    let program = Program::start(&["--model", "ddsm400"]);
    let port = program.port();
    for (baud, answers) in [
        (115_200, false),
        (38_400, true),
        (9_600, false),
        (38_400, true),
    ] {
        port.set_baud(baud);
        let answer = port.ask_of(Model::Ddsm400, Request::Query { id: ONE });
        assert_eq!(answer.is_some(), answers, "{baud}");
    }
}

#[test]
fn a_ddsm400_turns_once_it_is_enabled_and_switched() {
    let model = Model::Ddsm400;
    let mut program = Program::start(&["--model", "M0603A"]);
    let port = program.port();
    let speed = Setpoint::velocity(SpeedTarget::new(100).unwrap());
    let request = Request::drive(model, ONE, speed);
    let drive = || {
        for _ in 0..30 {
            port.ask_of(model, request).expect("an answer");
            std::thread::sleep(Duration::from_millis(14));
        }
    };
    drive();
    let state = program.command("state 1");
    assert!(state.starts_with("ok 1 rpm=0.00 mode=disabled "), "{state}");
    let enable = Request::Enable { id: ONE, on: true };
    port.ask_of(model, enable).expect("an answer");
    let mode = Mode::Velocity;
    let switch = Request::SwitchMode { id: ONE, mode };
    port.ask_of(model, switch).expect("an answer");
    drive();
    let answer = port.ask_of(model, request);
    assert!(
        matches!(answer, Some(Reading::Drive(reading)) if (950..=1_050).contains(&reading.value)),
        "{answer:?}"
    );
    assert!(program.command("state 1").contains(" mode=velocity "));
}

/// Not every reply of a DDSM210 has the speed, which the position loop needs to begin.
#[test]
fn two_motors_of_each_model_go_to_a_position() {
    for model in Model::ALL {
        let arguments = ["--virtual=2", "--model", model.spec().key];
        let position = ["drive", "position", "90", "--secs", "1"];
        let output = motorlink(&[&arguments[..], &position[..]].concat()).output();
        let output = output.unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{model}: {said}");
    }
}

#[test]
fn so_many_motors_have_the_ids_from_one_on_and_report_all_as_json() {
    let program = Program::start(&["--motors", "3"]);
    let port = program.slave.to_str().unwrap();
    let arguments = ["--port", port, "--id", "1,2,3", "info", "--json"];
    let output = motorlink(&arguments).output().unwrap();
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let all = all.as_array().unwrap();
    assert_eq!(all.len(), 3);
    for motor in all {
        for value in ["speed_rpm", "current_a", "current_raw", "angle_deg"] {
            assert!(motor[value].is_number(), "{value}: {motor}");
        }
    }
}
