//! Reads the setup from the page and applies it.

use leptos::prelude::*;

use motorlink_i18n::tr;

use crate::model::{
    guards::import_blocked_by,
    log_lines,
    page::{Change, Page},
    setup::{Setup, SetupError},
    setup_texts, vehicle,
};

impl Page {
    /// The current setup.
    pub(crate) fn setup(self) -> Setup {
        let preferences = self.preferences.get_untracked();
        Setup {
            model: Some(preferences.model),
            detect_model: Some(preferences.detect_model),
            rate: Some(preferences.rate),
            keep_driving: Some(preferences.keep_driving),
            ramp: u16::try_from(self.settings.ramp.get_untracked()).ok(),
            speed_limit: Some(preferences.limits.speed_rpm()),
            current_limit: Some(preferences.limits.current_ma()),
            temperature_limit: Some(preferences.limits.temperature_c()),
            geometry: Some(vehicle::measures()),
            names: Some(self.motors.names.get_untracked()),
        }
    }

    /// Why no setup can be applied now.
    pub(crate) fn import_refusal(self) -> Option<String> {
        let pad_is_held = self.motors.steered.get_untracked();
        import_blocked_by(&self.present(), pad_is_held).or_else(|| self.side_changes_blocked_by())
    }

    /// Applies a setup completely or not at all. Returns the result in words, which is in the log too.
    pub(crate) fn import_setup(self, read: Result<Setup, SetupError>) -> String {
        // Driving may have begun while the file was chosen and read, or the question was open.
        self.log_setup(match (self.import_refusal(), read) {
            (Some(reason), _) => setup_texts::of_refusal(&reason),
            (None, Ok(setup)) => {
                let words = setup_texts::of_taken(&setup);
                self.take_setup(setup);
                words
            }
            (None, Err(error)) => setup_texts::of_misfit(&error),
        })
    }

    /// Adds the result of an import to the log.
    pub(crate) fn log_setup(self, words: String) -> String {
        self.log_now(&|| log_lines::calm(tr!("Setup: {words}", words)));
        words
    }

    /// Applies a setup. That starts and stops no wheel.
    pub(crate) fn take_setup(self, setup: Setup) {
        if let Some(model) = setup.model {
            let is_other = self.preferences.with_untracked(|chosen| chosen.model) != model;
            // An open line keeps its model if it cannot be opened again now.
            if is_other && !self.choose_model(model) {
                self.prefer(|preferences| preferences.model = model);
            }
        }
        self.prefer(|preferences| {
            preferences.detect_model = setup.detect_model.unwrap_or(preferences.detect_model);
            preferences.keep_driving = setup.keep_driving.unwrap_or(preferences.keep_driving);
        });
        if let Some(rate) = setup.rate {
            let hertz = rate.hertz().into();
            self.settings.rate.set(hertz);
            self.set_rate(hertz);
        }
        if let Some(ramp) = setup.ramp {
            self.settings.ramp.set(ramp.into());
            self.set_ramp();
        }
        let limits = [
            (self.settings.speed_limit, setup.speed_limit),
            (self.settings.current_limit, setup.current_limit),
            (self.settings.temperature_limit, setup.temperature_limit),
        ];
        if limits.iter().any(|(_, limit)| limit.is_some()) {
            for (target, limit) in limits {
                target.set(limit.map_or_else(|| target.get_untracked(), Into::into));
            }
            self.set_limits();
        }
        if let Some(geometry) = setup.geometry {
            vehicle::save(geometry);
            self.announce(Change::Geometry);
        }
        if let Some(names) = setup.names {
            self.replace_names_and_sides(names);
        }
    }
}
