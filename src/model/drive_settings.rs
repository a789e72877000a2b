//! Rate, limits and ramp: entered here, stored by the browser, sent to the bus.

use motorlink_messages::bus::Ramp;

use crate::{
    model::{local_storage::remembered, preferences::Preferences},
    ui::target::Target,
};

/// The storage key of the ramp.
pub(crate) const RAMP_STORED_AS: &str = "ramp";

/// The speed of the first start and of the keys F and B: half of the no-load speed.
pub(crate) const FIRST_SPEED_RPM: i32 = 100;

/// The last entered values, always in range.
#[derive(Clone, Copy)]
pub(crate) struct DriveSettings {
    /// Drive frames a second.
    pub(crate) rate: Target,
    /// In rpm a second; 0 is none.
    pub(crate) ramp: Target,
    /// In rpm.
    pub(crate) speed_limit: Target,
    /// In mA.
    pub(crate) current_limit: Target,
    /// In degrees Celsius.
    pub(crate) temperature_limit: Target,
}

impl DriveSettings {
    pub(crate) fn load(preferences: &Preferences) -> Self {
        let ramp = remembered(RAMP_STORED_AS).and_then(|text| text.parse::<u16>().ok());
        Self {
            rate: Target::new(preferences.rate.hertz().into()),
            ramp: Target::new(ramp.unwrap_or_default().min(Ramp::MAX).into()),
            speed_limit: Target::new(preferences.limits.speed_rpm().into()),
            current_limit: Target::new(preferences.limits.current_ma().into()),
            temperature_limit: Target::new(preferences.limits.temperature_c().into()),
        }
    }

    pub(crate) fn entered_ramp(self) -> Option<Ramp> {
        let rpm_a_second = u16::try_from(self.ramp.get_untracked()).ok()?;
        Ramp::new(rpm_a_second).ok()
    }
}
