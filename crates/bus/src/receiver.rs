//! Finds replies in what the adapter delivers: behind echoes, behind junk, in pieces.

use motorlink_protocol::{FRAME_LEN, Frame, Mode, MotorId, Reply};

use crate::JunkBytes;

/// Bytes kept while a reply is looked for. Twelve replies and an echo at once fit into it; what is
/// more than that is a flood of junk, of which the oldest is let go.
const CAPACITY: usize = 128;

/// The bytes of one exchange.
///
/// Every offset is tried, because an echo that was cut short shifts the reply by a length that
/// nobody announces. Whether a window is a reply is told by its CRC, its ID and its mode byte; a
/// request that was echoed whole has a good CRC but 64, 74 or A0 in place of the mode.
#[derive(Debug)]
pub(crate) struct Receiver {
    buffer: Vec<u8>,
    /// Bytes let go because the buffer was full.
    overflowed: usize,
}

/// What the bytes so far are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// No reply yet.
    Nothing,
    /// A good window whose bytes may yet turn out to be the shifted image of another.
    Ambiguous,
    /// A reply that starts at this offset.
    At(usize),
}

/// What stood in front of a reply, or in a window without one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Leftovers {
    /// Bytes of the request that came back, 0-10.
    pub(crate) echoed: usize,
    /// Good frames of any motor and everything else, as they came.
    pub(crate) pieces: Vec<Piece>,
    /// Bytes that are part of no frame and no echo, with those that were let go.
    pub(crate) junk_bytes: usize,
}

/// A run of bytes that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Piece {
    /// A good frame of any motor.
    Frame(Frame),
    /// Up to ten bytes that are no good frame.
    Junk(JunkBytes),
}

impl Leftovers {
    /// Good frames of any motor.
    pub(crate) fn frames(&self) -> impl Iterator<Item = &Frame> {
        self.pieces.iter().filter_map(|piece| match piece {
            Piece::Frame(frame) => Some(frame),
            Piece::Junk(_) => None,
        })
    }

    /// Whether nothing came but an echo.
    pub(crate) fn is_silence(&self) -> bool {
        self.pieces.is_empty() && self.junk_bytes == 0
    }
}

impl Receiver {
    pub(crate) fn new() -> Self {
        Self {
            buffer: Vec::with_capacity(CAPACITY),
            overflowed: 0,
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

    /// Looks for a reply of this motor. With `settled`, the line has been quiet and no more bytes
    /// are waited for.
    pub(crate) fn find(&self, id: MotorId, settled: bool) -> Found {
        let is_reply = |offset: usize| {
            frame_at(&self.buffer, offset).is_some_and(|frame| replies(&frame) == Some(id))
        };
        let Some(first) = (0..self.buffer.len()).find(|offset| is_reply(*offset)) else {
            return Found::Nothing;
        };
        let rivals = first + 1..first + FRAME_LEN;
        // Behind a cut echo the true reply is the later window, and it ends where the bytes end.
        let last = rivals
            .clone()
            .rev()
            .find(|offset| is_reply(*offset))
            .unwrap_or(first);
        let may_begin = |offset: usize| match self.buffer.get(offset..offset + 2) {
            Some([first, second]) => *first == id.get() && Mode::from_byte(*second).is_ok(),
            _ => false,
        };
        let unfinished = rivals
            .clone()
            .any(|at| at + FRAME_LEN > self.buffer.len() && may_begin(at));
        if unfinished && !settled {
            Found::Ambiguous
        } else {
            Found::At(last)
        }
    }

    /// Takes everything up to and with the frame at `offset`; says what stood in front of it.
    pub(crate) fn take(&mut self, offset: usize, sent: &Frame) -> Option<(Frame, Leftovers)> {
        let frame = frame_at(&self.buffer, offset)?;
        let leftovers = self.sort(offset, sent);
        self.buffer.drain(..offset + FRAME_LEN);
        Some((frame, leftovers))
    }

    /// Empties the buffer at the end of an exchange.
    pub(crate) fn clear(&mut self, sent: &Frame) -> Leftovers {
        let leftovers = self.sort(self.buffer.len(), sent);
        self.buffer.clear();
        leftovers
    }

    /// Sorts the first `length` bytes into echo, frames and junk.
    fn sort(&mut self, length: usize, sent: &Frame) -> Leftovers {
        let bytes = self.buffer.get(..length).unwrap_or_default();
        let is_frame =
            |offset: &usize| frame_at(&self.buffer, *offset).is_some_and(|f| replies(&f).is_some());
        let same = bytes
            .iter()
            .zip(sent.bytes())
            .take_while(|(heard, sent)| heard == sent)
            .count();
        // A reply begins with the byte that its request began with. Where a reply starts, whole or
        // spoilt, that byte is no echo.
        let echoed = match (0..same).find(is_frame) {
            // A reply that a person sent: no motor answers with what it was asked.
            _ if same == FRAME_LEN => FRAME_LEN,
            Some(reply) => reply,
            None if same == 1 && !is_frame(&1) => 0,
            None => same,
        };
        let mut leftovers = Leftovers {
            echoed,
            pieces: Vec::new(),
            junk_bytes: std::mem::take(&mut self.overflowed),
        };
        let mut rest = bytes.get(echoed..).unwrap_or_default();
        while !rest.is_empty() {
            let good = |at: usize| frame_at(rest, at).filter(|frame| replies(frame).is_some());
            let length = if let Some(frame) = good(0) {
                leftovers.pieces.push(Piece::Frame(frame));
                FRAME_LEN
            } else {
                // To the next good frame, in pieces of a frame's length.
                let all = rest.len().min(FRAME_LEN);
                let length = (1..all).find(|at| good(*at).is_some()).unwrap_or(all);
                let junk = rest.get(..length).unwrap_or_default();
                leftovers.pieces.push(Piece::Junk(JunkBytes::new(junk)));
                leftovers.junk_bytes += length;
                length
            };
            rest = rest.get(length..).unwrap_or_default();
        }
        leftovers
    }
}

fn frame_at(bytes: &[u8], offset: usize) -> Option<Frame> {
    let window = bytes.get(offset..offset + FRAME_LEN)?;
    window.try_into().ok().map(Frame::new)
}

/// Whose reply this is, where it is one.
fn replies(frame: &Frame) -> Option<MotorId> {
    Reply::decode(frame, None).ok().map(|reply| reply.id)
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUERY: &str = "01 74 00 00 00 00 00 00 00 04";
    const REPLY: &str = "01 02 00 0A 00 00 20 F6 00 4A";
    const ID: MotorId = MotorId::FIRST;

    fn frame(text: &str) -> Frame {
        text.parse().unwrap()
    }

    fn after(bytes: &[u8]) -> Receiver {
        let mut receiver = Receiver::new();
        receiver.push(bytes);
        receiver
    }

    #[test]
    fn a_reply_is_found_behind_an_echo_of_any_length() {
        for cut in 0..=FRAME_LEN {
            let mut bytes = frame(QUERY).bytes()[..cut].to_vec();
            bytes.extend(frame(REPLY).bytes());
            let mut receiver = after(&bytes);
            assert_eq!(
                receiver.find(ID, false),
                Found::At(cut),
                "echo of {cut} bytes"
            );
            let (found, before) = receiver.take(cut, &frame(QUERY)).unwrap();
            assert_eq!(found, frame(REPLY));
            assert_eq!(
                before,
                Leftovers {
                    echoed: cut,
                    ..Leftovers::default()
                }
            );
        }
    }

    #[test]
    fn an_echo_alone_is_no_reply() {
        let mut receiver = after(frame(QUERY).bytes());
        assert_eq!(receiver.find(ID, true), Found::Nothing);
        assert_eq!(receiver.clear(&frame(QUERY)).echoed, FRAME_LEN);
    }

    #[test]
    fn a_reply_is_found_behind_junk_of_any_length() {
        for length in 0..CAPACITY - FRAME_LEN {
            let mut bytes = vec![0x55; length];
            bytes.extend(frame(REPLY).bytes());
            assert_eq!(after(&bytes).find(ID, false), Found::At(length));
        }
    }

    #[test]
    fn a_flood_keeps_the_newest_bytes() {
        let mut receiver = after(&[0x55; 1000]);
        receiver.push(frame(REPLY).bytes());
        assert_eq!(receiver.find(ID, false), Found::At(CAPACITY - FRAME_LEN));
        let (_, before) = receiver.take(CAPACITY - FRAME_LEN, &frame(QUERY)).unwrap();
        assert_eq!(before.junk_bytes, 1000);
    }

    /// One byte of echo in front of a reply whose shifted image has a good CRC too: motor 1 in the
    /// current loop, so that the shifted mode byte is 1.
    #[test]
    fn a_shifted_image_with_a_good_crc_is_not_taken_for_the_reply() {
        let image = (0..=u16::MAX)
            .map(|position| {
                let [hi, lo] = position.to_be_bytes();
                Frame::with_crc([1, 1, 0, 40, 0, 0, hi, lo, 0])
            })
            .find(|true_reply| {
                let mut shifted = vec![1];
                shifted.extend(&true_reply.bytes()[..9]);
                Frame::new(shifted.try_into().unwrap()).crc_holds()
            })
            .expect("one in 256 does");
        let mut receiver = after(&[1]);
        receiver.push(&image.bytes()[..9]);
        assert_eq!(receiver.find(ID, false), Found::Ambiguous);
        receiver.push(&image.bytes()[9..]);
        assert_eq!(receiver.find(ID, false), Found::At(1));
    }

    #[test]
    fn a_late_reply_in_front_is_not_taken_for_an_echo_of_its_first_byte() {
        let rest = after(frame(REPLY).bytes()).clear(&frame(QUERY));
        assert_eq!(
            rest,
            Leftovers {
                pieces: vec![Piece::Frame(frame(REPLY))],
                ..Leftovers::default()
            }
        );
    }

    #[test]
    fn a_spoilt_reply_is_no_echo_of_one_byte() {
        let mut spoilt = *frame(REPLY).bytes();
        spoilt[9] ^= 1;
        let rest = after(&spoilt).clear(&frame(QUERY));
        assert_eq!(
            rest,
            Leftovers {
                pieces: vec![Piece::Junk(JunkBytes::new(&spoilt))],
                junk_bytes: 10,
                ..Leftovers::default()
            }
        );
    }

    #[test]
    fn frames_of_others_are_kept_apart_from_junk() {
        let other = Frame::with_crc([2, 2, 0, 0, 0, 0, 30, 0, 0]);
        let mut bytes = vec![0x33];
        bytes.extend(other.bytes());
        bytes.extend(frame(REPLY).bytes());
        let mut receiver = after(&bytes);
        assert_eq!(receiver.find(ID, false), Found::At(11));
        let (_, before) = receiver.take(11, &frame(QUERY)).unwrap();
        assert_eq!(
            before,
            Leftovers {
                echoed: 0,
                pieces: vec![Piece::Junk(JunkBytes::new(&[0x33])), Piece::Frame(other)],
                junk_bytes: 1
            }
        );
    }
}
