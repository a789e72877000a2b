//! One exchange: a request and the window of its reply.

use std::time::Duration;

use motorlink_protocol::{
    Frame, Instant, MotorId,
    family::{Layout, Model, Request},
};

use crate::{raw::frame::addressee, timing::SETTLE_TIME};

/// State of the line.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Line {
    /// Free. The last request is kept because its echo may still arrive.
    Free { last: Frame },
    /// A request or its reply is on the wire.
    Busy(Exchange),
}

/// A request that was sent, and the expected answer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exchange {
    pub(crate) frame: Frame,
    pub(crate) expects: Expects,
    pub(crate) purpose: Purpose,
    pub(crate) sent: Instant,
    /// When the line is free again, with or without a reply.
    pub(crate) window_ends: Instant,
    /// Until when an ambiguous window is held back: it may be the shifted image of another reply.
    pub(crate) held_until: Option<Instant>,
    /// When the last byte arrived.
    pub(crate) last_byte: Option<Instant>,
}

/// What the exchange is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Driving, stopping, switching, telemetry.
    Control,
    /// A scan or an ID change.
    Job,
    /// A raw frame.
    Raw,
    /// None: the line rests.
    Pause,
}

/// The answer that ends an exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Expects {
    /// One reply of one motor, in one layout.
    Reply { id: MotorId, layout: Layout },
    /// Replies of several motors. The exchange lasts the whole window.
    Everyone {
        /// `None` if the request is unknown.
        layout: Option<motorlink_protocol::Layout>,
    },
    /// None: set ID, and mode switches in combined frames.
    Nothing,
}

impl Expects {
    /// The answer to a request.
    pub(crate) fn of(model: Model, request: Request) -> Self {
        match (request.addressee(), request.reply_layout(model)) {
            (Some(id), Some(layout)) => Self::Reply { id, layout },
            (None, Some(layout)) => Self::Everyone {
                layout: layout.combined(),
            },
            (_, None) => Self::Nothing,
        }
    }

    /// The answer to a raw frame. An unreadable frame may be answered by any motor, and so may a
    /// drive frame without a single addressee.
    pub(crate) fn of_raw(model: Model, frame: &Frame) -> Self {
        match Request::parse(model, frame) {
            Ok(Request::Drive { .. }) if addressee(frame).is_none() => {
                Self::Everyone { layout: None }
            }
            Ok(request) => Self::of(model, request),
            Err(_) => Self::Everyone { layout: None },
        }
    }
}

impl Exchange {
    /// An exchange that begins now. `window` is how long a reply may take, `airtime` how long the frame occupies the
    /// line.
    pub(crate) fn begin(
        now: Instant,
        frame: Frame,
        expects: Expects,
        window: Duration,
        airtime: Duration,
        purpose: Purpose,
    ) -> Self {
        let occupied = if expects == Expects::Nothing {
            airtime + SETTLE_TIME
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

    /// A pause of the line until `until`. `frame` is the last one, sent or refused.
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

    /// The time to its last byte: a reply may be recognized later.
    pub(crate) fn took(&self, now: Instant) -> Duration {
        self.last_byte.unwrap_or(now).since(self.sent)
    }

    pub(crate) fn deadline(&self) -> Instant {
        self.held_until
            .map_or(self.window_ends, |held| held.min(self.window_ends))
    }
}
