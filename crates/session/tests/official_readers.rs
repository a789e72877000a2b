//! The official readers, of Python and of Foxglove, read every message, and each is valid by its schema.

use std::{env, ffi::OsStr, fs, process::Command};

use crate::sample::{file_about, lines, records};
use motorlink_messages::{Connection, Update, sessions::Bookmark};
use motorlink_session::{Record, What, copy, open, overview};

/// The records, with what the page showed behind the first.
fn with_states() -> Vec<Record> {
    let mut records = records();
    let first = records[0].clone();
    let update = Update {
        halted: true,
        ..Update::without_motors(first.at, Connection::Disconnected)
    };
    let what = What::State(Box::new(update));
    records.insert(1, Record { what, ..first });
    records
}

/// A session, and its copy with a bookmark.
fn files() -> [Vec<u8>; 2] {
    let rover = r#"{"wheel_radius_mm":50,"track_width_mm":300,"wheels":[{"id":1,"side":"left"},{"id":7,"side":"right"}]}"#;
    let file = file_about(&[("page", "0.1.0"), ("rover", rover)], &with_states());
    let mut source = &file[..];
    let session = open(&mut source).unwrap().unwrap();
    let (overview, _) = overview(&mut source, &session).unwrap();
    let bookmark = Bookmark {
        after_us: 5_000_000,
        text: "gravel starts here".to_owned(),
    };
    let mut with_bookmark = Vec::new();
    copy(&mut source, &session, &overview, &[bookmark], |bytes| {
        with_bookmark.extend(bytes);
    })
    .unwrap();
    [file, with_bookmark]
}

/// Runs a program with the path of each file and the number of its messages.
fn read_by(program: &OsStr, args: &[&OsStr], more: &[String]) {
    for (number, file) in files().iter().enumerate() {
        let summary = mcap::Summary::read(file).unwrap().unwrap();
        let messages = summary.stats.unwrap().message_count;
        let name = program.to_string_lossy().replace(['/', '\\'], "-");
        let name = format!("motorlink-{}-{number}{name}.mcap", std::process::id());
        let path = env::temp_dir().join(name);
        fs::write(&path, file).unwrap();
        let mut command = Command::new(program);
        command.args(args).arg(&path).arg(messages.to_string());
        let status = command.args(more).status();
        fs::remove_file(&path).unwrap();
        assert!(status.unwrap().success());
    }
}

#[test]
#[ignore = "needs Python packages: cargo xtask test --only session-readers"]
fn the_official_python_reader_reads_every_message() {
    let python =
        env::var_os("MOTORLINK_PYTHON").expect("MOTORLINK_PYTHON names a Python with the packages");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/python_reader.py");
    let frames = lines(&records()).len().to_string();
    read_by(&python, &[script.as_ref()], &[frames]);
}

#[test]
#[ignore = "needs npm packages: cargo xtask test --only session-readers"]
fn the_reader_of_foxglove_reads_every_message() {
    let packages = env::var_os("MOTORLINK_FOXGLOVE")
        .expect("MOTORLINK_FOXGLOVE names the folder of the npm packages");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/foxglove_reader.mjs");
    read_by("node".as_ref(), &[script.as_ref(), &packages], &[]);
}
