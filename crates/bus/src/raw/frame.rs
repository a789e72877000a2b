//! State of the raw frame: sent once or repeatedly, under the same rules as any drive command.
//!
//! Its effect is judged by the bytes that a motor acts on, even if the frame is malformed: which
//! bytes a firmware checks is unknown.

use std::time::Duration;

use motorlink_protocol::{
    CurrentTarget, Frame, Instant, Mode, MotorId, Request,
    family::{FrameSet, Model},
};

use crate::{
    id_change::outcome::SetIdFrames,
    model::units,
    raw::hazard::is_hazardous,
    raw::status::{RawAnswer, RawStatus, Repeat},
    timing::PROOF_LIFETIME,
};

/// More set-ID frames in a row have no use.
const SET_ID_FRAMES_MAX: u32 = SetIdFrames::MAX.count() as u32;

/// The effect that a frame may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RawEffect {
    /// A query.
    Probe,
    /// A drive frame. The motor reads the value in its loop.
    Drive {
        /// Bytes 2 and 3.
        value: i16,
        /// Its size as a speed, in whole rpm, rounded up.
        rpm: u16,
    },
    /// A mode switch.
    Switch(Mode),
    /// A mode switch by its last byte, and one of another model by byte 2: `03 A0 09 .. 03` also disables a DDSM400.
    /// What a motor makes of it is unknown.
    MayBeSwitch(Mode),
    /// A set-ID frame: every motor on the bus takes the ID.
    SetId,
    /// Unknown.
    Unknown,
}

impl RawEffect {
    fn of(model: Model, frame: &Frame) -> Self {
        let &[first, command, high, low, .., last] = frame.bytes();
        if !is_hazardous(frame) {
            return Self::Probe;
        }
        match (first, command, high) {
            (0xAA, 0x55, 0x53) => Self::SetId,
            (_, 0x64, _) => {
                let value = i16::from_be_bytes([high, low]);
                let rpm = units::rpm_of_raw(model, value);
                Self::Drive { value, rpm }
            }
            (_, 0xA0, _) => {
                let (byte, other) = match model.spec().frames {
                    FrameSet::Combined => (last, high),
                    FrameSet::Separate { .. } => (high, 0),
                };
                match model.mode_of(byte) {
                    Some(mode) if other == 0 => Self::Switch(mode),
                    Some(mode) => Self::MayBeSwitch(mode),
                    None => Self::Unknown,
                }
            }
            _ => Self::Unknown,
        }
    }
}

/// A raw frame and its progress.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Raw {
    pub(crate) frame: Frame,
    pub(crate) effect: RawEffect,
    /// The only motor that may obey it; `None` if all may.
    pub(crate) addressee: Option<MotorId>,
    /// The motor's loop at the beginning, once it is known.
    pub(crate) began_in: Option<Mode>,
    pub(crate) since: Instant,
    /// For set-ID frames: the motor that must be alone, until the ID query has confirmed it.
    pub(crate) to_check: Option<MotorId>,
    count: u32,
    interval: Duration,
    next: Instant,
    sent: u32,
    answered: u32,
    running: bool,
    waits_for_loop: bool,
    last: Option<RawAnswer>,
}

impl Raw {
    pub(crate) fn begin(now: Instant, model: Model, frame: Frame, repeat: Repeat) -> Self {
        let (count, interval_ms) = match repeat {
            Repeat::Once => (1, 0),
            Repeat::Times { count, interval } => (count, interval.millis()),
        };
        let effect = RawEffect::of(model, &frame);
        let count = match (effect, count) {
            (RawEffect::SetId, 0) => SET_ID_FRAMES_MAX,
            (RawEffect::SetId, count) => count.min(SET_ID_FRAMES_MAX),
            (_, count) => count,
        };
        Self {
            frame,
            effect,
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
            waits_for_loop: false,
            last: None,
        }
    }

    /// The current that it asks of a motor in this loop, which may be unknown; `None` if it asks
    /// for none.
    pub(crate) fn current_in(&self, reported: Option<Mode>) -> Option<CurrentTarget> {
        match (self.effect, reported) {
            (RawEffect::Drive { value, .. }, None | Some(Mode::Current | Mode::OpenLoop)) => {
                // -32768 has no positive counterpart.
                CurrentTarget::new(i32::from(value).max(-i32::from(i16::MAX))).ok()
            }
            _ => None,
        }
    }

    /// When the next frame is due.
    pub(crate) fn next_frame(&self) -> Option<Instant> {
        self.running.then_some(self.next)
    }

    pub(crate) fn is_hazardous(&self) -> bool {
        self.effect != RawEffect::Probe
    }

    /// Whether a frame is pending that may move a wheel or change a motor.
    pub(crate) fn is_hazard_running(&self) -> bool {
        self.running && self.is_hazardous()
    }

    /// Whether this motor may move by it. Set-ID frames move no wheel.
    pub(crate) fn may_move(&self, id: MotorId) -> bool {
        let moves = !matches!(self.effect, RawEffect::Probe | RawEffect::SetId);
        moves && self.addressee.is_none_or(|addressee| addressee == id)
    }

    /// Whether its first frame was sent.
    pub(crate) const fn has_sent(&self) -> bool {
        self.sent > 0
    }

    pub(crate) fn sent(&mut self, now: Instant) {
        self.sent = self.sent.saturating_add(1);
        self.last = None;
        // On schedule, but a missed schedule is not caught up by a burst.
        self.next = (self.next + self.interval).max(now + self.interval / 2);
        // The proof that the motor is alone expires.
        let outlives_proof =
            self.effect == RawEffect::SetId && self.next > self.since + PROOF_LIFETIME;
        self.running = (self.count == 0 || self.sent < self.count) && !outlives_proof;
    }

    /// The answer to the last frame. An answer that arrives before the first frame belongs to an
    /// older one.
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

    /// The next frame waits until this time, or until a motor has named its loop.
    pub(crate) fn wait_until(&mut self, at: Instant) {
        self.next = at;
        self.waits_for_loop = true;
    }

    /// The motor has named its loop.
    pub(crate) fn end_wait(&mut self, now: Instant) {
        if std::mem::take(&mut self.waits_for_loop) {
            self.next = now;
        }
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

/// The only motor that may obey the frame, even if it is malformed. 0xC8 addresses every motor, at
/// least in the ID query; set-ID frames have no addressee.
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
    fn effect_and_addressee_of_a_frame_are_known_even_if_it_is_malformed() {
        let drive = |value: i16| RawEffect::Drive {
            value,
            rpm: value.unsigned_abs(),
        };
        for (text, motor, effect) in [
            ("01 64 00 64 00 00 00 00 00 4F", Some(1), drive(100)),
            ("05 64 80 00 01 00 01 00 00 00", Some(5), drive(i16::MIN)),
            ("C8 64 00 64 00 00 00 00 00 00", None, drive(100)),
            ("01 74 00 00 00 00 00 00 00 04", Some(1), RawEffect::Probe),
            ("01 74 00 00 00 00 00 00 00 05", Some(1), RawEffect::Unknown),
            (
                "C8 74 00 00 00 00 00 00 00 5F",
                Some(0xC8),
                RawEffect::Probe,
            ),
            ("C8 64 00 00 00 00 00 00 00 DE", None, RawEffect::Probe),
            (
                "02 A0 00 00 00 00 00 00 01 03",
                Some(2),
                RawEffect::Switch(Mode::Position),
            ),
            (
                "03 A0 09 00 00 00 00 00 00 03",
                Some(3),
                RawEffect::MayBeSwitch(Mode::Position),
            ),
            ("02 A0 00 00 00 00 00 00 00 09", Some(2), RawEffect::Unknown),
            ("07 99 00 00 00 00 00 00 00 00", Some(7), RawEffect::Unknown),
            ("AA 55 53 05 00 00 00 00 00 00", None, RawEffect::SetId),
            ("AA 55 53 C8 01 00 00 00 00 00", None, RawEffect::SetId),
            ("00 64 00 00 00 00 00 00 00 00", None, drive(0)),
        ] {
            let mut frame: Frame = text.parse().unwrap();
            if effect == RawEffect::Probe {
                let [body @ .., _] = *frame.bytes();
                frame = Frame::with_crc(body);
            }
            assert_eq!(addressee(&frame).map(MotorId::get), motor, "{text}");
            assert_eq!(RawEffect::of(Model::Ddsm115, &frame), effect, "{text}");
        }
    }

    #[test]
    fn a_repeated_frame_ends_after_its_count_and_zero_is_until_stopped() {
        let frame = "01 74 00 00 00 00 00 00 00 04".parse().unwrap();
        let interval = crate::RawInterval::new(20).unwrap();
        let mut now = Instant::ZERO;
        let mut three = Raw::begin(
            now,
            Model::Ddsm115,
            frame,
            Repeat::Times { count: 3, interval },
        );
        let mut endless = Raw::begin(
            now,
            Model::Ddsm115,
            frame,
            Repeat::Times { count: 0, interval },
        );
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
