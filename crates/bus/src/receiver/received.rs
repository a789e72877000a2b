//! What the receiver finds in the bytes of an exchange.

use motorlink_protocol::{
    Frame, MotorId,
    family::{Model, Reading},
};

use super::STRAY_BYTES_MAX;
use crate::{line_event::JunkBytes, model::foreign_text::Text};

/// Result of the search for a reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// No reply yet.
    Nothing,
    /// A good window that may still turn out to be the shifted image of another.
    Ambiguous,
    /// A frame that is identical to the request: its echo, unless nothing else comes.
    Copy,
    /// A reply that starts at this offset.
    At(usize),
}

/// The bytes before a reply, or in a window without one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct OtherBytes {
    /// Echoed bytes of the request, 0-10.
    pub(crate) echoed: usize,
    /// Good frames of any motor and junk, in order of arrival.
    pub(crate) segments: Vec<Segment>,
    /// Bytes outside any frame and echo, including dropped ones.
    pub(crate) junk_bytes: usize,
    /// The motor and the model of a good frame of another model than that of the line.
    pub(crate) other_model: Option<(MotorId, Model)>,
    /// The bytes behind the echo, if they are text.
    pub(crate) text: Option<Text>,
    /// Whether they came in a full block, so that their age is unknown.
    pub(crate) is_block: bool,
}

/// A good frame of any motor, decoded. The bus decodes a reply here and nowhere else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ReceivedReply {
    pub(crate) frame: Frame,
    /// In combined frames bytes 6 and 7 are undetermined: only the bus knows the request.
    pub(crate) reading: Reading,
}

/// Bytes that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Segment {
    /// A good frame of any motor.
    Reply(ReceivedReply),
    /// Up to ten bytes that are not a good frame.
    Junk(JunkBytes),
}

impl ReceivedReply {
    /// Whether the CRC may hold by chance, as it does in one of 256 windows: beside so many bytes of junk, the frame has
    /// faults that no motor is known to report, or is part of a frame whose rest came in another window. `outstanding`
    /// if a reply to an earlier request may still come.
    pub(crate) fn is_chance(&self, junk_bytes: usize, outstanding: bool) -> bool {
        let faults = match self.reading {
            Reading::Combined(reply) => Some(reply.faults),
            Reading::Drive(reading) => Some(reading.faults),
            Reading::Odometry(reading) => Some(reading.faults),
            Reading::Mode(_) => None,
        };
        let is_unknown = faults.is_some_and(|faults| faults.unknown_bits() != 0);
        junk_bytes > 0 && is_unknown || outstanding && junk_bytes > STRAY_BYTES_MAX
    }
}

impl OtherBytes {
    /// Good frames of any motor.
    pub(crate) fn replies(&self) -> impl Iterator<Item = &ReceivedReply> {
        self.segments.iter().filter_map(|piece| match piece {
            Segment::Reply(reply) => Some(reply),
            Segment::Junk(_) => None,
        })
    }

    /// Whether all bytes outside frames are those of a pair that nothing drives.
    pub(crate) fn is_levels(&self) -> bool {
        self.segments.iter().all(|piece| match piece {
            Segment::Reply(_) => true,
            Segment::Junk(junk) => junk.bytes().iter().all(|byte| matches!(byte, 0 | 0xFF)),
        })
    }

    /// Whether nothing arrived that a motor sends: an echo at most, and bytes of a pair that nothing drives.
    pub(crate) fn is_quiet(&self) -> bool {
        self.is_levels() && self.replies().next().is_none()
    }

    /// Whether nothing arrived except an echo.
    pub(crate) fn is_silence(&self) -> bool {
        self.segments.is_empty() && self.junk_bytes == 0
    }
}
