//! Closing another loop: five frames, 20 ms apart, confirmed by what replies report.

use motorlink_protocol::{Drive, Instant, Mode, Setpoint};

use crate::{
    safety::neutral_between,
    timing::{SWITCH_CONFIRM, SWITCH_FRAMES, SWITCH_PERIOD},
};

/// A mode switch under way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Switch {
    pub(crate) to: Mode,
    pub(crate) began: Instant,
    sent: u8,
    next_frame: Instant,
    /// Whether the last reply since the first frame reports the loop.
    reported: bool,
    /// For a motor that was driven: what goes on being sent, and when next.
    pub(crate) meanwhile: Option<Meanwhile>,
    /// Whether the motor was driven when the switch was asked for.
    pub(crate) was_driven: bool,
    /// What the operator asked for while the switch was under way.
    pub(crate) then: Option<Setpoint>,
}

/// Drive frames that go on during a switch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meanwhile {
    pub(crate) drive: Drive,
    pub(crate) next_frame: Instant,
}

/// How far a switch is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Progress {
    Underway,
    Confirmed,
    Failed,
}

impl Switch {
    /// A switch that begins now. `driven_in` is the loop in which the motor is driven, if it is.
    pub(crate) fn begin(now: Instant, to: Mode, driven_in: Option<Mode>) -> Self {
        let neutral = driven_in.and_then(|from| neutral_between(from, to));
        Self {
            to,
            began: now,
            sent: 0,
            next_frame: now,
            reported: false,
            meanwhile: neutral.map(|drive| Meanwhile {
                drive,
                next_frame: now,
            }),
            was_driven: driven_in.is_some(),
            then: None,
        }
    }

    /// When the next mode switch frame is due; `None` when all were sent.
    pub(crate) fn next_frame(&self) -> Option<Instant> {
        (self.sent < SWITCH_FRAMES).then_some(self.next_frame)
    }

    pub(crate) fn frame_sent(&mut self, now: Instant) {
        self.sent += 1;
        self.next_frame = now + SWITCH_PERIOD;
    }

    pub(crate) fn heard(&mut self, mode: Mode) {
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

    /// When a switch whose frames were all sent is given up.
    pub(crate) fn fails_at(&self) -> Instant {
        self.next_frame + SWITCH_CONFIRM
    }
}
