//! What the bus knows of a motor that it drives.

use motorlink_protocol::{Instant, Rpm, Setpoint};

use crate::{angle_estimate::Hold, ramp::Ramped, silence::Silence};

/// An active setpoint of the operator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Driven {
    pub(crate) goal: Setpoint,
    /// When driving began; silence counts from here at the earliest.
    pub(crate) since: Instant,
    pub(crate) next_frame: Instant,
    /// Whether no frame has gone out since the last command.
    pub(crate) is_new: bool,
    /// When the next frame is due without any delay so far.
    pub(crate) on_schedule: Instant,
    /// Since Hold, until a reply within 40 ms refines the angle.
    pub(crate) hold: Option<Hold>,
    /// Number of the group that the motor is driven in.
    pub(crate) group: Option<u32>,
    /// The speed that was sent last.
    pub(crate) ramped: Ramped,
    /// The time without drive frames, until the next one is sent.
    pub(crate) silence: Option<Silence>,
}

impl Driven {
    /// Starts driving, from the present speed of the wheel.
    pub(crate) fn begin(now: Instant, goal: Setpoint, speed: Option<Rpm>) -> Self {
        Self {
            goal,
            since: now,
            next_frame: now,
            is_new: true,
            on_schedule: now,
            hold: None,
            group: None,
            ramped: Ramped::from(now, speed),
            silence: None,
        }
    }

    /// When the next drive frame is due.
    pub(crate) fn frame_due(&self) -> Instant {
        let withheld_until = self.silence.map(Silence::until);
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
            silence.end(now);
        }
    }
}
