//! Bad input gets one line on standard error and exit code 2.

use crate::bench::Bench;
/// Asserts exit code 2 and one line that contains `says`.
fn refused(flags: &[&str], says: &str) {
    let output = crate::program::command(flags).output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{flags:?}: {stderr}");
    assert_eq!(stderr.lines().count(), 1, "{flags:?}: {stderr}");
    assert!(stderr.contains(says), "{flags:?}: {stderr}");
    assert!(output.stdout.is_empty(), "{flags:?}");
}

#[test]
fn unknown_flags() {
    refused(&["--frobnicate"], "--frobnicate");
    refused(&["1"], "'1'");
    refused(&["-x"], "-x");
}

#[test]
fn ids_that_no_motor_has() {
    refused(&["--ids", "0"], "use 1 to 254");
    refused(&["--ids", "255"], "use a whole number from 1 to 254");
    refused(&["--ids", "1,0"], "use 1 to 254");
    refused(&["--ids", "one"], "from 1 to 254");
    refused(&["--ids", ""], "from 1 to 254");
    refused(&["--ids", "-1"], "-1");
    refused(&["--ids"], "--ids");
}

#[test]
fn a_motor_that_is_named_twice() {
    for flags in [
        ["--virtual=2", "--id", "1,1", "info"],
        ["--virtual=2", "--id", "2,-2", "stop"],
    ] {
        let output = crate::program::motorlink(&flags).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("is given twice"), "{said}");
    }
}

#[test]
fn models_that_do_not_exist() {
    for model in ["ddsm500", "", "115", "m0602"] {
        refused(
            &["--model", model],
            "no such model: use one of ddsm115, ddsm315, ddsm210, ddsm400",
        );
    }
}

#[test]
fn the_same_id_twice() {
    refused(&["--ids", "1,2,1"], "1 is given twice");
    refused(&["--ids", "16,0x10"], "16 is given twice");
    refused(&["--ids", "1", "--ids", "1"], "1 is given twice");
}

#[test]
fn bad_numbers() {
    refused(&["--turnaround-us", "soon"], "--turnaround-us");
    refused(&["--turnaround-us", "-5"], "-5");
    refused(&["--turnaround-us", "1000001"], "1000000");
    refused(
        &["--when-silent", "turn"],
        "expected `keep`, `coast` or `brake`",
    );
    refused(&["--set-id-frames", "0"], "--set-id-frames");
    refused(&["--load-nm", "NaN"], "0 to 20 N.m");
    refused(&["--load-nm", "heavy"], "0 to 20 N.m");
    refused(&["--temperature", "1e9"], "0 to 200 degrees");
    refused(&["--loss", "1.5"], "from 0 to 1");
    refused(&["--corrupt", "lots"], "from 0 to 1");
    refused(&["--latency-ms", "2000"], "1000");
    refused(&["--seed", "0x"], "--seed");
    refused(&["--seed", "99999999999999999999999"], "--seed");
}

#[test]
fn bad_echoes() {
    for echo in ["half", "cut", "cut:", "cut:0", "cut:10", "cut:x", "whole:3"] {
        refused(&["--echo", echo], "1 to 9 bytes");
    }
}

#[test]
fn a_link_that_exists() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "kept").unwrap();
    refused(&["--link", file.to_str().unwrap()], "exists already");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "kept");

    let dangling = folder.path().join("dangling");
    std::os::unix::fs::symlink("/nowhere", &dangling).unwrap();
    refused(&["--link", dangling.to_str().unwrap()], "exists already");
    refused(
        &["--link", folder.path().to_str().unwrap()],
        "exists already",
    );
}

#[test]
fn paths_that_cannot_be_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("no/such/place");
    refused(&["--link", path.to_str().unwrap()], "--link");
    refused(&["--log", path.to_str().unwrap()], "--log");
    refused(&["--log", folder.path().to_str().unwrap()], "--log");
}

#[test]
fn help_is_no_error() {
    let output = crate::program::command(&["--help"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(
        String::from_utf8(output.stdout)
            .unwrap()
            .contains("--turnaround-us")
    );
}

#[test]
fn a_port_that_is_a_file_or_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("notes");
    std::fs::write(&file, "no port").unwrap();
    for path in [folder.path(), &file] {
        let path = path.to_str().unwrap();
        let output = crate::program::motorlink(&["--port", path, "info"]).output();
        let output = output.unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("not a serial port"), "{said}");
    }
}

#[test]
fn values_that_look_like_flags_or_are_no_numbers() {
    const TIME: &str = "expected 0 to 86400 seconds";
    for (line, says) in [
        ("drive velocity 50 --secs -1", TIME),
        ("drive velocity 50 --secs nan", TIME),
        ("monitor --secs inf", TIME),
        ("record run.mcap --secs -0.5", TIME),
        ("--timeout -1 info", TIME),
        ("drive velocity 50 --rate -1", "1 to 500"),
        ("drive velocity 50 --ramp -5", "1 to 10000"),
        ("monitor --hz -1", "0.001 to 1000"),
        ("drive position -5", "0 to 360"),
        ("drive position nan", "0 to 360"),
        ("drive current inf", "-8 to 8 A"),
        ("drive current much", "expected a number"),
        ("drive velocity nan", "expected a whole number"),
        ("drive velocity --rpm 1.5", "expected a whole number"),
        ("doctor --rpm inf", "expected a whole number"),
        ("set-id --new -1", "from 1 to 254"),
        ("raw -1", "not a byte"),
        ("step to_rpm=nan", "to_rpm: expected a number"),
    ] {
        let arguments: Vec<&str> = ["--virtual"].into_iter().chain(line.split(' ')).collect();
        let output = crate::program::motorlink(&arguments).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}: {said}");
        assert_eq!(said.lines().count(), 1, "{line}: {said}");
        assert!(said.contains(says), "{line}: {said}");
    }
}

/// The reason is said where it happens; the last line does not say it again.
#[test]
fn a_refusal_is_said_once() {
    let line = "--virtual=2 --model ddsm210 drive current 0.1";
    let arguments: Vec<&str> = line.split(' ').collect();
    let output = crate::program::motorlink(&arguments).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    let why = "not done: A DDSM210 has no current loop";
    assert_eq!(said.matches(why).count(), 1, "{said}");
    assert_eq!(said.matches("not done").count(), 1, "{said}");
}

#[test]
fn a_line_on_which_no_motor_answers() {
    let mut bench = Bench::new(&[]);
    bench.motors.command("mute 1 on");
    for line in ["monitor --csv", "drive velocity 50 --secs 1", "info"] {
        let said = bench.run(line);
        assert_eq!(said.code, Some(1), "{line}: {said:?}");
        let begin = "motorlink: no motor answers";
        assert!(said.err.starts_with(begin), "{line}: {said:?}");
        assert_eq!(said.err.lines().count(), 1, "{line}: {said:?}");
    }
}
