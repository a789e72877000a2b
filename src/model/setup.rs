//! The setup: the names and sides of the motors, and the drive settings. Stored in the browser, and exported and imported as one JSON
//! file.
//!
//! | field | what it is | allowed |
//! |---|---|---|
//! | `motorlink_setup` | the version of this table; must be there | 1 |
//! | `model` | the motor's model | `"ddsm115"`, `"ddsm315"`, `"ddsm210"`, `"ddsm400"`, or the maker's name, such as `"m0601"` |
//! | `detect_model` | whether another model is taken if the motors answer as that | `true`, `false` |
//! | `command_rate_hz` | drive frames a second | 1 to 500 |
//! | `keep_driving_while_hidden` | whether a hidden page goes on driving | `true`, `false` |
//! | `ramp_rpm_per_s` | by how much a commanded speed may grow in a second | 0 (no ramp) to 10000 |
//! | `speed_limit_rpm` | the speed at which a driven motor is stopped | 1 to 380 |
//! | `current_limit_ma` | the current, for half a second | 100 to 8000 |
//! | `temperature_limit_c` | the temperature | 30 to 80 |
//! | `vehicle` | the measures of the vehicle, in mm | both of its fields |
//! | `vehicle.wheel_radius_mm` | from the axle to the ground | 10 to 500 |
//! | `vehicle.track_width_mm` | between the middles of the left and the right wheels | 50 to 3000 |
//! | `motors` | the motors, in any order | a list, each ID once |
//! | `motors[].id` | must be there | 1 to 254 |
//! | `motors[].name` | empty where it is left out | at most 16 characters, no control characters |
//! | `motors[].side` | `"none"` where it is left out | `"none"`, `"left"`, `"right"` |
//! | `motors[].drives_together` | `false` where it is left out | `true`, `false` |
//! | `motors[].when_frames_cease` | not tested where it is left out | `"keeps"`, `"coasts"`, `"brakes"` |
//!
//! A missing field at the top level leaves its setting unchanged. Any other field, and any field twice, is
//! refused, because a page must not silently ignore what it does not know. The file is UTF-8 and has at most
//! [`SETUP_BYTES_MAX`] bytes.
//!
//! Theme, adapter, selected motor and log filters are personal, and not part of it.

mod error;
mod reading;

use motorlink_messages::{
    bus::CommandRate,
    experiments::vehicle::Geometry,
    protocol::{MotorId, family::Model},
};

pub use self::error::{Allowed, Misfit, SETUP_BYTES_MAX, SetupError};
use crate::model::names_and_sides::{NameAndSide, NamesAndSides};

/// The version of the table above. A field may be added to a version only if pages that do not know it may
/// refuse the file.
const VERSION: u16 = 1;

/// The settings that a file has.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Setup {
    pub(crate) model: Option<Model>,
    pub(crate) detect_model: Option<bool>,
    pub(crate) rate: Option<CommandRate>,
    pub(crate) keep_driving: Option<bool>,
    /// In rpm a second, up to [`motorlink_messages::bus::Ramp::MAX`]; 0 is none.
    pub(crate) ramp: Option<u16>,
    /// In rpm, in the range of [`motorlink_messages::bus::Limits`], as the next two.
    pub(crate) speed_limit: Option<u16>,
    /// In mA.
    pub(crate) current_limit: Option<u16>,
    /// In degrees Celsius.
    pub(crate) temperature_limit: Option<u16>,
    pub(crate) geometry: Option<Geometry>,
    pub(crate) names: Option<NamesAndSides>,
}

impl Setup {
    /// Reads a complete file before any of it is applied.
    ///
    /// # Errors
    /// [`SetupError`] names the place that does not fit, and what is allowed there.
    pub fn from_json(file: &[u8]) -> Result<Self, SetupError> {
        reading::read(file)
    }

    /// The file, one line per motor.
    #[must_use]
    pub fn to_json(&self) -> String {
        let whole = |value: Option<u16>| value.map(|value| value.to_string());
        let yes = |value: Option<bool>| value.map(|value| value.to_string());
        let fields = [
            ("model", self.model.map(|model| quoted(model.spec().key))),
            ("detect_model", yes(self.detect_model)),
            ("command_rate_hz", whole(self.rate.map(CommandRate::hertz))),
            ("keep_driving_while_hidden", yes(self.keep_driving)),
            ("ramp_rpm_per_s", whole(self.ramp)),
            ("speed_limit_rpm", whole(self.speed_limit)),
            ("current_limit_ma", whole(self.current_limit)),
            ("temperature_limit_c", whole(self.temperature_limit)),
            ("vehicle", self.geometry.map(vehicle)),
            ("motors", self.names.as_ref().map(motors)),
        ];
        let mut text = format!("{{\n  \"motorlink_setup\": {VERSION}");
        for (name, value) in fields {
            if let Some(value) = value {
                for part in [",\n  ", &quoted(name), ": ", &value] {
                    text.push_str(part);
                }
            }
        }
        text.push_str("\n}\n");
        text
    }
}

fn quoted(key: &str) -> String {
    ["\"", key, "\""].concat()
}

fn vehicle(geometry: Geometry) -> String {
    let [radius, track] = geometry.entered();
    format!("{{ \"wheel_radius_mm\": {radius}, \"track_width_mm\": {track} }}")
}

fn motors(names: &NamesAndSides) -> String {
    let motor = |(id, member): &(MotorId, NameAndSide)| {
        let when_silent = member.when_silent.map(|it| {
            let key = it.key();
            format!(", \"when_frames_cease\": \"{key}\"")
        });
        format!(
            "\n    {{ \"id\": {}, \"name\": {}, \"side\": \"{}\", \"drives_together\": {}{} }}",
            id.get(),
            nojson::Json(member.name().trim()),
            member.side.key(),
            member.drives,
            when_silent.unwrap_or_default()
        )
    };
    let motors: Vec<String> = names.members().map(motor).collect();
    ["[", &motors.join(","), "\n  ]"].concat()
}

// proptest needs a source of randomness, which the browser build lacks.
#[cfg(test)]
#[cfg(not(target_arch = "wasm32"))]
#[path = "setup_tests.rs"]
pub(crate) mod tests;
