//! Who talks when, and who talks over whom.

use std::collections::VecDeque;

use motorlink_protocol::{FRAME_LEN, Instant};

use crate::random::Random;

use super::{FRAME_GAP, airtime, faults::Echo};

/// Bytes that a host may have queued: a third of a second of wire. What a host writes beyond it is
/// lost, as in an adapter whose buffer is full.
const QUEUED_MAX: usize = 4096;

/// Who sends a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Talker {
    Host,
    /// By its number in the world; addresses may be shared.
    Motor(u32),
}

/// A byte with its time.
#[derive(Clone, Copy, Debug)]
struct Byte {
    start: Instant,
    end: Instant,
    sent: u8,
    talker: Talker,
    /// Whether the host's receiver picks it up.
    audible: bool,
    /// Whether it is the tenth of a frame, after which somebody may have to act.
    ends_frame: bool,
    /// Whether another talker spoke a different byte at the same time.
    collides: bool,
}

/// A byte that has passed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passed {
    pub(crate) start: Instant,
    pub(crate) end: Instant,
    pub(crate) talker: Talker,
    /// As it left its talker.
    pub(crate) sent: u8,
    /// As it is heard.
    pub(crate) heard: u8,
    /// Whether the host's receiver picks it up.
    pub(crate) audible: bool,
    /// Whether another talker spoke a different byte at the same time.
    pub(crate) collides: bool,
}

/// What is on the wire now and what the host has queued for it, in order of time.
#[derive(Clone, Debug)]
pub(crate) struct Air {
    bytes: VecDeque<Byte>,
    /// When the host's last byte will have passed, and how many of its frame have been sent by then.
    host_until: Option<Instant>,
    host_place: usize,
    garbage: Random,
}

impl Air {
    pub(crate) const fn new(garbage: Random) -> Self {
        Self {
            bytes: VecDeque::new(),
            host_until: None,
            host_place: 0,
            garbage,
        }
    }

    /// The host writes; its bytes follow what it wrote before.
    pub(crate) fn host_sends(&mut self, now: Instant, bytes: &[u8], echo: Echo) {
        if bytes.is_empty() {
            return;
        }
        let room = QUEUED_MAX.saturating_sub(self.bytes.len());
        let start = self.host_until.map_or(now, |until| until.max(now));
        let gap = self
            .host_until
            .is_none_or(|until| start.since(until) > FRAME_GAP);
        if gap {
            self.host_place = 0;
        }
        for (count, byte) in bytes.iter().take(room).enumerate() {
            let place = self.host_place;
            self.host_place = (place + 1) % FRAME_LEN;
            let audible = echo.reaches(place);
            self.put(
                start,
                count,
                *byte,
                Talker::Host,
                audible,
                place + 1 == FRAME_LEN,
            );
        }
        self.host_until = Some(start + airtime(bytes.len().min(room)));
    }

    /// A motor starts to talk now. It does not look whether the wire is free.
    pub(crate) fn motor_sends(&mut self, now: Instant, motor: u32, bytes: &[u8]) {
        for (count, byte) in bytes.iter().enumerate() {
            let talker = Talker::Motor(motor);
            self.put(now, count, *byte, talker, true, count + 1 == bytes.len());
        }
    }

    fn put(
        &mut self,
        burst: Instant,
        count: usize,
        sent: u8,
        talker: Talker,
        audible: bool,
        ends_frame: bool,
    ) {
        let mut byte = Byte {
            start: burst + airtime(count),
            end: burst + airtime(count + 1),
            sent,
            talker,
            audible,
            ends_frame,
            collides: false,
        };
        for other in &mut self.bytes {
            let overlaps = other.start < byte.end && byte.start < other.end;
            // Two that drive the same levels at the same time do not disturb each other.
            let agrees = other.start == byte.start && other.sent == byte.sent;
            if other.talker != talker && overlaps && !agrees {
                other.collides = true;
                byte.collides = true;
            }
        }
        let place = self
            .bytes
            .partition_point(|other| other.start <= byte.start);
        self.bytes.insert(place, byte);
    }

    /// When the next byte will have passed.
    pub(crate) fn next_end(&self) -> Option<Instant> {
        self.bytes.front().map(|byte| byte.end)
    }

    /// When the next byte will have passed that completes a frame or leaves the wire silent.
    pub(crate) fn next_frame_end(&self) -> Option<Instant> {
        let of_frame = self.bytes.iter().find(|byte| byte.ends_frame);
        of_frame.or_else(|| self.bytes.back()).map(|byte| byte.end)
    }

    /// Takes the next byte off the wire.
    pub(crate) fn pass(&mut self) -> Option<Passed> {
        let byte = self.bytes.pop_front()?;
        let heard = if byte.collides {
            // Anything but what was sent.
            byte.sent ^ self.garbage.byte().max(1)
        } else {
            byte.sent
        };
        Some(Passed {
            start: byte.start,
            end: byte.end,
            talker: byte.talker,
            sent: byte.sent,
            heard,
            audible: byte.audible,
            collides: byte.collides,
        })
    }

    /// Whether a byte that the host hears is on the wire, or starts, at this moment.
    pub(crate) fn is_audible_at(&self, now: Instant) -> bool {
        let mut started = self.bytes.iter().take_while(|byte| byte.start <= now);
        started.any(|byte| byte.audible)
    }
}
