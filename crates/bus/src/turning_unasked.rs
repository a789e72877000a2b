//! Notices a motor that turns, or draws a current, although nothing here drives it.

use motorlink_protocol::Reply;

use crate::timing::{UNASKED_CALM_REPLIES, UNASKED_CURRENT_RAW, UNASKED_RPM};

/// Whether a motor turns unasked, by its replies.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TurningUnasked {
    /// Calm replies until it counts as calm again.
    calm_replies_left: u8,
}

impl TurningUnasked {
    /// Records a reply of a motor that nothing here drives or stops. The first one that shows motion counts, since the
    /// wheel may be near fingers; a single calm one may be wrong.
    pub(crate) fn record(&mut self, reply: &Reply) {
        if reply.speed.is_none() && reply.current.is_none() {
            return;
        }
        let turns = reply
            .speed
            .is_some_and(|speed| speed.magnitude() >= UNASKED_RPM);
        let draws = reply
            .current
            .is_some_and(|current| current.raw().unsigned_abs() > UNASKED_CURRENT_RAW);
        self.calm_replies_left = if turns || draws {
            UNASKED_CALM_REPLIES
        } else {
            self.calm_replies_left.saturating_sub(1)
        };
    }

    /// The motor is driven or stopped here.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    pub(crate) const fn is_shown(self) -> bool {
        self.calm_replies_left > 0
    }
}
