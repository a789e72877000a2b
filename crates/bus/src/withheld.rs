//! Withholds the frames of a driven motor for a short time.

use std::time::Duration;

use motorlink_protocol::{Instant, Mode, MotorId};

use crate::{
    bus::Bus,
    refusal::Refusal,
    silence::{Silence, Withheld},
};

impl Bus {
    /// Withholds frames of a motor that is driven in the velocity loop, for at most
    /// [`WITHHELD_MAX`](crate::WITHHELD_MAX) in a row. The motor counts as driven meanwhile: stops, the watchdog and,
    /// while queries go on, limits, faults and silence act as always. Then its drive frames go on.
    /// [`Bus::follow_plan`] ends it before.
    ///
    /// # Errors
    /// [`Refusal::NotDriven`], or [`Refusal::PageSilent`]; nothing has changed then.
    pub fn withhold(
        &mut self,
        now: Instant,
        id: MotorId,
        time: Duration,
        withheld: Withheld,
    ) -> Result<(), Refusal> {
        self.begin_call(now);
        if self.watchdog.has_expired() {
            return Err(Refusal::PageSilent);
        }
        let motor = self.motor_mut(id).ok_or(Refusal::NotDriven(id))?;
        let driven = motor.driven_mut().ok_or(Refusal::NotDriven(id))?;
        if driven.goal.mode() != Mode::Velocity {
            return Err(Refusal::NotDriven(id));
        }
        driven.since = driven.silent_from();
        driven.silence = Some(Silence::begin(now, driven.silence, time, withheld));
        motor.next_query = now;
        Ok(())
    }
}
