//! The official Python reader and the reader of Foxglove read every message. Each message is valid by its schema.
#![cfg(test)]

mod sample;

use std::{
    env,
    ffi::OsString,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use sample::{file_of, lines, records};

/// A session file, removed at the end.
struct File(PathBuf);

impl File {
    /// The file, and how many messages and entries it has.
    fn written(name: &str) -> (Self, [String; 2]) {
        let file = file_of(&records());
        let summary = mcap::Summary::read(&file).unwrap().unwrap();
        let messages = summary.stats.unwrap().message_count;
        let entries = lines(&records()).len();
        let path = env::temp_dir().join(format!("motorlink-{name}-{}.mcap", std::process::id()));
        fs::write(&path, &file).unwrap();
        (Self(path), [messages.to_string(), entries.to_string()])
    }
}

impl Drop for File {
    fn drop(&mut self) {
        fs::remove_file(&self.0).unwrap();
    }
}

/// What `cargo xtask test --only session-readers` sets.
fn set_by_xtask(name: &str) -> OsString {
    env::var_os(name).unwrap_or_else(|| panic!("{name} is not set"))
}

fn script(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests")
        .join(name)
}

#[test]
#[ignore = "needs Python packages: cargo xtask test --only session-readers"]
fn the_official_python_reader_reads_every_message() {
    let (file, counts) = File::written("python");
    let mut python = Command::new(set_by_xtask("MOTORLINK_PYTHON"));
    python.arg(script("python_reader.py")).arg(&file.0);
    assert!(python.args(counts).status().unwrap().success());
}

#[test]
#[ignore = "needs Node.js packages: cargo xtask test --only session-readers"]
fn the_reader_of_foxglove_reads_every_message() {
    let (file, counts) = File::written("foxglove");
    let mut node = Command::new("node");
    node.arg(script("foxglove_reader.mjs"));
    node.arg(set_by_xtask("MOTORLINK_NODE_PACKAGES"))
        .arg(&file.0);
    assert!(node.args(counts).status().unwrap().success());
}
