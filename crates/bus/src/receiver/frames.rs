//! Good frames in bytes.

use motorlink_protocol::{
    FRAME_LEN, Frame, Mode, MotorId,
    family::{FrameSet, Layout, Model, Reading},
};

use super::ReceivedReply;
use crate::model::foreign_text::is_text;

/// The fault byte of a reply, and its bits that no motor is known to set (`motor.md`).
const FAULT_BYTE: usize = 8;
const RESERVED: u8 = 0b1110_0000;

/// Byte 1 of the replies of a DDSM210.
const DRIVE: u8 = 0x64;
const ODOMETRY: u8 = 0x74;
const MODE: u8 = 0x75;
const SWITCH: u8 = 0xA0;

/// A window of ten bytes that is a good frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) offset: usize,
    /// Whether more bytes may show that another window is the true one.
    pub(super) is_open: bool,
    /// Whether another window is as likely, so that neither is a reply.
    pub(super) is_unclear: bool,
}

/// The next good frame at or after `from`.
///
/// Two overlapping windows cannot both be true: about one in 256 windows that begin like a reply
/// has a good CRC by chance, behind a truncated echo or across two frames. The first is the true
/// one, unless it is not part of a row of frames and there is a reason for the other: fewer faults are in it, a frame
/// follows it directly, an echo of `sent` stands directly before it, or it ends where the bytes end. If the other has more
/// faults, but the echo before it and nothing behind it, they cannot be told apart: the motor may have that fault.
pub(super) fn next_window(model: Model, bytes: &[u8], from: usize, sent: &Frame) -> Option<Window> {
    let is_good = |offset: usize| replier_at(model, bytes, offset).is_some();
    let first = (from..bytes.len()).find(|offset| is_good(*offset))?;
    let ends_at = |offset: usize| offset + FRAME_LEN == bytes.len();
    let follows_echo = |offset: usize| {
        (1..=FRAME_LEN).any(|length| {
            let begins = offset.checked_sub(length).filter(|begins| *begins <= first);
            begins.is_some_and(|begins| {
                let before = bytes.get(begins..offset);
                let is_tail = length > 1 && before == sent.bytes().get(FRAME_LEN - length..);
                before == sent.bytes().get(..length) || is_tail
            })
        })
    };
    let mut offset = first;
    let mut is_open = false;
    let mut is_unclear = false;
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
        let is_likely = |rival: &usize| {
            let (own, of_first) = (doubt(*rival), doubt(first));
            own < of_first || (own == of_first && has_reason(rival))
        };
        // After a truncated echo the true reply is the last one.
        offset = rivals().rfind(is_likely).unwrap_or(first);
        let may_be_followed = first + 2 * FRAME_LEN > bytes.len();
        let is_settled = offset != first && follows_echo(offset) && ends_at(offset);
        is_open = rivals().next().is_some() && may_be_followed && !is_settled;
        let explains_all = |rival: usize| follows_echo(rival) && ends_at(rival) && doubt(rival) < 2;
        is_unclear = offset == first && rivals().any(explains_all);
    }
    Some(Window {
        offset,
        is_open,
        is_unclear,
    })
}

/// Byte 1 of a reply in this layout, if it has a fixed one.
pub(crate) const fn reply_byte(model: Model, layout: Layout) -> Option<u8> {
    let FrameSet::Separate { reply_offset } = model.spec().frames else {
        return None;
    };
    let of_a_ddsm210 = match layout {
        Layout::Drive => DRIVE,
        Layout::Query => ODOMETRY,
        Layout::Mode => MODE,
        Layout::Switch => SWITCH,
    };
    Some(of_a_ddsm210 + reply_offset)
}

/// Whether a reply of this model has this byte 1.
pub(super) fn begins_reply(model: Model, byte: u8) -> bool {
    match model.spec().frames {
        FrameSet::Combined => Mode::from_byte(byte).is_ok(),
        FrameSet::Separate { reply_offset } => {
            matches!(
                byte.wrapping_sub(reply_offset),
                DRIVE | ODOMETRY | MODE | SWITCH
            )
        }
    }
}

/// The motor whose reply begins at `offset`: byte 1, CRC and ID are those of a reply, one that names the loop names
/// nothing else, and not every byte is text, as in no reply: its faults or the upper byte of its turns are lower. The
/// search tries every offset, so it checks these bytes and decodes none.
pub(super) fn replier_at(model: Model, bytes: &[u8], offset: usize) -> Option<MotorId> {
    // Byte 1 before the CRC: it rules out most offsets.
    if !begins_reply(model, *bytes.get(offset + 1)?) {
        return None;
    }
    let frame = frame_at(bytes, offset).filter(Frame::crc_holds)?;
    let &[id, command, _, rest @ ..] = frame.bytes();
    if let FrameSet::Separate { reply_offset } = model.spec().frames
        && matches!(command.wrapping_sub(reply_offset), MODE | SWITCH)
        && !matches!(rest, [0, 0, 0, 0, 0, 0, _])
    {
        return None;
    }
    if frame.bytes().iter().copied().all(is_text) {
        return None;
    }
    MotorId::new(id).ok()
}

/// The reply that begins at `offset`, decoded.
pub(super) fn reply_at(model: Model, bytes: &[u8], offset: usize) -> Option<ReceivedReply> {
    let frame = frame_at(bytes, offset)?;
    let reading = Reading::decode(model, &frame, None).ok()?;
    Some(ReceivedReply { frame, reading })
}

pub(super) fn frame_at(bytes: &[u8], offset: usize) -> Option<Frame> {
    let window = bytes.get(offset..offset + FRAME_LEN)?;
    window.try_into().ok().map(Frame::new)
}
