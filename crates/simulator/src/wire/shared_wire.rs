//! The shared wire: which byte is sent when, and which bytes collide.

use std::{collections::VecDeque, ops::Range};

use motorlink_protocol::{FRAME_LEN, Instant};

use crate::random::Random;

use super::{
    faults::Echo,
    timing::{FRAME_GAP, airtime},
};

/// Most bytes that a host may queue: a third of a second of wire. More is lost, as in an adapter
/// with a full buffer.
const QUEUED_MAX: usize = 4096;

/// Who sends a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
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
    source: Source,
    /// Whether the host's adapter receives it.
    audible: bool,
    /// Whether it is the last byte of a frame.
    ends_frame: bool,
    /// Whether another source sends a different byte at the same time.
    collides: bool,
}

/// A byte that has passed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PassedByte {
    pub(crate) start: Instant,
    pub(crate) end: Instant,
    pub(crate) source: Source,
    /// The byte as sent.
    pub(crate) sent: u8,
    /// The byte as received.
    pub(crate) received: u8,
    /// Whether the host's adapter receives it.
    pub(crate) audible: bool,
    /// Whether another source sends a different byte at the same time.
    pub(crate) collides: bool,
}

/// Bytes on the wire and bytes that the host has queued, in order of time.
#[derive(Clone, Debug)]
pub(crate) struct SharedWire {
    bytes: VecDeque<Byte>,
    /// When the host's last byte has passed, and how many bytes of its frame are sent by then.
    host_until: Option<Instant>,
    host_place: usize,
    /// The places of the present frame of the host that come back.
    echoed: Range<usize>,
    garbage: Random,
    parts: Random,
    baud: u32,
}

impl SharedWire {
    /// `garbage` are the bytes of collisions, `parts` the parts of frames that are echoed.
    pub(crate) const fn new(baud: u32, garbage: Random, parts: Random) -> Self {
        Self {
            baud,
            bytes: VecDeque::new(),
            host_until: None,
            host_place: 0,
            echoed: 0..0,
            garbage,
            parts,
        }
    }

    /// Bits a second.
    pub(crate) const fn baud(&self) -> u32 {
        self.baud
    }

    /// Changes the baud; bytes on their way are not affected.
    pub(crate) const fn set_baud(&mut self, baud: u32) {
        self.baud = baud;
    }

    /// Queues bytes of the host after its earlier bytes.
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
            if place == 0 {
                self.echoed = echo.part(&mut self.parts);
            }
            let audible = self.echoed.contains(&place);
            self.put(
                start,
                count,
                *byte,
                Source::Host,
                audible,
                place + 1 == FRAME_LEN,
            );
        }
        self.host_until = Some(start + airtime(self.baud(), bytes.len().min(room)));
    }

    /// A motor sends now. It does not check whether the wire is free.
    pub(crate) fn motor_sends(&mut self, now: Instant, motor: u32, bytes: &[u8]) {
        for (count, byte) in bytes.iter().enumerate() {
            let source = Source::Motor(motor);
            self.put(now, count, *byte, source, true, count + 1 == bytes.len());
        }
    }

    fn put(
        &mut self,
        burst: Instant,
        count: usize,
        sent: u8,
        source: Source,
        audible: bool,
        ends_frame: bool,
    ) {
        let mut byte = Byte {
            start: burst + airtime(self.baud(), count),
            end: burst + airtime(self.baud(), count + 1),
            sent,
            source,
            audible,
            ends_frame,
            collides: false,
        };
        for other in &mut self.bytes {
            let overlaps = other.start < byte.end && byte.start < other.end;
            // Two sources that drive the same levels at the same time do not collide.
            let agrees = other.start == byte.start && other.sent == byte.sent;
            if other.source != source && overlaps && !agrees {
                other.collides = true;
                byte.collides = true;
            }
        }
        let place = self
            .bytes
            .partition_point(|other| other.start <= byte.start);
        self.bytes.insert(place, byte);
    }

    /// When the next byte has passed.
    pub(crate) fn next_end(&self) -> Option<Instant> {
        self.bytes.front().map(|byte| byte.end)
    }

    /// When the next byte has passed that completes a frame or leaves the wire silent.
    pub(crate) fn next_frame_end(&self) -> Option<Instant> {
        let of_frame = self.bytes.iter().find(|byte| byte.ends_frame);
        of_frame.or_else(|| self.bytes.back()).map(|byte| byte.end)
    }

    /// Removes the next byte from the wire.
    pub(crate) fn pass(&mut self) -> Option<PassedByte> {
        let byte = self.bytes.pop_front()?;
        let received = if byte.collides {
            // Any byte except the one sent.
            byte.sent ^ self.garbage.byte().max(1)
        } else {
            byte.sent
        };
        Some(PassedByte {
            start: byte.start,
            end: byte.end,
            source: byte.source,
            sent: byte.sent,
            received,
            audible: byte.audible,
            collides: byte.collides,
        })
    }

    /// Whether a byte is on the wire at this time, or is followed by one.
    pub(crate) fn is_busy_at(&self, now: Instant) -> bool {
        self.bytes.front().is_some_and(|byte| byte.start <= now)
    }

    /// Whether a byte that the host receives is on the wire at this time, or starts then.
    pub(crate) fn is_audible_at(&self, now: Instant) -> bool {
        let mut started = self.bytes.iter().take_while(|byte| byte.start <= now);
        started.any(|byte| byte.audible)
    }
}
