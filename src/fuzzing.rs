//! What no input may do to what the page reads, however hostile. Each function takes any bytes and panics where a
//! promise is broken.
//!
//! | function | what it reads | what it promises |
//! |---|---|---|
//! | [`raw_editor`] | what a person types as a frame | a frame, or where it is wrong; a frame reads as itself |
//! | [`setup_file`] | a file that a person chooses | a setup that is written as the same, or a refusal in words |
//!
//! `fuzz/` feeds them with what `cargo-fuzz` invents, the tests below with what is kept in `fuzz/corpus`. What the
//! crates read is in `fuzz/checks`.
#![allow(
    clippy::missing_panics_doc,
    reason = "a promise that is broken is told by a panic"
)]

use motorlink_messages::protocol::FRAME_LEN;

use crate::{
    features::raw::editor::{Entered, Outcome},
    model::setup::{SETUP_BYTES_MAX, Setup},
};

/// The editor of frames. What is no text is nothing that a person can type.
pub fn raw_editor(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let entered = Entered::read(text);
    assert!(entered.pieces().len() <= FRAME_LEN + 1);
    match entered.outcome() {
        Outcome::Wrong(place) => assert!(place < entered.pieces().len()),
        Outcome::Frame { frame, .. } => {
            let again = Entered::read(&frame.to_string());
            assert_eq!(again.frame(), Some(frame));
        }
        Outcome::Nothing | Outcome::TooFew(_) | Outcome::LoopMissing => {}
    }
}

/// The reader of setup files.
pub fn setup_file(bytes: &[u8]) {
    match Setup::from_json(bytes) {
        Ok(setup) => {
            let written = setup.to_json();
            assert!(written.len() <= SETUP_BYTES_MAX);
            assert_eq!(Setup::from_json(written.as_bytes()), Ok(setup));
        }
        Err(refusal) => {
            let words = refusal.to_string();
            assert!(!words.is_empty() && words.len() < 1_000, "{words}");
            assert!(!words.contains(char::is_control), "{words}");
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{fs, path::Path};

    use super::*;

    /// Gives every file of a corpus to what reads it. One that is empty would show nothing.
    fn play(corpus: &str, read: fn(&[u8])) {
        let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
        let files = fs::read_dir(dir.join(corpus)).unwrap();
        let played = files
            .map(|file| read(&fs::read(file.unwrap().path()).unwrap()))
            .count();
        assert!(played >= 10, "{corpus} has only {played} files");
    }

    #[test]
    fn what_is_typed_is_a_frame_or_wrong_at_its_byte() {
        play("raw_editor", raw_editor);
    }

    #[test]
    fn a_file_is_a_setup_or_refused_in_words() {
        play("setup_file", setup_file);
    }
}
