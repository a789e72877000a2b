//! Plays what is kept in `fuzz/corpus`: frames of real motors and what fuzzing found worth keeping.
#![cfg(test)]

use std::{fs, path::Path};

/// Gives every file of a corpus to what reads it. One that is empty would show nothing.
fn play(corpus: &str, read: fn(&[u8])) {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("../corpus");
    let files = fs::read_dir(dir.join(corpus)).unwrap();
    let played = files
        .map(|file| read(&fs::read(file.unwrap().path()).unwrap()))
        .count();
    assert!(played >= 10, "{corpus} has only {played} files");
}

#[test]
fn frames_are_read_and_written_as_they_were() {
    play("decode", motorlink_fuzz_checks::decode);
}

#[test]
fn behind_any_junk_the_next_good_reply_but_one_is_read() {
    play("resynchronise", motorlink_fuzz_checks::resynchronise);
}

#[test]
fn a_file_is_a_session_or_refused_and_never_read_for_ever() {
    play("session_file", motorlink_fuzz_checks::session_file);
}
