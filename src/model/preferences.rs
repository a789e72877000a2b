//! The stored preferences. Missing or invalid values have their defaults.

use crate::model::local_storage::{remember, remembered};
use motorlink_messages::{
    ModelChoice, UsbId, VirtualLine,
    bus::{CommandRate, Limits},
    protocol::{MotorId, family::Model},
};
use strum::IntoStaticStr;

/// The colours of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum Theme {
    /// As in the system.
    #[default]
    System,
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
    /// Bright on black, with lines around everything.
    Contrast,
}

impl Theme {
    /// The value of `data-theme`, which is also stored.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.into()
    }

    /// The next theme of the theme button. From the system's theme, the first press changes what is seen.
    #[must_use]
    pub const fn next(self, system_is_dark: bool) -> Self {
        match (self, system_is_dark) {
            (Self::System, false) | (Self::Contrast, true) => Self::Dark,
            (Self::System, true) | (Self::Contrast, false) => Self::Light,
            (Self::Dark, false) | (Self::Light, true) => Self::Contrast,
            (Self::Light, false) | (Self::Dark, true) => Self::System,
        }
    }

    fn from_key(key: &str) -> Option<Self> {
        [Self::System, Self::Light, Self::Dark, Self::Contrast]
            .into_iter()
            .find(|theme| theme.key() == key)
    }
}

/// All preferences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preferences {
    /// The last selected motor.
    pub motor: MotorId,
    /// The model of the motors on the serial port, as chosen or found last.
    pub model: Model,
    /// Whether the worker takes another model if the motors answer as that.
    pub detect_model: bool,
    /// The adapter used last.
    pub adapter: Option<UsbId>,
    /// What the button `Virtual motor` connects.
    pub virtual_line: VirtualLine,
    /// Drive frames a second.
    pub rate: CommandRate,
    /// What a driven motor may reach before it is stopped.
    pub limits: Limits,
    /// The colours.
    pub theme: Theme,
    /// Whether a hidden page goes on driving.
    pub keep_driving: bool,
    /// Whether the packet log hides routine exchanges.
    pub collapse_polls: bool,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            motor: MotorId::FIRST,
            model: Model::default(),
            detect_model: true,
            adapter: None,
            virtual_line: VirtualLine::DEFAULT,
            rate: CommandRate::default(),
            limits: Limits::default(),
            theme: Theme::default(),
            keep_driving: true,
            collapse_polls: true,
        }
    }
}

impl Preferences {
    /// Reads them from a key-value store.
    pub fn from_store(lookup: impl Fn(&str) -> Option<String>) -> Self {
        let default = Self::default();
        let number = |name| lookup(name).and_then(|text| text.parse::<u16>().ok());
        // The default of a switch is on.
        let yes = |name| lookup(name).is_none_or(|text| text != "no");
        Self {
            motor: lookup("motor")
                .and_then(|text| text.parse().ok())
                .unwrap_or(default.motor),
            model: lookup("model")
                .and_then(|text| text.parse().ok())
                .unwrap_or(default.model),
            detect_model: yes("detect-model"),
            adapter: lookup("adapter").and_then(|text| usb_from(&text)),
            virtual_line: number("virtual")
                .and_then(|number| u8::try_from(number).ok())
                .map_or(default.virtual_line, VirtualLine::from),
            rate: number("rate")
                .and_then(|hertz| CommandRate::new(hertz).ok())
                .unwrap_or(default.rate),
            limits: lookup("limits")
                .and_then(|text| limits_from(&text))
                .unwrap_or(default.limits),
            theme: lookup("theme")
                .and_then(|text| Theme::from_key(&text))
                .unwrap_or(default.theme),
            keep_driving: yes("keep-driving"),
            collapse_polls: yes("collapse-polls"),
        }
    }

    /// The keys and values that [`Preferences::from_store`] reads.
    #[must_use]
    pub fn to_store(&self) -> [(&'static str, String); 10] {
        let adapter = self.adapter.map(|usb| usb.to_string());
        let yes = |is| if is { "yes" } else { "no" }.to_owned();
        [
            ("motor", self.motor.get().to_string()),
            ("model", self.model.spec().key.to_owned()),
            ("detect-model", yes(self.detect_model)),
            ("adapter", adapter.unwrap_or_default()),
            ("virtual", u8::from(self.virtual_line).to_string()),
            ("rate", self.rate.hertz().to_string()),
            ("limits", limits_to(self.limits)),
            ("theme", self.theme.key().to_owned()),
            ("keep-driving", yes(self.keep_driving)),
            ("collapse-polls", yes(self.collapse_polls)),
        ]
    }

    /// What the worker is told when a serial port is opened.
    #[must_use]
    pub const fn model_choice(&self) -> ModelChoice {
        ModelChoice {
            model: self.model,
            detect: self.detect_model,
        }
    }

    /// Loads them from the browser's storage.
    #[must_use]
    pub fn load() -> Self {
        Self::from_store(remembered)
    }

    /// Stores them. A browser that cannot store them is not an error.
    pub fn save(&self) {
        for (name, text) in self.to_store() {
            remember(name, &text);
        }
    }
}

/// `330 2700 75`: rpm, mA, degrees Celsius.
fn limits_to(limits: Limits) -> String {
    let [speed, current, temperature]: [u16; 3] = limits.into();
    format!("{speed} {current} {temperature}")
}

fn limits_from(text: &str) -> Option<Limits> {
    let mut numbers = text.split(' ').map(|number| number.parse().ok());
    let mut next = || numbers.next().flatten();
    Limits::new(next()?, next()?, next()?).ok()
}

/// `1a86:7523`
fn usb_from(text: &str) -> Option<UsbId> {
    let (vendor, product) = text.split_once(':')?;
    Some(UsbId {
        vendor: u16::from_str_radix(vendor, 16).ok()?,
        product: u16::from_str_radix(product, 16).ok()?,
    })
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    fn read(store: &HashMap<&str, String>) -> Preferences {
        Preferences::from_store(|name| store.get(name).cloned())
    }

    #[test]
    fn what_is_saved_is_loaded() {
        let chosen = Preferences {
            motor: MotorId::new(7).unwrap(),
            model: Model::Ddsm210,
            detect_model: false,
            adapter: Some(UsbId {
                vendor: 0x0403,
                product: 0x6001,
            }),
            virtual_line: VirtualLine {
                motors: motorlink_messages::VirtualMotors::Four,
                model: Model::Ddsm400,
            },
            rate: CommandRate::new(200).unwrap(),
            limits: Limits::new(120, 1_500, 60).unwrap(),
            theme: Theme::Dark,
            keep_driving: false,
            collapse_polls: false,
        };
        assert_eq!(read(&HashMap::from(chosen.to_store())), chosen);
        let default = Preferences::default();
        assert_eq!(read(&HashMap::from(default.to_store())), default);
    }

    #[test]
    fn garbage_is_nothing_remembered() {
        let garbage = Preferences::default()
            .to_store()
            .map(|(name, _)| (name, "\u{0}rubbish:".to_owned()));
        assert_eq!(read(&HashMap::from(garbage)), Preferences::default());
        assert_eq!(read(&HashMap::new()), Preferences::default());
        let out_of_range = HashMap::from([
            ("motor", "255".into()),
            ("rate", "501".into()),
            ("limits", "999 2700 75".into()),
            ("virtual", "99".into()),
        ]);
        assert_eq!(read(&out_of_range), Preferences::default());
    }

    /// Before there were other models, the page stored the maker's name of a DDSM115.
    #[test]
    fn the_name_that_an_older_page_stored_is_a_ddsm115() {
        let old = HashMap::from([("model", "m0601".into())]);
        assert_eq!(read(&old).model, Model::Ddsm115);
        assert!(read(&old).detect_model);
    }

    #[test]
    fn the_theme_button_shows_every_theme_and_first_the_opposite_of_the_system() {
        let round = |system_is_dark| {
            let mut theme = Theme::System;
            [0; 4].map(|_| {
                theme = theme.next(system_is_dark);
                theme
            })
        };
        let (light, dark) = (Theme::Light, Theme::Dark);
        assert_eq!(round(false), [dark, Theme::Contrast, light, Theme::System]);
        assert_eq!(round(true), [light, Theme::Contrast, dark, Theme::System]);
    }
}
