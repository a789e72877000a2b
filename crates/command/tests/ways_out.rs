//! Every way out of a drive: the motor keeps its last command, and stands nevertheless.

use std::{path::Path, process::Command, thread::sleep, time::Duration};

use rustix::process::Signal;

use crate::bench::{Bench, Said, signal};

#[test]
fn a_signal_stops_the_motor_and_confirms_it() {
    // The last two are Ctrl-Z and Ctrl-\\.
    for end in [
        Signal::INT,
        Signal::TERM,
        Signal::HUP,
        Signal::TSTP,
        Signal::QUIT,
    ] {
        let mut bench = Bench::new(&[]);
        let drive = bench.drive("drive velocity 100", 90.0);
        signal(&drive, end);
        let said = Said::of(drive.wait_with_output().unwrap());
        assert_eq!(said.code, Some(0), "{said:?}");
        assert!(
            said.err.contains("Motor 0x01 stands, confirmed."),
            "{said:?}"
        );
        assert!(bench.stands(), "{end:?}");
    }
}

#[test]
fn the_end_of_the_time_stops_a_mirrored_pair() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let said = bench.run("--id 1,-2 drive velocity 60 --secs 1");
    assert_eq!(said.code, Some(0), "{said:?}");
    let both = "Motor 0x01 stands, confirmed. Motor 0x02 stands, confirmed.";
    assert!(said.err.contains(both), "{said:?}");
    assert!(bench.stands());
}

/// Without it, each later command would look for the motor for seconds, and fail.
#[test]
fn a_motor_that_was_left_driven_and_has_no_power_any_more_is_forgotten_on_request() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let mut drive = bench.drive("--id 1 drive velocity 100", 90.0);
    drive.kill().unwrap();
    drive.wait().unwrap();
    bench.motors.command("power 1 off");
    let said = bench.run("--id 2 info");
    assert!(said.err.contains("motorlink stop --forget"), "{said:?}");
    let said = bench.run("--id 2 stop --forget");
    assert_eq!(said.out.trim(), "no motor was left driven");
    let said = bench.run("stop --forget");
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(said.out.trim(), "forgotten: 0x01");
    let said = bench.run("--id 2 info");
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(!said.err.contains("earlier"), "{said:?}");
    let said = bench.run("stop --forget");
    assert_eq!(said.out.trim(), "no motor was left driven");
}

#[test]
fn what_a_killed_process_left_running_is_stopped_by_the_next_command() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let mut drive = bench.drive("--id 1 drive velocity 100", 90.0);
    drive.kill().unwrap();
    drive.wait().unwrap();
    sleep(Duration::from_millis(300));
    assert!(!bench.stands(), "the motor keeps its last command");
    // The next command asks for another motor.
    let said = bench.run("--id 2 info");
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(
        said.err
            .contains("an earlier program had left motors running. Motor 0x01 stands, confirmed."),
        "{said:?}"
    );
    assert!(bench.stands());
    let said = bench.run("--id 2 info");
    assert!(!said.err.contains("earlier"), "it is forgotten: {said:?}");
}

#[test]
fn a_drive_after_a_killed_one_drives_what_it_names_and_for_its_whole_time() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let mut drive = bench.drive("--id 1,2 drive velocity 100", 90.0);
    drive.kill().unwrap();
    drive.wait().unwrap();
    let said = bench.run("--id 1 drive velocity 50 --secs 1");
    assert_eq!(said.code, Some(0), "{said:?}");
    let one = said.err.lines().last().unwrap();
    assert_eq!(one, "Motor 0x01 stands, confirmed.", "{said:?}");
    // Several answer, and none is named.
    let said = bench.run("drive velocity 50 --secs 1");
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.err.contains("name one"), "{said:?}");
    assert!(bench.stands());
}

#[test]
fn a_left_motor_that_is_silent_does_not_keep_others_from_being_used() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let mut drive = bench.drive("--id 1 drive velocity 100", 90.0);
    drive.kill().unwrap();
    drive.wait().unwrap();
    bench.motors.command("mute 1 on");
    let said = bench.run("--id 2 info");
    assert!(said.out.contains("Motor       0x02"), "{said:?}");
    assert!(!said.err.contains("did not run"), "{said:?}");
    // It is not confirmed, and so not forgotten.
    assert!(said.err.contains("motors 0x01 may turn"), "{said:?}");
    bench.motors.command("mute 1 off");
    let said = bench.run("--id 2 info");
    assert!(
        said.err.contains("Motor 0x01 stands, confirmed."),
        "{said:?}"
    );
    assert!(bench.stands());
}

#[test]
fn a_pipe_that_is_closed_ends_the_command_without_a_panic() {
    let bench = Bench::new(&[]);
    let record = bench.run(&format!("record {} --secs 0.5", bench.file("run.mcap")));
    assert_eq!(record.code, Some(0), "{record:?}");
    let info = format!("session info {}", bench.file("run.mcap"));
    for line in [
        "monitor --json",
        "monitor",
        "monitor --csv",
        "--help",
        &info,
    ] {
        // Closed before the command starts: it must not write before that.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let command = bench.command(line).stdout(writer).spawn().unwrap();
        let said = Said::of(command.wait_with_output().unwrap());
        assert_eq!(said.code, Some(1), "{line}: {said:?}");
        let last = said.err.trim().trim_start_matches("motorlink: ");
        assert_eq!(
            last, "the program that reads the output has ended",
            "{line}"
        );
    }
}

#[test]
fn a_motor_whose_adapter_was_pulled_out_is_stopped_when_it_is_back() {
    let mut bench = Bench::new(&[]);
    let drive = bench.drive("drive velocity 100", 90.0);
    bench.motors.command("unplug");
    sleep(Duration::from_millis(500));
    assert!(!bench.stands(), "the motor keeps its last command");
    bench.motors.command("plug");
    let said = Said::of(drive.wait_with_output().unwrap());
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(
        said.err.contains("the wheels of 0x01 may keep turning"),
        "{said:?}"
    );
    assert!(
        said.err.contains("Motor 0x01 stands, confirmed."),
        "{said:?}"
    );
    assert!(bench.stands());
}

#[test]
fn a_drive_that_ends_while_its_adapter_is_out_says_that_the_wheel_may_turn() {
    let mut bench = Bench::new(&[]);
    let drive = bench.drive("drive velocity 100", 90.0);
    bench.motors.command("unplug");
    sleep(Duration::from_millis(500));
    signal(&drive, Signal::INT);
    let said = Said::of(drive.wait_with_output().unwrap());
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(
        said.err.contains("motors 0x01 may turn: cut their power"),
        "{said:?}"
    );
    bench.motors.command("plug");
    let said = bench.run("info");
    assert!(
        said.err.contains("Motor 0x01 stands, confirmed."),
        "{said:?}"
    );
    assert!(bench.stands());
}

#[test]
fn a_motor_that_loses_its_power_ends_the_drive_with_its_reason() {
    let mut bench = Bench::new(&[]);
    let drive = bench.drive("drive velocity 100", 90.0);
    bench.motors.command("power 1 off");
    let said = Said::of(drive.wait_with_output().unwrap());
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.err.contains("no reply for 200 ms"), "{said:?}");
    assert!(said.err.contains("IS NOT CONFIRMED TO STAND"), "{said:?}");
}

#[test]
fn stop_brakes_a_wheel_that_another_program_left_turning() {
    let mut bench = Bench::new(&[]);
    let mut drive = bench.drive("drive velocity 100", 90.0);
    drive.kill().unwrap();
    drive.wait().unwrap();
    // A computer that does not know of it.
    std::fs::remove_dir_all(bench.folder.path().join("motorlink")).unwrap();
    let said = bench.run("stop");
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(
        said.out.contains("Motor 0x01 stands, confirmed."),
        "{said:?}"
    );
    assert!(bench.stands());
}

#[test]
fn a_second_program_at_the_same_port_is_refused_and_the_first_drives_on() {
    let mut bench = Bench::new(&[]);
    let drive = bench.drive("drive velocity 100", 90.0);
    let said = bench.run("info");
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("in use"), "{said:?}");
    assert!(!bench.stands());
    signal(&drive, Signal::INT);
    let said = Said::of(drive.wait_with_output().unwrap());
    assert!(said.err.contains("stands, confirmed"), "{said:?}");
}

#[test]
fn a_disk_that_is_full_ends_the_recording_and_leaves_nothing_driven() {
    let mut bench = Bench::new(&[]);
    let said = bench.run("monitor --csv /dev/full --secs 5");
    assert_eq!(said.code, Some(2), "{said:?}");
    let last = said.err.lines().last().unwrap();
    assert_eq!(
        last,
        "motorlink: /dev/full: No space left on device (os error 28)"
    );
    // A recording never replaces a file.
    let taken = bench.file("taken.mcap");
    std::fs::write(&taken, "mine").unwrap();
    let said = bench.run(&format!("drive velocity 50 --secs 1 --record {taken}"));
    assert_eq!(said.code, Some(2), "{said:?}");
    assert_eq!(std::fs::read(&taken).unwrap(), b"mine");
    assert!(bench.stands());
}

/// A file that may not grow fails as on a full disk: the first piece of 64 KiB does not fit.
#[test]
fn a_recording_that_fails_during_a_drive_says_so_once() {
    let mut bench = Bench::new(&[]);
    let file = bench.file("drive.mcap");
    let line = format!("drive velocity 50 --rate 500 --secs 60 --record {file}");
    let drive = bench.command(&line);
    let said = Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 16; exec \"$0\" \"$@\""])
        .arg(drive.get_program())
        .args(drive.get_args())
        .env("XDG_STATE_HOME", bench.folder.path())
        .output();
    let said = Said::of(said.unwrap());
    assert_eq!(said.code, Some(2), "{said:?}");
    let said: Vec<&str> = said.err.lines().collect();
    let why = format!("motorlink: {file}: File too large (os error 27)");
    assert_eq!(said, ["Motor 0x01 stands, confirmed.", &why]);
    assert!(bench.stands());
}

#[test]
fn a_recorded_drive_is_a_session_with_its_replies_and_its_stop() {
    let bench = Bench::new(&[]);
    let file = bench.file("drive.mcap");
    let said = bench.run(&format!("drive velocity 50 --secs 1 --record {file}"));
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(Path::new(&file).exists());
    let check = bench.run(&format!("session check {file}"));
    assert_eq!(check.code, Some(0), "{check:?}");
    assert!(check.out.contains("no damage found"), "{check:?}");
    let telemetry = bench.run(&format!("session export {file} --format telemetry"));
    let rows = telemetry.out.lines().count();
    assert!(rows > 30, "{rows} rows");
    let log = bench.run(&format!("session export {file} --format report"));
    assert!(log.out.contains("stands, confirmed"), "{log:?}");
}

#[test]
fn a_group_is_switched_to_its_loop_and_driven_in_it() {
    let bench = Bench::new(&["--ids", "1,2"]);
    let file = bench.file("group.mcap");
    let drive = format!("--id 1,-2 drive current 0.1 --secs 1 --record {file}");
    let said = bench.run(&drive);
    assert_eq!(said.code, Some(0), "{said:?}");
    let rows = bench
        .run(&format!("session export {file} --format telemetry"))
        .out;
    for motor in [",1,Current,", ",2,Current,"] {
        let rows = rows.lines().filter(|row| row.contains(motor)).count();
        assert!(rows > 10, "{rows} rows with {motor}");
    }
    let turned = |line: &&str| line.contains(",2,Current,-1");
    assert!(rows.lines().any(|row| turned(&row)), "{rows}");
}
