//! Finds replies in the received bytes: behind echoes, behind junk, in pieces.

mod echo;
mod frames;
mod received;

use std::collections::VecDeque;

use motorlink_protocol::{
    FRAME_LEN, Frame, MotorId,
    family::{Layout, Model},
};

use echo::{Echo, part_before};
pub(crate) use frames::reply_byte;
pub(crate) use received::{Found, OtherBytes, ReceivedReply, Segment};

use frames::{begins_reply, frame_at, next_window, replier_at, reply_at};

use crate::{
    line_event::JunkBytes,
    model::{evidence::other_model, foreign_text::Text},
};

/// Size of the receive buffer. Twelve replies and an echo fit into it. Of more junk than that the
/// oldest bytes are dropped.
const CAPACITY: usize = 128;

/// A block of an adapter that delivers only full ones. No sum of replies and whole echoes is as long.
pub(crate) const BLOCK: usize = 32;

/// The first byte of the ID query, which every motor answers.
const ID_QUERY: u8 = 0xC8;

/// So many replies in a row show that nothing of earlier requests is outstanding, as in `LateReplies`.
const OWED_MIN: u8 = 4;
const OWED_MAX: u8 = 8;

/// Noise beside a reply has at most so many bytes. More are part of a frame.
pub(crate) const STRAY_BYTES_MAX: usize = 4;

/// A motor is asked at once again behind so many doubtful copies: twelve answers that differ end the doubt. Of a motor
/// that does not answer, only the echo comes.
const DOUBTS_MAX: u8 = 32;

/// The received bytes of one exchange.
///
/// Every offset is tried, because a truncated echo shifts the reply by an unknown length. CRC, ID
/// and byte 1 tell whether a window is a reply. Of a DDSM115 byte 1 is the mode, and a whole echo of a request has
/// 64, 74 or A0 there. A reply of a DDSM210 may be identical to its request. Such a copy is a reply only if that is
/// proved: see [`Echo`].
///
/// An echo that begins only later, whole at once and without the reply, cannot always be told from a reply: see
/// `Motor::contradicts`.
#[derive(Debug)]
pub(crate) struct Receiver {
    buffer: Vec<u8>,
    /// Bytes dropped because the buffer was full.
    overflowed: usize,
    /// Whether the buffer has bytes of a full block. They have waited in the adapter for any time, so no frame among
    /// them is known to answer the request in flight.
    has_block: bool,
    model: Model,
    echo: Echo,
    /// Copies that were no proof, at most [`DOUBTS_MAX`].
    doubts: u8,
    /// The last requests without a reply, at most [`OWED_MAX`].
    unanswered: VecDeque<Frame>,
    /// Replies to receive before nothing of an unanswered request counts as outstanding, its echo included.
    owed: u8,
}

impl Receiver {
    pub(crate) fn new(model: Model) -> Self {
        Self {
            buffer: Vec::with_capacity(CAPACITY),
            overflowed: 0,
            has_block: false,
            model,
            echo: Echo::default(),
            doubts: 0,
            unanswered: VecDeque::new(),
            owed: 0,
        }
    }

    pub(crate) fn push(&mut self, bytes: &[u8]) {
        self.has_block |= bytes.len() == BLOCK;
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
        let is_its = |offset: usize| {
            let in_layout = byte_1.is_none_or(|byte| bytes.get(offset + 1) == Some(&byte));
            in_layout && !self.is_copy(offset, sent) && replier_at(model, bytes, offset) == Some(id)
        };
        if !(0..bytes.len()).any(is_its) {
            return self.find_copy(sent, settled);
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
            if is_its(window.offset) && !window.is_unclear {
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
        // While bytes of an earlier request may come, only a window with nothing else tells of the echo.
        let is_alone = self.buffer.len() == FRAME_LEN;
        if received.frame != *sent && (self.owed == 0 || is_alone) && !self.has_block {
            let before = self.buffer.get(..offset).unwrap_or_default();
            self.echo.replied(part_before(before, sent));
        }
        self.owed = self.owed.saturating_sub(1);
        if self.owed == 0 {
            self.unanswered.clear();
        }
        self.buffer.drain(..offset + FRAME_LEN);
        Some((received, other_bytes))
    }

    /// Records an echo: a frame identical to its request came too early for a reply, or cannot be true.
    pub(crate) fn echo_detected(&mut self) {
        self.echo.detected();
    }

    /// Whether a copy of the request has come that may be its reply. What the adapter does is not known yet: a request
    /// whose answer differs tells more.
    pub(crate) fn has_doubtful_copy(&mut self, sent: &Frame) -> bool {
        let is_doubtful = self.echo.is_unknown()
            && self.doubts < DOUBTS_MAX
            && self.find_copy(sent, false) == Found::Copy;
        self.doubts += u8::from(is_doubtful);
        is_doubtful
    }

    /// Whether to ask at once again for what has just been answered: copies may be replies, and this tells whether the
    /// adapter echoes.
    pub(crate) fn wants_proof(&mut self) -> bool {
        let wants = self.echo.is_unknown() && (1..DOUBTS_MAX).contains(&self.doubts);
        self.doubts += u8::from(wants);
        wants
    }

    /// The window of the request `sent` has ended without a reply.
    pub(crate) fn window_ended(&mut self, sent: &Frame) {
        // A copy that was no proof: nothing else is outstanding, and the replies that follow tell of the echo.
        if self.echo.is_unknown() && self.find_copy(sent, false) == Found::Copy {
            return;
        }
        if self.unanswered.len() >= usize::from(OWED_MAX) {
            self.unanswered.pop_front();
        }
        self.unanswered.push_back(*sent);
        self.owed = (self.owed + 1).clamp(OWED_MIN, OWED_MAX);
    }

    /// Whether bytes of an unanswered request may still come.
    pub(crate) const fn is_owed(&self) -> bool {
        self.owed > 0
    }

    /// Empties the buffer at the end of an exchange.
    pub(crate) fn clear(&mut self, sent: &Frame) -> OtherBytes {
        let other_bytes = self.sort(self.buffer.len(), sent);
        if let Some(reply) = other_bytes.replies().next()
            && reply.frame != *sent
            && self.owed == 0
            && !self.has_block
        {
            let at = self.buffer.windows(FRAME_LEN);
            let at = at.into_iter().position(|it| it == reply.frame.bytes());
            let before = self.buffer.get(..at.unwrap_or_default());
            self.echo
                .replied(part_before(before.unwrap_or_default(), sent));
        } else if other_bytes.echoed == FRAME_LEN && !echo::may_be_reply(self.model, sent) {
            self.echo.detected();
        }
        self.buffer.clear();
        self.has_block = false;
        other_bytes
    }

    /// Whether the frame at `offset` is identical to its request, or to an earlier one without a reply. Its echo looks
    /// like a reply.
    fn is_copy(&self, offset: usize, sent: &Frame) -> bool {
        let window = self.buffer.get(offset..).and_then(<[u8]>::first_chunk);
        let Some(window) = window.filter(|_| self.model.has_separate_frames()) else {
            return false;
        };
        let mut unanswered = self.unanswered.iter();
        self.is_echo(offset, sent) || unanswered.any(|earlier| window == earlier.bytes())
    }

    /// Whether the frame at `offset` is the echo of `sent`.
    fn is_echo(&self, offset: usize, sent: &Frame) -> bool {
        let window = self.buffer.get(offset..).and_then(<[u8]>::first_chunk);
        let model = self.model;
        model.has_separate_frames() && window.is_some_and(|it| echo::is_echo(model, it, sent))
    }

    /// The copy of the request that is its reply, or may be.
    fn find_copy(&self, sent: &Frame, settled: bool) -> Found {
        let bytes = self.buffer.as_slice();
        let mut windows = bytes.windows(FRAME_LEN);
        let Some(last) = windows.rposition(|window| window == sent.bytes()) else {
            return Found::Nothing;
        };
        if self.has_block || !echo::may_be_reply(self.model, sent) {
            return Found::Nothing;
        }
        // Behind the echo of a request, whole or cut, a copy of it is the reply.
        let before = bytes.get(..last).unwrap_or_default();
        let ends = last + FRAME_LEN == bytes.len();
        if ends && self.echo.proves_reply(part_before(before, sent)) {
            return Found::At(last);
        }
        // Where nothing is echoed, it is the reply too. But this may be the first echo: then the reply follows.
        if settled && self.echo.is_ruled_out() {
            return Found::At(last);
        }
        Found::Copy
    }

    /// Sorts the first `length` bytes into echo, frames and junk.
    fn sort(&mut self, length: usize, sent: &Frame) -> OtherBytes {
        let model = self.model;
        let bytes = self.buffer.get(..length).unwrap_or_default();
        let same = bytes
            .iter()
            .zip(sent.bytes())
            .take_while(|(heard, sent)| heard == sent)
            .count();
        let first = next_window(model, bytes, 0, sent).map(|window| window.offset);
        let tail = echo::tail_at_front(bytes, sent);
        // A reply and its request begin with the same byte. Where a reply starts, whole or corrupt,
        // that byte is not an echo.
        let echoed = match first {
            // A raw frame that looks like a reply: no motor answers with the bytes of the request.
            _ if same == FRAME_LEN => FRAME_LEN,
            Some(reply) if reply < same => reply,
            _ if tail > same && first.is_none_or(|reply| tail <= reply) => tail,
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
                    other_model(model, &frame).filter(|(id, _)| {
                        // A byte of noise before an echo makes frames of any address. A motor answers for its own.
                        let [asked, ..] = *sent.bytes();
                        frame != *sent && (id.get() == asked || asked == ID_QUERY)
                    })
                }),
            text: Text::of(bytes.get(echoed..).unwrap_or_default()),
            is_block: self.has_block,
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
                // What may be the echo of an earlier request may be a late reply, too.
                if !self.is_echo(at, sent) {
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
