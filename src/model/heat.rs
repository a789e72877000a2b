//! How warm a winding is.

use motorlink_messages::protocol::Celsius;
use strum::IntoStaticStr;

/// Above this the winding counts as warm.
pub(crate) const WARM_FROM: u8 = 70;
/// At this temperature the motor's own protection trips: `Fault::OverTemperature`.
pub(crate) const HOT_FROM: u8 = 80;

/// How warm the winding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr)]
#[strum(serialize_all = "snake_case", const_into_str)]
pub(crate) enum Band {
    Normal,
    Warm,
    Hot,
}

impl Band {
    pub(crate) const fn of(temperature: Celsius) -> Self {
        match temperature.degrees() {
            0..WARM_FROM => Self::Normal,
            WARM_FROM..HOT_FROM => Self::Warm,
            HOT_FROM.. => Self::Hot,
        }
    }
}
