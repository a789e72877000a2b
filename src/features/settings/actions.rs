//! The setup as a file: given to the person, and taken in as a whole or not at all.

use js_sys::{Array, Uint8Array};
use leptos::prelude::*;
use motorlink_i18n::tr;
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, File};

use crate::{
    features::settings::texts as words,
    model::{
        desk::Desk,
        guards::why_not_import,
        log_lines,
        setup::{SETUP_BYTES_MAX, Setup, SetupError},
        snapshot::Session,
    },
    ui::download::save_blob,
};

/// Under this name the file is saved.
const FILE_NAME: &str = "motorlink-setup.json";

impl Desk {
    /// What stands on the desk now.
    fn setup(self) -> Setup {
        let preferences = self.preferences.get_untracked();
        Setup {
            model: Some(preferences.model),
            rate: Some(preferences.rate),
            keep_driving: Some(preferences.keep_driving),
            ramp: u16::try_from(self.together.ramp.get_untracked()).ok(),
            speed_limit: Some(preferences.limits.speed_rpm()),
            current_limit: Some(preferences.limits.current_ma()),
            temperature_limit: Some(preferences.limits.temperature_c()),
            fleet: Some(self.together.fleet.get_untracked()),
        }
    }

    /// Gives the person the setup as a file.
    pub(crate) fn export_setup(self) {
        let text = Array::of1(&self.setup().to_json().into());
        if let Ok(file) = Blob::new_with_str_sequence(&text) {
            save_blob(&file, FILE_NAME);
        }
    }

    /// Why no file can be taken in now.
    pub(crate) fn why_not_import(self, session: &Session) -> Option<String> {
        why_not_import(session, self.together.driving.get().is_some())
    }

    /// Takes in a file, and says what became of it.
    pub(crate) async fn import_setup(self, file: &File) -> String {
        let words = match read(file).await {
            Some(read) => self.take_file(read),
            None => words::of_refusal(tr!("The file cannot be read. Choose it again.")),
        };
        self.log(self.now(), log_lines::calm(tr!("Setup: {words}", words)));
        words
    }

    fn take_file(self, read: Result<Setup, SetupError>) -> String {
        // Driving may have begun while the file was chosen and read.
        let pad_is_held = self.together.driving.get_untracked().is_some();
        let reason = why_not_import(&self.present(), pad_is_held);
        if let Some(reason) = reason.or_else(|| self.why_not_turn_sides()) {
            return words::of_refusal(&reason);
        }
        match read {
            Ok(setup) => {
                let words = words::of_taken(&setup);
                self.take_setup(setup);
                words
            }
            Err(error) => words::of_misfit(&error),
        }
    }

    /// Nothing of it starts or stops a wheel.
    pub(crate) fn take_setup(self, setup: Setup) {
        self.prefer(|preferences| {
            preferences.model = setup.model.unwrap_or(preferences.model);
            preferences.keep_driving = setup.keep_driving.unwrap_or(preferences.keep_driving);
        });
        if let Some(rate) = setup.rate {
            let hertz = rate.hertz().into();
            self.targets.rate.set(hertz);
            self.set_rate(hertz);
        }
        if let Some(ramp) = setup.ramp {
            self.together.ramp.set(ramp.into());
            self.set_ramp();
        }
        let limits = [
            (self.targets.speed_limit, setup.speed_limit),
            (self.targets.current_limit, setup.current_limit),
            (self.targets.temperature_limit, setup.temperature_limit),
        ];
        if limits.iter().any(|(_, limit)| limit.is_some()) {
            for (target, limit) in limits {
                target.set(limit.map_or_else(|| target.get_untracked(), Into::into));
            }
            self.set_limits();
        }
        if let Some(fleet) = setup.fleet {
            self.replace_fleet(fleet);
        }
    }
}

/// What is in a file; `None` if the browser cannot read it.
async fn read(file: &File) -> Option<Result<Setup, SetupError>> {
    // A film that was chosen by mistake is not loaded first.
    #[allow(clippy::cast_precision_loss, reason = "64 KB")]
    if file.size() > SETUP_BYTES_MAX as f64 {
        return Some(Err(SetupError::TooLarge));
    }
    let bytes = JsFuture::from(file.array_buffer()).await.ok()?;
    Some(Setup::from_json(&Uint8Array::new(&bytes).to_vec()))
}
