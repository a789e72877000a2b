//! A sequence as a file: opened and saved.

use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use motorlink_messages::experiments::sequence::{Sequence, from_csv, text_of};
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, File};

use crate::{
    features::experiments::{
        state::{Draft, Experiments},
        texts,
    },
    ui::download::save_blob,
};

/// Largest file that is read: 10,000 steps with every field are less.
const FILE_BYTES_MAX: f64 = 8e6;

impl Experiments {
    /// Reads a file; a wrong one changes nothing.
    fn open(self, name: &str, bytes: &[u8]) {
        let is_json = name.to_ascii_lowercase().ends_with(".json");
        let read = text_of(bytes).and_then(|text| {
            if is_json {
                Sequence::from_json(&text)
            } else {
                self.fleet
                    .with_untracked(|fleet| from_csv(&text, &fleet.mirrored))
            }
        });
        match read {
            Ok(sequence) => {
                self.load(&sequence);
                self.said.set(tr!("Opened {name}", name = name.to_owned()));
            }
            Err(error) => self.said.set(tr!(
                "{name} was not opened: {reason}. Nothing was changed.",
                name = name.to_owned(),
                reason = texts::refused(&error, None)
            )),
        }
    }

    pub(super) fn open_file(self, file: File) {
        let name = file.name();
        if file.size() > FILE_BYTES_MAX {
            self.said.set(tr!(
                "{name} was not opened: {reason}. Nothing was changed.",
                name,
                reason = tr!("the file is too large for a sequence").to_owned()
            ));
            return;
        }
        spawn_local(async move {
            match JsFuture::from(file.array_buffer()).await {
                Ok(bytes) => self.open(&name, &js_sys::Uint8Array::new(&bytes).to_vec()),
                Err(_) => self
                    .said
                    .set(tr!("The file cannot be read. Select it again.").to_owned()),
            }
        });
    }

    pub(super) fn save(self) {
        let Ok(sequence) = self.draft.with_untracked(Draft::sequence) else {
            return;
        };
        let name = file_name(&sequence.name);
        let bytes = js_sys::Uint8Array::from(sequence.to_json().as_bytes());
        let parts = js_sys::Array::of1(&bytes);
        if let Ok(blob) = Blob::new_with_u8_slice_sequence(&parts) {
            save_blob(&blob, &name);
            self.said.set(tr!("Saved {name}", name));
        }
    }
}

/// `up-and-down.json`
fn file_name(name: &str) -> String {
    let plain = |letter: char| {
        if letter.is_alphanumeric() {
            letter
        } else {
            '-'
        }
    };
    let name: String = name.trim().to_lowercase().chars().map(plain).collect();
    if name.is_empty() {
        "sequence.json".to_owned()
    } else {
        format!("{name}.json")
    }
}
