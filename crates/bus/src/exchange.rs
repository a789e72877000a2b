//! One request and the window of its reply.

use motorlink_protocol::{Frame, Instant, Layout, MotorId, Request};

use crate::timing::SETTLE;
use motorlink_protocol::FRAME_AIRTIME;
use std::time::Duration;

/// Who has the line.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Line {
    /// Nobody. The last request is remembered, because its echo may still come.
    Free { last: Frame },
    /// A request is on its way or its reply is.
    Busy(Exchange),
}

/// A request that was handed out to be sent, and what is expected of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exchange {
    pub(crate) frame: Frame,
    pub(crate) expects: Expects,
    pub(crate) sent: Instant,
    /// When the line is free again, whatever came.
    pub(crate) window_ends: Instant,
    /// Until when a reply that may be a shifted image is held back.
    pub(crate) held_until: Option<Instant>,
}

/// Which answer ends an exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Expects {
    /// One reply of one motor, in one layout.
    Reply { id: MotorId, layout: Layout },
    /// Replies of everyone; the window is always waited for.
    Everyone,
    /// None: mode switches.
    Nothing,
}

impl Exchange {
    /// An exchange that begins now. `window` is how long a reply may take.
    pub(crate) fn begin(now: Instant, request: &Request, window: Duration) -> Self {
        let expects = match (request.addressee(), request.answered_in()) {
            (Some(id), Some(layout)) => Expects::Reply { id, layout },
            (None, Some(_)) => Expects::Everyone,
            (_, None) => Expects::Nothing,
        };
        let occupied = if expects == Expects::Nothing {
            FRAME_AIRTIME + SETTLE
        } else {
            window
        };
        let window_ends = now + occupied;
        Self {
            frame: request.frame(),
            expects,
            sent: now,
            window_ends,
            held_until: None,
        }
    }

    pub(crate) fn deadline(&self) -> Instant {
        self.held_until
            .map_or(self.window_ends, |held| held.min(self.window_ends))
    }
}
