//! `motorlink ports` says which motors answered last, without opening the port.

use std::{fs, path::PathBuf};

use rustix::process::Signal;

use crate::{
    bench::{Bench, Said, signal},
    program::motorlink,
};

fn folder(bench: &Bench) -> PathBuf {
    bench.folder.path().join("motorlink/driven")
}

#[test]
fn the_motors_that_answered_last_are_listed_with_their_model_and_the_time_since() {
    let bench = Bench::new(&["--model", "ddsm210", "--ids", "1,2,9"]);
    let before = bench.run("ports --json");
    assert_eq!(before.code, Some(0), "{before:?}");
    assert!(before.out.contains(r#""answered":[]"#), "{before:?}");

    let said = bench.run("--id 1,2 info");
    assert_eq!(said.code, Some(0), "{said:?}");
    let table = bench.run("ports").out;
    let lines: Vec<&str> = table.lines().collect();
    let [port, one, two] = lines.as_slice() else {
        panic!("{table}");
    };
    assert!(port.starts_with(&bench.port()), "{table}");
    for (line, id) in [(one, "0x01"), (two, "0x02")] {
        let begin = format!("    motor {id} (DDSM210) answered ");
        assert!(line.starts_with(&begin), "{table}");
        assert!(line.ends_with(" s ago"), "{table}");
    }

    let said = bench.run("scan");
    assert_eq!(said.code, Some(0), "{said:?}");
    let json = bench.run("ports --json").out;
    for id in [1, 2, 9] {
        let motor = format!(r#"{{"id":{id},"model":"ddsm210","seconds_ago":"#);
        assert!(json.contains(&motor), "{json}");
    }
}

#[test]
fn a_changed_id_replaces_the_one_before() {
    let bench = Bench::new(&[]);
    let said = bench.run("set-id --new 2 --yes");
    assert_eq!(said.code, Some(0), "{said:?}");
    let table = bench.run("ports").out;
    assert!(table.contains("motor 0x02 (DDSM115)"), "{table}");
    assert!(!table.contains("0x01"), "{table}");
}

#[test]
fn motors_that_are_silent_now_stay_the_last_that_answered() {
    let mut bench = Bench::new(&[]);
    assert_eq!(bench.run("info").code, Some(0));
    bench.motors.command("mute 1 on");
    assert_eq!(bench.run("info").code, Some(1));
    let table = bench.run("ports").out;
    assert!(table.contains("motor 0x01 (DDSM115)"), "{table}");
}

#[test]
fn a_disk_that_refuses_the_answers_changes_nothing() {
    let mut bench = Bench::new(&[]);
    assert_eq!(bench.run("info").code, Some(0));
    let files = fs::read_dir(folder(&bench)).unwrap();
    let file = files.map(|file| file.unwrap().path());
    let mut file = file.filter(|file| file.extension().is_some_and(|end| end == "answered"));
    let file = file.next().unwrap();
    // What is in its place cannot be replaced, not even by root.
    fs::remove_file(&file).unwrap();
    fs::create_dir_all(file.join("taken")).unwrap();
    let drive = bench.drive("drive velocity 100", 90.0);
    signal(&drive, Signal::INT);
    let said = Said::of(drive.wait_with_output().unwrap());
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(said.err.trim(), "Motor 0x01 stands, confirmed.");
    assert!(bench.stands());
    let said = bench.run("ports");
    assert_eq!(
        (said.code, said.out.lines().count()),
        (Some(0), 1),
        "{said:?}"
    );
}

#[test]
fn a_port_that_is_not_there_is_named() {
    let ports = motorlink(&["--port", "/dev/nowhere", "ports"]).output();
    let said = Said::of(ports.unwrap());
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.err.contains("/dev/nowhere"), "{said:?}");
}
