//! Withholds the frames of a driven motor for a short time, to measure what its firmware does then.

use std::time::Duration;

use motorlink_protocol::{Instant, Mode, MotorId};

use crate::{
    bus::Bus,
    command::Refusal,
    motor::{Control, Driven, Motor},
};

/// Frames are withheld for no longer than this in a row: the measurement needs 0.8 s, and the wheel may keep turning
/// meanwhile.
pub const WITHHELD_MAX: Duration = Duration::from_secs(1);

/// Which frames are withheld.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Withheld {
    /// The drive frames of the motor. It is queried at the rate of its drive frames instead.
    DriveFrames,
    /// Its drive frames, and all queries on the line.
    Requests,
}

/// A time without drive frames.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Silence {
    withheld: Withheld,
    /// When the first of the frames would have been due that have been withheld in a row.
    since: Instant,
    until: Instant,
}

impl Bus {
    /// Withholds frames of a motor that is driven in the velocity loop, for at most [`WITHHELD_MAX`] in a row. The motor
    /// counts as driven meanwhile: stops, the watchdog and, while queries go on, limits, faults and silence act as
    /// always. Then its drive frames go on. [`Bus::follow_plan`] ends it before.
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
        let since = driven.silence.map_or(now, |silence| silence.since);
        driven.since = driven.silent_from();
        driven.silence = Some(Silence {
            withheld,
            since,
            until: (now + time).min(since + WITHHELD_MAX),
        });
        motor.next_query = now;
        Ok(())
    }
}

impl Driven {
    /// When the next drive frame is due.
    pub(crate) fn frame_due(&self) -> Instant {
        let withheld_until = self.silence.map(|silence| silence.until);
        withheld_until.map_or(self.next_frame, |until| until.max(self.next_frame))
    }

    /// Since when silence of the motor counts, at the earliest: without requests it has nothing to answer.
    pub(crate) fn silent_from(&self) -> Instant {
        let unasked_until = self.silence.and_then(Silence::unasked_until);
        unasked_until.map_or(self.since, |until| until.max(self.since))
    }

    /// Ends a time without drive frames.
    pub(crate) fn end_silence(&mut self, now: Instant) {
        if let Some(silence) = &mut self.silence {
            silence.until = silence.until.min(now);
        }
    }
}

impl Silence {
    fn unasked_until(self) -> Option<Instant> {
        (self.withheld == Withheld::Requests).then_some(self.until)
    }
}

impl Motor {
    /// Whether its drive frames are withheld now.
    pub(crate) fn is_withheld(&self, now: Instant) -> bool {
        let silence = match self.control {
            Control::Driven(driven) => driven.silence,
            _ => None,
        };
        silence.is_some_and(|silence| now < silence.until)
    }
}

/// Until when the line carries no query.
pub(crate) fn unasked_until(motors: &[Motor]) -> Option<Instant> {
    let silences = motors.iter().filter_map(|motor| match motor.control {
        Control::Driven(driven) => driven.silence,
        _ => None,
    });
    silences.filter_map(Silence::unasked_until).max()
}
