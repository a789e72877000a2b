//! Finds replies in the received bytes: behind echoes, behind junk, in pieces.

mod frames;

use motorlink_protocol::{
    FRAME_LEN, Frame, MotorId,
    family::{Layout, Model, Reading},
};

pub(crate) use frames::reply_byte;

use frames::{begins_reply, frame_at, next_window, replier_at, reply_at};

use crate::{
    line_event::JunkBytes,
    model::evidence::{is_json, other_model},
};

/// Size of the receive buffer. Twelve replies and an echo fit into it. Of more junk than that the
/// oldest bytes are dropped.
const CAPACITY: usize = 128;

/// So many replies in a row without an echo, and a frame that is identical to its request is its reply.
const ECHO_RULED_OUT: u8 = 3;

/// So many bytes of the request directly before the reply are an echo. One byte may be noise: a request and its reply
/// begin with the same byte.
const ECHO_LEN_MIN: usize = 2;

/// The received bytes of one exchange.
///
/// Every offset is tried, because a truncated echo shifts the reply by an unknown length. CRC, ID
/// and byte 1 tell whether a window is a reply. Of a DDSM115 byte 1 is the mode, and a whole echo of a request has
/// 64, 74 or A0 there. A reply of a DDSM210 may be identical to its request: the first such frame is the echo,
/// unless several replies in a row have come without a byte of one. On a line that has echoed it always is.
///
/// An echo that begins only later, whole at once, cannot always be told from a reply: see `Motor::contradicts`.
#[derive(Debug)]
pub(crate) struct Receiver {
    buffer: Vec<u8>,
    /// Bytes dropped because the buffer was full.
    overflowed: usize,
    model: Model,
    /// Replies in a row without an echo before them; `None` once there was one, whole or cut.
    without_echo: Option<u8>,
}

/// Result of the search for a reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// No reply yet.
    Nothing,
    /// A good window that may still turn out to be the shifted image of another.
    Ambiguous,
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
    /// Whether the bytes are text in JSON.
    pub(crate) is_json: bool,
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

impl OtherBytes {
    /// Good frames of any motor.
    pub(crate) fn replies(&self) -> impl Iterator<Item = &ReceivedReply> {
        self.segments.iter().filter_map(|piece| match piece {
            Segment::Reply(reply) => Some(reply),
            Segment::Junk(_) => None,
        })
    }

    /// Whether nothing arrived except an echo.
    pub(crate) fn is_silence(&self) -> bool {
        self.segments.is_empty() && self.junk_bytes == 0
    }
}

impl Receiver {
    pub(crate) fn new(model: Model) -> Self {
        Self {
            buffer: Vec::with_capacity(CAPACITY),
            overflowed: 0,
            model,
            without_echo: Some(0),
        }
    }

    pub(crate) fn push(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if self.buffer.len() == CAPACITY {
                self.buffer.remove(0);
                self.overflowed += 1;
            }
            self.buffer.push(*byte);
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.buffer.len()
    }

    /// Searches for the reply of this motor to the request `sent`, in this layout. `settled` means that no more
    /// bytes are expected.
    pub(crate) fn find(&self, id: MotorId, layout: Layout, sent: &Frame, settled: bool) -> Found {
        let model = self.model;
        let bytes = self.buffer.as_slice();
        let byte_1 = reply_byte(model, layout);
        let echo = self.echo_like_a_reply(bytes, sent);
        let is_its = |offset: usize| {
            let in_layout = byte_1.is_none_or(|byte| bytes.get(offset + 1) == Some(&byte));
            in_layout && Some(offset) != echo && replier_at(model, bytes, offset) == Some(id)
        };
        if !(0..bytes.len()).any(is_its) {
            return Found::Nothing;
        }
        let may_begin = |offset: usize| match bytes.get(offset..offset + 2) {
            Some([first, second]) => *first == id.get() && begins_reply(model, *second),
            _ => false,
        };
        let mut from = 0;
        while let Some(window) = next_window(model, bytes, from, sent) {
            let unfinished = || {
                let mut rivals = window.offset + 1..window.offset + FRAME_LEN;
                rivals.any(|at| at + FRAME_LEN > bytes.len() && may_begin(at))
            };
            if !settled && (window.is_open || is_its(window.offset) && unfinished()) {
                return Found::Ambiguous;
            }
            if is_its(window.offset) {
                return Found::At(window.offset);
            }
            from = window.offset + FRAME_LEN;
        }
        Found::Nothing
    }

    /// Removes everything up to and including the frame at `offset`. Returns the frame and the
    /// bytes before it.
    pub(crate) fn take(
        &mut self,
        offset: usize,
        sent: &Frame,
    ) -> Option<(ReceivedReply, OtherBytes)> {
        let received = reply_at(self.model, &self.buffer, offset)?;
        let other_bytes = self.sort(offset, sent);
        if received.frame != *sent {
            self.without_echo = match (other_bytes.echoed, self.without_echo) {
                (0, counted) => counted.map(|replies| replies.saturating_add(1)),
                (FRAME_LEN, _) => None,
                (echoed, _) if echoed >= ECHO_LEN_MIN && echoed == offset => None,
                (_, counted) => counted.map(|_| 0),
            };
        }
        self.buffer.drain(..offset + FRAME_LEN);
        Some((received, other_bytes))
    }

    /// Records an echo: a frame identical to its request came too early for a reply.
    pub(crate) fn echo_detected(&mut self) {
        self.without_echo = self.without_echo.map(|_| 0);
    }

    /// Empties the buffer at the end of an exchange.
    pub(crate) fn clear(&mut self, sent: &Frame) -> OtherBytes {
        let other_bytes = self.sort(self.buffer.len(), sent);
        if other_bytes.echoed == 0 && other_bytes.replies().next().is_some() {
            self.without_echo = self.without_echo.map(|replies| replies.saturating_add(1));
        }
        self.buffer.clear();
        other_bytes
    }

    /// Where a whole echo of `sent` stands that looks like a reply.
    fn echo_like_a_reply(&self, bytes: &[u8], sent: &Frame) -> Option<usize> {
        let echoes = self
            .without_echo
            .is_none_or(|replies| replies < ECHO_RULED_OUT);
        if !(echoes && self.model.replies_look_like_requests()) {
            return None;
        }
        let mut windows = bytes.windows(FRAME_LEN);
        windows.position(|window| window == sent.bytes())
    }

    /// Sorts the first `length` bytes into echo, frames and junk.
    fn sort(&mut self, length: usize, sent: &Frame) -> OtherBytes {
        let model = self.model;
        let bytes = self.buffer.get(..length).unwrap_or_default();
        let echo = self.echo_like_a_reply(bytes, sent);
        let same = bytes
            .iter()
            .zip(sent.bytes())
            .take_while(|(heard, sent)| heard == sent)
            .count();
        let first = next_window(model, bytes, 0, sent).map(|window| window.offset);
        // A reply and its request begin with the same byte. Where a reply starts, whole or corrupt,
        // that byte is not an echo.
        let echoed = match first {
            // A raw frame that looks like a reply: no motor answers with the bytes of the request.
            _ if same == FRAME_LEN => FRAME_LEN,
            Some(reply) if reply < same => reply,
            _ if same == 1 && replier_at(model, &self.buffer, 1).is_none() => 0,
            _ => same,
        };
        let mut other_bytes = OtherBytes {
            echoed,
            segments: Vec::new(),
            junk_bytes: std::mem::take(&mut self.overflowed),
            other_model: [0, bytes.len().saturating_sub(FRAME_LEN)]
                .into_iter()
                .find_map(|offset| {
                    // Noise is rarely aligned to a frame.
                    let frame = frame_at(bytes, offset)?;
                    other_model(model, &frame).filter(|_| frame != *sent)
                }),
            is_json: is_json(bytes),
        };
        let mut at = echoed;
        while at < bytes.len() {
            let next =
                next_window(model, bytes, at, sent).map_or(bytes.len(), |window| window.offset);
            for junk in bytes.get(at..next).unwrap_or_default().chunks(FRAME_LEN) {
                other_bytes
                    .segments
                    .push(Segment::Junk(JunkBytes::new(junk)));
            }
            other_bytes.junk_bytes += next - at;
            at = next;
            if let Some(received) = reply_at(model, bytes, at) {
                if Some(at) != echo {
                    other_bytes.segments.push(Segment::Reply(received));
                }
                at += FRAME_LEN;
            }
        }
        other_bytes
    }
}

#[cfg(test)]
#[path = "receiver_tests.rs"]
mod tests;
