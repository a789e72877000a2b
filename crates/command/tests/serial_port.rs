//! A serial program drives virtual motors through the terminal.

use std::{fs, os::unix::fs::symlink, time::Duration};

use crate::program::{Port, Program};
use motorlink_protocol::{MotorId, Request, Setpoint, SpeedTarget};
use rustix::process::Signal;

const ONE: MotorId = MotorId::FIRST;
const QUERY: Request = Request::Query { id: ONE };

fn ms(millis: u64) -> Duration {
    Duration::from_millis(millis)
}

fn drive(rpm: i32) -> Request {
    Request::drive(ONE, Setpoint::velocity(SpeedTarget::new(rpm).unwrap()))
}

/// Drives for about so many frames of 20 ms; gives the last reported speed.
fn drive_for(port: &Port, rpm: i32, frames: usize) -> i16 {
    let mut reported = 0;
    for _ in 0..frames {
        reported = port
            .ask(drive(rpm))
            .expect("an answer")
            .speed
            .unwrap()
            .rpm();
        std::thread::sleep(ms(17));
    }
    reported
}

#[test]
fn a_serial_program_turns_the_wheel_and_stops_it() {
    let program = Program::start(&[]);
    let port = program.port();
    let reported = drive_for(&port, 100, 50);
    assert!((95..=105).contains(&reported), "{reported}");
    let reported = drive_for(&port, 0, 40);
    assert_eq!(reported, 0);
}

#[test]
fn a_reply_comes_as_one_read_and_no_sooner_than_on_a_wire() {
    let program = Program::start(&[]);
    let port = program.port();
    for _ in 0..20 {
        let began = std::time::Instant::now();
        port.write(QUERY.frame().bytes());
        assert_eq!(port.read(1, ms(500)).len(), 10);
        assert!(
            began.elapsed() >= Duration::from_micros(2300),
            "{:?}",
            began.elapsed()
        );
    }
}

#[test]
fn the_host_may_close_and_open_again() {
    let program = Program::start(&[]);
    for _ in 0..5 {
        assert!(program.port().ask(QUERY).is_some());
    }
}

#[test]
fn commands_change_the_world() {
    let mut program = Program::start(&["--ids", "1,0x02"]);
    let port = program.port();
    assert_eq!(program.command("mute 1 on"), "ok 1 mute on");
    assert!(port.ask(QUERY).is_none());
    assert_eq!(program.command("mute 1 off"), "ok 1 mute off");
    assert!(port.ask(QUERY).is_some());
    assert_eq!(program.command("block 1 on"), "ok 1 block on");
    assert_eq!(drive_for(&port, 100, 20), 0);
    assert!(
        program
            .command("state 1")
            .starts_with("ok 1 rpm=0.00 mode=velocity angle=")
    );
    assert!(program.command("state 3").starts_with("error: "));
    assert!(program.command("dance").starts_with("error: "));
    assert!(program.command("state 2").starts_with("ok 2 "));
}

#[test]
fn motors_whose_frames_cease_do_what_the_command_line_says() {
    let rpm_of = |state: &str| -> f32 {
        let (_, rest) = state.split_once("rpm=").expect("a speed");
        let (rpm, _) = rest.split_once(' ').expect("more");
        rpm.parse().expect("a number")
    };
    let cases: [(&[&str], bool, std::ops::Range<f32>); 4] = [
        (&[], true, 95.0..105.0),
        (&["--when-silent", "keep"], true, 95.0..105.0),
        (&["--when-silent", "coast"], false, 50.0..97.0),
        (&["--when-silent", "brake"], false, -0.1..0.1),
    ];
    for (arguments, driven, rpm) in cases {
        let mut program = Program::start(arguments);
        drive_for(&program.port(), 100, 50);
        std::thread::sleep(ms(800));
        let state = program.command("state 1");
        assert!(rpm.contains(&rpm_of(&state)), "{arguments:?}: {state}");
        let said = format!("driven={driven} ");
        assert!(state.contains(&said), "{arguments:?}: {state}");
    }
}

#[test]
fn a_stalled_adapter_passes_nothing_either_way_and_then_all_of_it() {
    let mut program = Program::start(&["--turnaround-us", "5000"]);
    let port = program.port();
    assert!(port.ask(QUERY).is_some());
    assert_eq!(program.command("stall 300"), "ok stall 300");
    let began = std::time::Instant::now();
    port.write(QUERY.frame().bytes());
    std::thread::sleep(ms(50));
    port.write(QUERY.frame().bytes());
    assert!(port.read(10, ms(100)).is_empty());
    // The second frame follows the first at once, and has passed before the first is answered.
    assert_eq!(port.read(20, ms(2000)).len(), 20);
    assert!(began.elapsed() >= ms(280), "{:?}", began.elapsed());
    assert!(port.ask(QUERY).is_some());
}

#[test]
fn the_end_of_standard_input_is_not_the_end() {
    let mut program = Program::start(&[]);
    program.close_stdin();
    std::thread::sleep(ms(50));
    assert!(program.port().ask(QUERY).is_some());
}

#[test]
fn the_link_comes_and_goes_with_the_program() {
    for signal in [Signal::TERM, Signal::INT, Signal::HUP] {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("port");
        let mut program = Program::start(&["--link", link.to_str().unwrap()]);
        assert_eq!(fs::read_link(&link).unwrap(), program.slave);
        assert!(Port::open(&link).ask(QUERY).is_some());
        assert_eq!(program.end_by(signal), Some(0));
        assert!(
            fs::symlink_metadata(&link).is_err(),
            "{signal:?} left it behind"
        );
    }
}

#[test]
fn a_link_that_is_another_ones_by_now_stays() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("port");
    let mut program = Program::start(&["--link", link.to_str().unwrap()]);
    fs::remove_file(&link).unwrap();
    symlink("/dev/null", &link).unwrap();
    program.end_by(Signal::TERM);
    assert!(link.exists());
}

#[test]
fn the_log_has_every_frame_as_it_happens() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("wire.log");
    let program = Program::start(&["--log", log.to_str().unwrap(), "--turnaround-us", "900"]);
    let port = program.port();
    assert!(port.ask(QUERY).is_some());
    assert!(port.ask(QUERY).is_some());

    let text = fs::read_to_string(&log).unwrap();
    let lines: Vec<Vec<&str>> = text
        .lines()
        .map(|line| line.split('\t').collect())
        .collect();
    let from: Vec<&str> = lines.iter().map(|line| line[1]).collect();
    assert_eq!(from, ["HOST", "MOTOR", "HOST", "MOTOR"]);
    assert_eq!(lines[0][2], "01 74 00 00 00 00 00 00 00 04");
    assert!(lines[1][2].starts_with("01 02 "));
    let times: Vec<u64> = lines.iter().map(|line| line[0].parse().unwrap()).collect();
    assert_eq!(times[1] - times[0], 868 + 900);
    assert!(times.is_sorted());
}

#[test]
fn an_echo_and_a_temperature_are_flags() {
    let program = Program::start(&["--echo", "cut:3", "--temperature", "61", "--seed", "7"]);
    let port = program.port();
    port.write(QUERY.frame().bytes());
    let received = port.read(13, ms(500));
    assert_eq!(received[..3], [0x01, 0x74, 0x00]);
    assert_eq!(received[9], 61);
}

#[test]
fn a_holding_adapter_is_late() {
    let program = Program::start(&["--latency-ms", "16"]);
    let began = std::time::Instant::now();
    assert!(program.port().ask(QUERY).is_some());
    assert!(began.elapsed() >= ms(18), "{:?}", began.elapsed());
}

#[test]
fn a_wire_that_loses_everything_is_silent() {
    let program = Program::start(&["--loss", "1"]);
    assert!(program.port().ask(QUERY).is_none());
}

/// Hundredths of a second from `/proc`: the program sleeps while the line is idle.
#[test]
fn an_idle_program_takes_no_time() {
    let program = Program::start(&[]);
    assert!(program.port().ask(QUERY).is_some());
    let stat = format!("/proc/{}/stat", program.child.id());
    let ticks = || -> u64 {
        let text = fs::read_to_string(&stat).unwrap();
        let fields: Vec<&str> = text.split_whitespace().collect();
        fields[13].parse::<u64>().unwrap() + fields[14].parse::<u64>().unwrap()
    };
    let before = ticks();
    std::thread::sleep(ms(500));
    assert!(ticks() - before <= 1);
}
