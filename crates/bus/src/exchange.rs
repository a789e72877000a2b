//! One request and the window of its reply.

use std::time::Duration;

use motorlink_protocol::{FRAME_AIRTIME, Frame, Instant, Layout, MotorId, Request};

use crate::{raw::frame::addressee, timing::SETTLE};

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
    pub(crate) purpose: Purpose,
    pub(crate) sent: Instant,
    /// When the line is free again, whatever came.
    pub(crate) window_ends: Instant,
    /// Until when a reply that may be a shifted image is held back.
    pub(crate) held_until: Option<Instant>,
    /// When the last byte came.
    pub(crate) last_byte: Option<Instant>,
}

/// Whose exchange it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Driving, stopping, switching, telemetry.
    Control,
    /// A scan or an ID change.
    Survey,
    /// A frame that a person wrote.
    Raw,
    /// None: the line is left alone.
    Pause,
}

/// Which answer ends an exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Expects {
    /// One reply of one motor, in one layout.
    Reply { id: MotorId, layout: Layout },
    /// Replies of everyone; the window is always waited for.
    Everyone {
        /// `None` where it is not known what was asked.
        layout: Option<Layout>,
    },
    /// None: mode switches and set ID.
    Nothing,
}

impl Expects {
    /// The answer to a request.
    pub(crate) fn of(request: &Request) -> Self {
        match (request.addressee(), request.answered_in()) {
            (Some(id), Some(layout)) => Self::Reply { id, layout },
            (None, layout @ Some(_)) => Self::Everyone { layout },
            (_, None) => Self::Nothing,
        }
    }

    /// The answer to a frame that a person wrote. What nobody can read, somebody may answer, and so may
    /// all whom a drive frame without one addressee reaches.
    pub(crate) fn of_raw(frame: &Frame) -> Self {
        match Request::parse(frame) {
            Ok(Request::Drive { .. }) if addressee(frame).is_none() => {
                Self::Everyone { layout: None }
            }
            Ok(request) => Self::of(&request),
            Err(_) => Self::Everyone { layout: None },
        }
    }
}

impl Exchange {
    /// An exchange that begins now. `window` is how long a reply may take.
    pub(crate) fn begin(
        now: Instant,
        frame: Frame,
        expects: Expects,
        window: Duration,
        purpose: Purpose,
    ) -> Self {
        let occupied = if expects == Expects::Nothing {
            FRAME_AIRTIME + SETTLE
        } else {
            window
        };
        Self {
            frame,
            expects,
            purpose,
            sent: now,
            window_ends: now + occupied,
            held_until: None,
            last_byte: None,
        }
    }

    /// The line is left alone until a moment. This frame was sent last, or was to be.
    pub(crate) fn pause(now: Instant, frame: Frame, until: Instant) -> Self {
        Self {
            frame,
            expects: Expects::Nothing,
            purpose: Purpose::Pause,
            sent: now,
            window_ends: until,
            held_until: None,
            last_byte: None,
        }
    }

    pub(crate) fn deadline(&self) -> Instant {
        self.held_until
            .map_or(self.window_ends, |held| held.min(self.window_ends))
    }
}
