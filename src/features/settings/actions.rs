//! Exports and imports the setup; an import is applied completely or not at all.

use js_sys::{Array, Uint8Array};
use leptos::prelude::*;
use motorlink_i18n::tr;
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, File};

use crate::{
    features::settings::texts::of_erased,
    model::{
        guards::import_blocked_by,
        log_lines,
        page::{Dialog, Page},
        recorder_texts::no_recorder,
        setup::{SETUP_BYTES_MAX, Setup, SetupError},
        setup_texts,
        snapshot::Session,
    },
    ui::download::save_blob,
};

/// The name of the file.
const FILE_NAME: &str = "motorlink-setup.json";

/// The panel `Settings`.
#[derive(Clone, Copy)]
pub(crate) struct Settings {
    pub(crate) page: Page,
    /// The result of deleting all data.
    pub(crate) erased: RwSignal<&'static str>,
}

impl Settings {
    pub(crate) fn new(page: Page) -> Self {
        Self {
            page,
            erased: RwSignal::new(""),
        }
    }

    /// Exports the setup as a file.
    pub(crate) fn export_setup(self) {
        let text = Array::of1(&self.page.setup().to_json().into());
        if let Ok(file) = Blob::new_with_str_sequence(&text) {
            save_blob(&file, FILE_NAME);
        }
    }

    /// Why no file can be imported now.
    pub(crate) fn import_blocked_by(self, session: &Session) -> Option<String> {
        import_blocked_by(session, self.page.motors.steered.get())
    }

    /// Imports a file, and shows the result.
    pub(crate) async fn import_setup(self, file: &File) -> String {
        match read(file).await {
            Some(read) => self.page.import_setup(read),
            None => self.page.log_setup(setup_texts::of_refusal(tr!(
                "The file cannot be read. Select it again."
            ))),
        }
    }

    /// Why no data can be deleted now; `in_use` is the reason that also prevents an import.
    pub(crate) fn erase_blocked_by(self, in_use: Option<String>) -> Option<String> {
        if !self.page.recorder.alive.get() {
            return Some(no_recorder().to_owned());
        }
        let records = self.page.recorder.recording.with(|status| status.recording);
        let records = records.then(|| tr!("Stop the recording first.").to_owned());
        records.or(in_use)
    }

    pub(crate) fn ask_to_erase(self) {
        self.erased.set("");
        self.page.dialog.set(Some(Dialog::EraseKept));
    }

    /// Handles the result of deleting all data.
    pub(crate) fn was_erased(self, all: bool) {
        self.erased.set(of_erased(all));
        self.page.log_now(&|| log_lines::calm(of_erased(all)));
    }
}

/// The content of a file; `None` if the browser cannot read it.
async fn read(file: &File) -> Option<Result<Setup, SetupError>> {
    // A large file that was chosen by mistake is not loaded.
    #[allow(clippy::cast_precision_loss, reason = "64 KB")]
    if file.size() > SETUP_BYTES_MAX as f64 {
        return Some(Err(SetupError::TooLarge));
    }
    let bytes = JsFuture::from(file.array_buffer()).await.ok()?;
    Some(Setup::from_json(&Uint8Array::new(&bytes).to_vec()))
}
