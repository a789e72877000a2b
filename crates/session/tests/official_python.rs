//! The official Python reader reads every message, and each is valid by its schema.
#![cfg(test)]

mod sample;

use std::{env, fs, process::Command};

use sample::{file_of, lines, records};

#[test]
#[ignore = "needs Python packages: cargo xtask test --only session-readers"]
fn the_official_python_reader_reads_every_message() {
    let python =
        env::var_os("MOTORLINK_PYTHON").expect("MOTORLINK_PYTHON names a Python with the packages");
    let file = file_of(&records());
    let summary = mcap::Summary::read(&file).unwrap().unwrap();
    let messages = summary.stats.unwrap().message_count;
    let path = env::temp_dir().join(format!("motorlink-session-{}.mcap", std::process::id()));
    fs::write(&path, &file).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/official_reader.py");
    let status = Command::new(python)
        .arg(script)
        .arg(&path)
        .arg(messages.to_string())
        .arg(lines(&records()).len().to_string())
        .status();
    fs::remove_file(&path).unwrap();
    assert!(status.unwrap().success());
}
