//! Frames that a person wrote: sent once or again and again, under the same rules as any driving.
//!
//! What such a frame may do is judged by the bytes that a motor acts on, not by whether it is well
//! formed: it is not known which bytes a firmware checks.

use std::time::Duration;

use motorlink_protocol::{CurrentTarget, Frame, Instant, Mode, MotorId, Request};

use crate::{
    id_change::outcome::SetIdFrames,
    raw::hazard::is_hazardous,
    raw::status::{RawAnswer, RawStatus, Repeat},
    timing::PROOF_LASTS,
};

/// More set-ID frames in a row are of no use.
const SET_ID_FRAMES_MAX: u32 = SetIdFrames::MAX.count() as u32;

/// What a frame may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Deed {
    /// It only asks.
    Ask,
    /// It drives a motor to a value that the motor reads by its loop.
    Drive {
        /// Bytes 2 and 3.
        value: i16,
    },
    /// It closes another loop.
    Switch(Mode),
    /// It gives every motor that hears it another ID.
    SetId,
    /// Nobody knows.
    Unknown,
}

impl Deed {
    fn of(frame: &Frame) -> Self {
        let &[first, command, high, low, .., last] = frame.bytes();
        if !is_hazardous(frame) {
            return Self::Ask;
        }
        match (first, command, high) {
            (0xAA, 0x55, 0x53) => Self::SetId,
            (_, 0x64, _) => Self::Drive {
                value: i16::from_be_bytes([high, low]),
            },
            (_, 0xA0, _) => Mode::from_byte(last).map_or(Self::Unknown, Self::Switch),
            _ => Self::Unknown,
        }
    }
}

/// A frame that a person wrote, and how often it went out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Raw {
    pub(crate) frame: Frame,
    pub(crate) deed: Deed,
    /// The one motor that may obey it; `None` where all may.
    pub(crate) addressee: Option<MotorId>,
    /// The loop that its motor was in when it began, as soon as that is known.
    pub(crate) began_in: Option<Mode>,
    pub(crate) since: Instant,
    /// For set-ID frames: the motor that has to be alone, until the ID query has said so once more.
    pub(crate) to_check: Option<MotorId>,
    count: u32,
    interval: Duration,
    next: Instant,
    sent: u32,
    answered: u32,
    running: bool,
    last: Option<RawAnswer>,
}

impl Raw {
    pub(crate) fn begin(now: Instant, frame: Frame, repeat: Repeat) -> Self {
        let (count, interval_ms) = match repeat {
            Repeat::Once => (1, 0),
            Repeat::Times { count, interval } => (count, interval.millis()),
        };
        let deed = Deed::of(&frame);
        let count = match (deed, count) {
            (Deed::SetId, 0) => SET_ID_FRAMES_MAX,
            (Deed::SetId, count) => count.min(SET_ID_FRAMES_MAX),
            (_, count) => count,
        };
        Self {
            frame,
            deed,
            addressee: addressee(&frame),
            began_in: None,
            since: now,
            to_check: None,
            count,
            interval: Duration::from_millis(interval_ms.into()),
            next: now,
            sent: 0,
            answered: 0,
            running: true,
            last: None,
        }
    }

    /// The current that it asks of a motor in this loop, which may be unknown; `None` where it asks for none.
    pub(crate) fn current_in(&self, reported: Option<Mode>) -> Option<CurrentTarget> {
        match (self.deed, reported) {
            (Deed::Drive { value }, None | Some(Mode::Current)) => {
                // The lowest value of all has no positive twin.
                CurrentTarget::new(i32::from(value).max(-i32::from(i16::MAX))).ok()
            }
            _ => None,
        }
    }

    /// When it is to be sent next.
    pub(crate) fn next_frame(&self) -> Option<Instant> {
        self.running.then_some(self.next)
    }

    pub(crate) fn is_hazardous(&self) -> bool {
        self.deed != Deed::Ask
    }

    /// Whether a frame that may move a wheel or change a motor is still to be sent.
    pub(crate) fn is_hazard_running(&self) -> bool {
        self.running && self.is_hazardous()
    }

    /// Whether this motor may obey it. Set-ID frames move nobody.
    pub(crate) fn may_move(&self, id: MotorId) -> bool {
        let moves = !matches!(self.deed, Deed::Ask | Deed::SetId);
        moves && self.addressee.is_none_or(|addressee| addressee == id)
    }

    pub(crate) fn sent(&mut self, now: Instant) {
        self.sent = self.sent.saturating_add(1);
        self.last = None;
        // On schedule where it is kept, without a burst where it was not.
        self.next = (self.next + self.interval).max(now + self.interval / 2);
        // Who is on the bus was proved for so long.
        let outlives_proof = self.deed == Deed::SetId && self.next > self.since + PROOF_LASTS;
        self.running = (self.count == 0 || self.sent < self.count) && !outlives_proof;
    }

    /// What came after the last one. An answer to the frame before this is none.
    pub(crate) fn answered(&mut self, answer: RawAnswer) {
        if self.sent == 0 {
            return;
        }
        if let RawAnswer::Reply { .. } = answer {
            self.answered = self.answered.saturating_add(1);
        }
        self.last = Some(answer);
    }

    pub(crate) fn stop(&mut self) {
        self.running = false;
    }

    pub(crate) const fn status(&self) -> RawStatus {
        RawStatus {
            frame: self.frame,
            count: self.count,
            sent: self.sent,
            answered: self.answered,
            running: self.running,
            last: self.last,
        }
    }
}

/// The motor that may obey it, whatever is wrong with it. 0xC8 is everyone's address, at least in the
/// ID query, and set-ID frames have none.
pub(crate) fn addressee(frame: &Frame) -> Option<MotorId> {
    let &[first, command, third, ..] = frame.bytes();
    let is_query = matches!(Request::parse(frame), Ok(Request::Query { .. }));
    match (first, command, third) {
        (0xAA, 0x55, 0x53) => None,
        (0xC8, ..) if !is_query => None,
        _ => MotorId::new(first).ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_frame_may_do_and_to_whom_is_known_whatever_is_wrong_with_it() {
        let drive = |value| Deed::Drive { value };
        for (text, motor, deed) in [
            ("01 64 00 64 00 00 00 00 00 4F", Some(1), drive(100)),
            ("05 64 80 00 01 00 01 00 00 00", Some(5), drive(i16::MIN)),
            ("C8 64 00 64 00 00 00 00 00 00", None, drive(100)),
            ("01 74 00 00 00 00 00 00 00 04", Some(1), Deed::Ask),
            ("01 74 00 00 00 00 00 00 00 05", Some(1), Deed::Unknown),
            ("C8 74 00 00 00 00 00 00 00 5F", Some(0xC8), Deed::Ask),
            ("C8 64 00 00 00 00 00 00 00 DE", None, Deed::Ask),
            (
                "02 A0 00 00 00 00 00 00 01 03",
                Some(2),
                Deed::Switch(Mode::Position),
            ),
            ("02 A0 00 00 00 00 00 00 00 09", Some(2), Deed::Unknown),
            ("07 99 00 00 00 00 00 00 00 00", Some(7), Deed::Unknown),
            ("AA 55 53 05 00 00 00 00 00 00", None, Deed::SetId),
            ("AA 55 53 C8 01 00 00 00 00 00", None, Deed::SetId),
            ("00 64 00 00 00 00 00 00 00 00", None, drive(0)),
        ] {
            let mut frame: Frame = text.parse().unwrap();
            if deed == Deed::Ask {
                let [body @ .., _] = *frame.bytes();
                frame = Frame::with_crc(body);
            }
            assert_eq!(addressee(&frame).map(MotorId::get), motor, "{text}");
            assert_eq!(Deed::of(&frame), deed, "{text}");
        }
    }

    #[test]
    fn a_repeated_frame_ends_after_its_count_and_zero_is_until_stopped() {
        let frame = "01 74 00 00 00 00 00 00 00 04".parse().unwrap();
        let interval = crate::RawInterval::new(20).unwrap();
        let mut now = Instant::ZERO;
        let mut three = Raw::begin(now, frame, Repeat::Times { count: 3, interval });
        let mut endless = Raw::begin(now, frame, Repeat::Times { count: 0, interval });
        for _ in 0..3 {
            assert_eq!(three.next_frame(), Some(now));
            three.sent(now);
            endless.sent(now);
            now = now + Duration::from_millis(20);
        }
        assert_eq!(three.next_frame(), None);
        assert_eq!(endless.next_frame(), Some(now));
        endless.stop();
        assert_eq!(endless.next_frame(), None);
    }
}
