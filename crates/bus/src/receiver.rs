//! Finds replies in the received bytes: behind echoes, behind junk, in pieces.

use motorlink_protocol::{
    FRAME_LEN, Frame, Mode, MotorId,
    family::{FrameSet, Layout, Model, Reading},
};

use crate::{
    line_event::JunkBytes,
    model::evidence::{is_json, other_model},
};

/// Size of the receive buffer. Twelve replies and an echo fit into it. Of more junk than that the
/// oldest bytes are dropped.
const CAPACITY: usize = 128;

/// The fault byte of a reply, and its bits that no motor is known to set (`motor.md`).
const FAULT_BYTE: usize = 8;
const RESERVED: u8 = 0b1110_0000;

/// So many replies in a row without an echo, and a frame that is identical to its request is its reply.
const ECHO_RULED_OUT: u8 = 3;

/// The received bytes of one exchange.
///
/// Every offset is tried, because a truncated echo shifts the reply by an unknown length. CRC, ID
/// and byte 1 tell whether a window is a reply. Of a DDSM115 byte 1 is the mode, and a whole echo of a request has
/// 64, 74 or A0 there. A reply of a DDSM210 may be identical to its request: the first such frame is the echo,
/// until several replies have come without one.
#[derive(Debug)]
pub(crate) struct Receiver {
    buffer: Vec<u8>,
    /// Bytes dropped because the buffer was full.
    overflowed: usize,
    model: Model,
    /// Replies in a row without an echo before them; `None` once there was one.
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
    /// The model of a good frame that is none of the model of the line.
    pub(crate) other_model: Option<Model>,
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
            let echoed = other_bytes.echoed == FRAME_LEN;
            let counted = self.without_echo.filter(|_| !echoed);
            self.without_echo = counted.map(|replies| replies.saturating_add(1));
        }
        self.buffer.drain(..offset + FRAME_LEN);
        Some((received, other_bytes))
    }

    /// A frame identical to its request came too early for a reply: the line echoes, maybe only since now.
    pub(crate) fn echo_came(&mut self) {
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

/// A window of ten bytes that is a good frame.
#[derive(Clone, Copy, Debug)]
struct Window {
    offset: usize,
    /// Whether more bytes may show that another window is the true one.
    is_open: bool,
}

/// The next good frame at or after `from`.
///
/// Two overlapping windows cannot both be true: about one in 256 windows that begin like a reply
/// has a good CRC by chance, behind a truncated echo or across two frames. The first is the true
/// one, unless it is not part of a row of frames and there is a reason for the other: a frame
/// follows it directly, an echo of `sent` stands directly before it, or it ends where the bytes
/// end.
fn next_window(model: Model, bytes: &[u8], from: usize, sent: &Frame) -> Option<Window> {
    let is_good = |offset: usize| replier_at(model, bytes, offset).is_some();
    let first = (from..bytes.len()).find(|offset| is_good(*offset))?;
    let ends_at = |offset: usize| offset + FRAME_LEN == bytes.len();
    let follows_echo = |offset: usize| {
        (1..=FRAME_LEN).any(|length| {
            let begins = offset.checked_sub(length).filter(|begins| *begins <= first);
            begins.is_some_and(|begins| bytes.get(begins..offset) == sent.bytes().get(..length))
        })
    };
    let mut offset = first;
    let mut is_open = false;
    if !is_good(first + FRAME_LEN) {
        let rivals = || (first + 1..first + FRAME_LEN).filter(|rival| is_good(*rival));
        let has_reason =
            |rival: &usize| is_good(rival + FRAME_LEN) || follows_echo(*rival) || ends_at(*rival);
        // A stray byte after a reply and a truncated echo of one byte before it look alike. Most replies report
        // no fault, and a byte in that place by chance is rarely 0.
        let doubt = |offset: usize| match bytes.get(offset + FAULT_BYTE) {
            Some(0) | None => 0,
            Some(faults) if faults & RESERVED == 0 => 1,
            Some(_) => 2,
        };
        let is_likely = |rival: &usize| has_reason(rival) && doubt(*rival) <= doubt(first);
        // After a truncated echo the true reply is the last one.
        offset = rivals().rfind(is_likely).unwrap_or(first);
        let may_be_followed = first + 2 * FRAME_LEN > bytes.len();
        let is_settled = offset != first && follows_echo(offset) && ends_at(offset);
        is_open = rivals().next().is_some() && may_be_followed && !is_settled;
    }
    Some(Window { offset, is_open })
}

/// Byte 1 of a reply in this layout, if it has a fixed one.
const fn reply_byte(model: Model, layout: Layout) -> Option<u8> {
    let FrameSet::Separate { reply_offset } = model.spec().frames else {
        return None;
    };
    let of_a_ddsm210 = match layout {
        Layout::Drive => 0x64,
        Layout::Query => 0x74,
        Layout::Mode => 0x75,
        Layout::Switch => 0xA0,
    };
    Some(of_a_ddsm210 + reply_offset)
}

/// Whether a reply of this model has this byte 1.
fn begins_reply(model: Model, byte: u8) -> bool {
    match model.spec().frames {
        FrameSet::Combined => Mode::from_byte(byte).is_ok(),
        FrameSet::Separate { reply_offset } => {
            matches!(byte.wrapping_sub(reply_offset), 0x64 | 0x74 | 0x75 | 0xA0)
        }
    }
}

/// The motor whose reply begins at `offset`: byte 1, CRC and ID are those of a reply. The search tries
/// every offset, so it checks these bytes and decodes none.
fn replier_at(model: Model, bytes: &[u8], offset: usize) -> Option<MotorId> {
    // Byte 1 before the CRC: it rules out most offsets.
    if !begins_reply(model, *bytes.get(offset + 1)?) {
        return None;
    }
    let frame = frame_at(bytes, offset).filter(Frame::crc_holds)?;
    let &[id, ..] = frame.bytes();
    MotorId::new(id).ok()
}

/// The reply that begins at `offset`, decoded.
fn reply_at(model: Model, bytes: &[u8], offset: usize) -> Option<ReceivedReply> {
    let frame = frame_at(bytes, offset)?;
    let reading = Reading::decode(model, &frame, None).ok()?;
    Some(ReceivedReply { frame, reading })
}

fn frame_at(bytes: &[u8], offset: usize) -> Option<Frame> {
    let window = bytes.get(offset..offset + FRAME_LEN)?;
    window.try_into().ok().map(Frame::new)
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

    fn received(frame: Frame) -> Segment {
        let reading = Reading::decode(Model::Ddsm115, &frame, None).unwrap();
        Segment::Reply(ReceivedReply { frame, reading })
    }

    fn frames(other_bytes: &OtherBytes) -> Vec<Frame> {
        other_bytes
            .replies()
            .map(|received| received.frame)
            .collect()
    }

    fn after(bytes: &[u8]) -> Receiver {
        let mut receiver = Receiver::new(Model::Ddsm115);
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
                receiver.find(ID, Layout::Query, &frame(QUERY), false),
                Found::At(cut),
                "echo of {cut} bytes"
            );
            let (found, before) = receiver.take(cut, &frame(QUERY)).unwrap();
            assert_eq!(found.frame, frame(REPLY));
            assert_eq!(
                before,
                OtherBytes {
                    echoed: cut,
                    ..OtherBytes::default()
                }
            );
        }
    }

    #[test]
    fn an_echo_alone_is_no_reply() {
        let mut receiver = after(frame(QUERY).bytes());
        assert_eq!(
            receiver.find(ID, Layout::Query, &frame(QUERY), true),
            Found::Nothing
        );
        assert_eq!(receiver.clear(&frame(QUERY)).echoed, FRAME_LEN);
    }

    #[test]
    fn a_reply_is_found_behind_junk_of_any_length() {
        for length in 0..CAPACITY - FRAME_LEN {
            let mut bytes = vec![0x55; length];
            bytes.extend(frame(REPLY).bytes());
            assert_eq!(
                after(&bytes).find(ID, Layout::Query, &frame(QUERY), false),
                Found::At(length)
            );
        }
    }

    #[test]
    fn a_flood_keeps_the_newest_bytes() {
        let mut receiver = after(&[0x55; 1000]);
        receiver.push(frame(REPLY).bytes());
        assert_eq!(
            receiver.find(ID, Layout::Query, &frame(QUERY), false),
            Found::At(CAPACITY - FRAME_LEN)
        );
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
        assert_eq!(
            receiver.find(ID, Layout::Query, &frame(QUERY), false),
            Found::Ambiguous
        );
        receiver.push(&image.bytes()[9..]);
        assert_eq!(
            receiver.find(ID, Layout::Query, &frame(QUERY), false),
            Found::At(1)
        );
    }

    /// Two replies in one chunk, found by the fault simulation: the last byte of one and nine of
    /// the other have a good CRC as a reply of motor 2 at 2,048 rpm.
    #[test]
    fn a_window_across_two_good_frames_is_not_taken_for_a_reply() {
        let first = frame("02 02 00 08 00 00 75 7F 00 02");
        let second = frame("01 01 00 08 00 00 58 00 10 85");
        let sent = frame("02 74 00 00 00 00 00 00 00 F1");
        let bytes = [*first.bytes(), *second.bytes()].concat();
        let image: [u8; FRAME_LEN] = bytes[9..19].try_into().unwrap();
        assert!(Frame::new(image).crc_holds());
        let motors = [(MotorId::new(2).unwrap(), 0), (ID, 10)];
        for (id, offset) in motors {
            for settled in [false, true] {
                let found = after(&bytes).find(id, Layout::Query, &sent, settled);
                assert_eq!(found, Found::At(offset), "{id}");
            }
        }
        assert_eq!(frames(&after(&bytes).clear(&sent)), [first, second]);
    }

    /// Before the rest of the second arrives, only the fact that more may come tells them apart.
    #[test]
    fn a_window_that_ends_the_bytes_is_not_taken_before_the_line_is_quiet() {
        let bytes = [
            *frame("02 02 00 08 00 00 75 7F 00 02").bytes(),
            *frame("01 01 00 08 00 00 58 00 10 85").bytes(),
        ]
        .concat();
        let sent = frame("02 74 00 00 00 00 00 00 00 F1");
        let mut receiver = after(&bytes[..19]);
        let second = MotorId::new(2).unwrap();
        assert_eq!(
            receiver.find(second, Layout::Query, &sent, false),
            Found::Ambiguous
        );
        receiver.push(&bytes[19..]);
        assert_eq!(
            receiver.find(second, Layout::Query, &sent, false),
            Found::At(0)
        );
    }

    /// The last byte of a corrupt frame and nine of the good one after it.
    #[test]
    fn the_first_of_a_row_of_frames_is_found_behind_a_spoilt_one() {
        let first = frame("02 02 00 08 00 00 75 7F 00 02");
        let second = frame(REPLY);
        let last = (1..u8::MAX)
            .find(|last| {
                replier_at(
                    Model::Ddsm115,
                    &[&[*last], first.bytes().as_slice()].concat(),
                    0,
                )
                .is_some()
            })
            .expect("the CRC tells all first bytes apart");
        let mut bytes = vec![0x55; 9];
        bytes.push(last);
        bytes.extend(first.bytes());
        bytes.extend(second.bytes());
        let mut receiver = after(&bytes);
        let id = MotorId::new(2).unwrap();
        assert_eq!(
            receiver.find(id, Layout::Query, &frame(QUERY), false),
            Found::At(10)
        );
        let rest = receiver.clear(&frame(QUERY));
        assert_eq!(frames(&rest), [first, second], "{last:02X}");
    }

    #[test]
    fn behind_junk_that_makes_an_image_the_reply_is_the_window_that_ends_the_bytes() {
        let reply = *frame(REPLY).bytes();
        let junk = (0..=u16::MAX)
            .map(|junk| [1, 2, junk.to_be_bytes()[0], junk.to_be_bytes()[1]])
            .find(|junk| {
                replier_at(Model::Ddsm115, &[junk.as_slice(), &reply].concat(), 0).is_some()
            })
            .expect("one in 256 does");
        let mut receiver = after(&[junk.as_slice(), &reply].concat());
        assert_eq!(
            receiver.find(ID, Layout::Query, &frame(QUERY), false),
            Found::Ambiguous
        );
        assert_eq!(
            receiver.find(ID, Layout::Query, &frame(QUERY), true),
            Found::At(4)
        );
        let (taken, before) = receiver.take(4, &frame(QUERY)).unwrap();
        assert_eq!((taken.frame, before.junk_bytes), (frame(REPLY), 4));
    }

    #[test]
    fn a_late_reply_in_front_is_not_taken_for_an_echo_of_its_first_byte() {
        let rest = after(frame(REPLY).bytes()).clear(&frame(QUERY));
        assert_eq!(
            rest,
            OtherBytes {
                segments: vec![received(frame(REPLY))],
                ..OtherBytes::default()
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
            OtherBytes {
                segments: vec![Segment::Junk(JunkBytes::new(&spoilt))],
                junk_bytes: 10,
                ..OtherBytes::default()
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
        assert_eq!(
            receiver.find(ID, Layout::Query, &frame(QUERY), false),
            Found::At(11)
        );
        let (_, before) = receiver.take(11, &frame(QUERY)).unwrap();
        assert_eq!(
            before,
            OtherBytes {
                echoed: 0,
                segments: vec![Segment::Junk(JunkBytes::new(&[0x33])), received(other)],
                junk_bytes: 1,
                ..OtherBytes::default()
            }
        );
    }

    /// Seed 12313 of the fault simulation. The frame that begins at its second byte has a good CRC too,
    /// with fault bits that no motor is known to set.
    #[test]
    fn a_stray_byte_behind_a_reply_makes_no_other_reply_of_it() {
        let id = MotorId::new(2).unwrap();
        let reply = frame("02 02 03 79 00 0A 74 57 00 ED");
        let query = frame("02 74 00 00 00 00 00 00 00 F1");
        let mut receiver = after(reply.bytes());
        receiver.push(&[0x85]);
        let Found::At(offset) = receiver.find(id, Layout::Query, &query, true) else {
            panic!("no reply");
        };
        let (found, _) = receiver.take(offset, &query).unwrap();
        assert_eq!(found.frame, reply);
    }

    /// Seed 304647: the same with faults that a motor may have, where the other window has none.
    #[test]
    fn of_two_readings_the_one_without_a_fault_is_taken() {
        let id = MotorId::new(3).unwrap();
        let reply = frame("03 03 01 6C 00 00 1C CA 00 11");
        let query = frame("03 74 00 00 00 00 00 00 00 55");
        let mut receiver = after(reply.bytes());
        receiver.push(&[0x4B]);
        assert_eq!(receiver.find(id, Layout::Query, &query, true), Found::At(0));
    }
}
