//! What is known of the echo of an adapter, and which copies of a request are replies.

use motorlink_protocol::{
    FRAME_LEN, Frame, MotorId,
    family::{FrameSet, Model},
};

/// Byte 1 of a drive frame, and of the reply of a DDSM210 to it.
const DRIVE: u8 = 0x64;

/// So many replies in a row without an echo, and the adapter does not echo. One that echoes three of four frames shows
/// none of twelve once in 17 million connections.
const RULED_OUT: u8 = 12;

/// So many replies in a row without an echo, and an adapter that has echoed does not any more. One that echoes three of
/// four frames shows none of 24 once in 280 million million replies. A stop of one motor has so many within 1.1 s.
const CEASED: u8 = 24;

/// So many bytes of a request are its echo. One byte may be noise: a request and its reply begin with the same byte.
const PART_MIN: usize = 2;

/// So many replies in a row behind one byte of the echo, and that byte is no noise.
const CUT_TO_ONE: u8 = 3;

/// The echo of an adapter: none, whole, the first or the last bytes of a frame, the same each time or not.
///
/// A copy of a request is its reply in two cases only. It comes behind an echo: then both are there. Or the adapter has
/// not echoed a byte of the last requests, and nothing follows the copy in its window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Echo {
    /// Whether the adapter has echoed on this connection. Then it takes [`CEASED`] replies to rule the echo out.
    echoes: bool,
    /// Replies in a row without an echo before them.
    clean: u8,
    /// Replies in a row behind exactly one byte of the echo.
    cut_to_one: u8,
}

impl Echo {
    /// Records a reply that differs from its request, behind so many bytes of the echo.
    pub(super) fn replied(&mut self, part: usize) {
        let next = |count: u8, goes_on: bool| if goes_on { count.saturating_add(1) } else { 0 };
        self.clean = next(self.clean, part == 0);
        self.cut_to_one = next(self.cut_to_one, part == 1);
        self.echoes |= part >= PART_MIN;
    }

    /// Records an echo.
    pub(super) const fn detected(&mut self) {
        self.echoes = true;
        self.clean = 0;
    }

    /// Whether the adapter does not echo, or does not any more.
    pub(super) const fn is_ruled_out(self) -> bool {
        self.clean >= if self.echoes { CEASED } else { RULED_OUT }
    }

    /// Whether it is not known if the adapter echoes.
    pub(super) const fn is_unknown(self) -> bool {
        !self.echoes && self.clean < RULED_OUT
    }

    /// Whether a copy of the request behind so many bytes of its echo is the reply.
    pub(super) const fn proves_reply(self, part: usize) -> bool {
        part >= PART_MIN || (part == 1 && self.cut_to_one >= CUT_TO_ONE)
    }
}

/// The longest part of the echo of `sent` in the bytes before its reply, in bytes. A single byte counts only as the
/// first one and directly before the reply.
pub(super) fn part_before(before: &[u8], sent: &Frame) -> usize {
    let sent = sent.bytes();
    let part_at = |from: usize| {
        let rest = before.get(from..).unwrap_or_default();
        let is_head = |length: &usize| rest.get(..*length) == sent.get(..*length);
        let is_tail =
            |length: &usize| rest.get(..*length) == sent.get(FRAME_LEN.saturating_sub(*length)..);
        let lengths = (PART_MIN..=FRAME_LEN.min(rest.len())).rev();
        lengths
            .into_iter()
            .find(|length| is_head(length) || is_tail(length))
    };
    let longest = (0..before.len()).filter_map(part_at).max();
    longest.unwrap_or_else(|| usize::from(before.last() == sent.first()))
}

/// So many of the first bytes are the last ones of `sent`, if they are an echo.
pub(super) fn tail_at_front(bytes: &[u8], sent: &Frame) -> usize {
    let lengths = (PART_MIN..FRAME_LEN).rev();
    let is_tail = |length: &usize| bytes.get(..*length) == sent.bytes().get(FRAME_LEN - *length..);
    lengths.into_iter().find(is_tail).unwrap_or(0)
}

/// Whether a window of a model with separate frames is the echo of `sent`, and not its reply, as far as they differ.
///
/// A cut echo and noise behind it may have a good CRC. Then the window begins like the request, and what no motor
/// reports stands in it: the brake in place of the temperature, or faults that the model does not have.
pub(super) fn is_echo(model: Model, window: &[u8; FRAME_LEN], sent: &Frame) -> bool {
    let sent = sent.bytes();
    let same = window
        .iter()
        .zip(sent)
        .take_while(|(one, other)| one == other);
    let &[_, command, .., faults, _] = window;
    let names: u8 = model.spec().faults.iter().map(|fault| fault.mask()).sum();
    match same.count() {
        FRAME_LEN => true,
        8.. if command == DRIVE => true,
        6.. => faults & !names != 0,
        _ => false,
    }
}

/// Whether a reply of this model can be identical to this request.
pub(super) fn may_be_reply(model: Model, sent: &Frame) -> bool {
    let FrameSet::Separate { reply_offset: 0 } = model.spec().frames else {
        return false;
    };
    let &[id, command, .., temperature, _, _] = sent.bytes();
    // The byte of the brake is the temperature of a reply.
    let is_hot = command == DRIVE && temperature == 0xFF;
    id != 0xC8 && MotorId::new(id).is_ok() && !is_hot
}
