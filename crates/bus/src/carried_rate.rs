//! The rate that a line carries, before anything is driven.

use std::time::Duration;

use motorlink_protocol::{Mode, MotorId, family::Model};

use crate::{
    line_load::Load, motor_status::MotorStatus, rate::CommandRate, timing::AMBIGUITY_QUIET,
};

/// Drive frames per second for each driven motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarriedRate {
    /// At most the rate that was asked for.
    pub hertz: f64,
    /// Whether the motors may answer so much faster or slower that it is off by more than a tenth.
    pub is_about: bool,
}

impl CarriedRate {
    /// What a line of motors of this model carries while some are driven in a loop each, by the round trips that were
    /// measured before. `None` before the first reply.
    ///
    /// An idle motor and a driven one take the same time to answer, with one exception: see `may_be_held`. Such a
    /// reply counts as held every second time.
    #[must_use]
    pub fn of(
        model: Model,
        motors: &[MotorStatus],
        driven: &[(MotorId, Mode)],
        rate: CommandRate,
    ) -> Option<Self> {
        let answering = || motors.iter().filter(|motor| !motor.answer.is_silent());
        let round_trips = answering().filter_map(|motor| motor.link.round_trip_us);
        let fastest_us = round_trips.min()?;
        let with = |held: Duration| {
            let mut load = Load::default();
            for motor in answering() {
                let mut asked = driven.iter().filter(|(id, _)| *id == motor.id);
                let mode = asked.next().map(|(_, mode)| *mode);
                let exchange_us = if mode.is_some_and(|mode| may_be_held(model, motor.id, mode)) {
                    u64::from(fastest_us) + u64::try_from(held.as_micros()).unwrap_or_default()
                } else {
                    motor.link.round_trip_us.unwrap_or(fastest_us).into()
                };
                load.asked_us += exchange_us;
                load.driven_us += mode.map_or(0, |_| exchange_us);
            }
            let carried = load.carries(rate);
            let carried = carried.and_then(|carried| u32::try_from(carried).ok());
            carried.map_or(f64::from(rate.hertz()), |carried| {
                f64::from(carried) / 1_000.0
            })
        };
        let [most, hertz, least] = [Duration::ZERO, AMBIGUITY_QUIET / 2, AMBIGUITY_QUIET].map(with);
        let off = (most - hertz).max(hertz - least);
        Some(Self {
            hertz,
            is_about: off > hertz / 10.0,
        })
    }
}

/// Whether replies of this motor may be held back for [`AMBIGUITY_QUIET`]. A reply of a DDSM115 begins with its ID, its loop
/// and the high byte of the current. If ID and loop are the same byte, a current of 0.06 to 0.25 A makes it look like
/// another reply that began one byte later.
fn may_be_held(model: Model, id: MotorId, mode: Mode) -> bool {
    !model.has_separate_frames() && id.get() == mode.byte()
}
