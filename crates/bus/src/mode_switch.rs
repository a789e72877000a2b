//! Mode switch: five frames, 20 ms apart, confirmed by replies.

use motorlink_protocol::{Drive, Instant, Mode, Setpoint};

use crate::{
    safety::neutral_between,
    timing::{SWITCH_CONFIRM_MAX, SWITCH_FRAMES, SWITCH_PERIOD},
};

/// A running mode switch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Switch {
    pub(crate) to: Mode,
    pub(crate) began: Instant,
    sent: u8,
    next_frame: Instant,
    /// Whether the last reply since the first frame reports the new loop.
    reported: bool,
    /// For a driven motor: the neutral drive frame during the switch.
    pub(crate) neutral_drive: Option<NeutralDrive>,
    /// Whether the motor was driven when the switch began.
    pub(crate) was_driven: bool,
    /// Setpoint of a drive command that came during the switch.
    pub(crate) queued_setpoint: Option<Setpoint>,
    /// Whether the operator requested the switch. Otherwise the bus enables a motor.
    pub(crate) by_command: bool,
}

/// Neutral drive frames that continue during a switch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NeutralDrive {
    pub(crate) drive: Drive,
    pub(crate) next_frame: Instant,
}

/// Progress of a switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Progress {
    Underway,
    Confirmed,
    Failed,
}

impl Switch {
    /// Starts a switch. `driven_in` is the loop in which the motor is driven, if any.
    pub(crate) fn begin(now: Instant, to: Mode, driven_in: Option<Mode>) -> Self {
        let neutral = driven_in.and_then(|from| neutral_between(from, to));
        Self {
            to,
            began: now,
            sent: 0,
            next_frame: now,
            reported: false,
            neutral_drive: neutral.map(|drive| NeutralDrive {
                drive,
                next_frame: now,
            }),
            was_driven: driven_in.is_some(),
            queued_setpoint: None,
            by_command: true,
        }
    }

    /// Starts a switch without a command, of a motor that is not driven.
    pub(crate) fn without_command(now: Instant, to: Mode) -> Self {
        Self {
            by_command: false,
            ..Self::begin(now, to, None)
        }
    }

    /// Whether its first frame is still to be sent.
    pub(crate) const fn is_unsent(&self) -> bool {
        self.sent == 0
    }

    /// When the next mode switch frame is due; `None` after the last.
    pub(crate) fn next_frame(&self) -> Option<Instant> {
        (self.sent < SWITCH_FRAMES).then_some(self.next_frame)
    }

    pub(crate) fn frame_sent(&mut self, now: Instant) {
        self.sent += 1;
        self.next_frame = now + SWITCH_PERIOD;
    }

    pub(crate) fn record_mode(&mut self, mode: Mode) {
        if self.sent > 0 {
            self.reported = mode == self.to;
        }
    }

    pub(crate) fn progress(&self, now: Instant) -> Progress {
        if self.sent < SWITCH_FRAMES {
            Progress::Underway
        } else if self.reported {
            Progress::Confirmed
        } else if now >= self.fails_at() {
            Progress::Failed
        } else {
            Progress::Underway
        }
    }

    /// When a switch without confirmation fails, after its last frame.
    pub(crate) fn fails_at(&self) -> Instant {
        self.next_frame + SWITCH_CONFIRM_MAX
    }
}
