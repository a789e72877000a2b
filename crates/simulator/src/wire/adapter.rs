//! The host's adapter: applies the faults and buffers received bytes.

use std::{collections::VecDeque, time::Duration};

use motorlink_protocol::{
    Celsius, FRAME_LEN, Frame, Instant, MotorId,
    family::{DriveReading, Faults, Model, Reading},
};

use crate::random::Random;

use super::{
    faults::{Beside, Echo, WireFaults},
    host_receiver::Run,
};

/// Chunks kept for a host that does not read; the oldest are dropped first, as in a serial driver.
const CHUNKS_MAX: usize = 1024;
/// Bytes at which a holding adapter delivers before its timer (a full USB packet of FTDI's chips).
const PACKET_MAX: usize = 62;

/// Mixed replies seem to come from one of this many lowest addresses.
const MIXED_IDS: u8 = 4;

/// Bytes that reach the host at one moment, as one read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chunk {
    /// Time of arrival.
    pub at: Instant,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// Faults, and chunks on their way to the host.
#[derive(Clone, Debug)]
pub(crate) struct Adapter {
    faults: WireFaults,
    chance: Random,
    /// In order of time.
    arriving: VecDeque<Chunk>,
    /// Bytes of a block that is not full.
    block: Vec<u8>,
    now: Instant,
    /// When the newest chunk arrives, also after the host has taken it.
    last: Instant,
}

impl Adapter {
    pub(crate) const fn new(faults: WireFaults, chance: Random) -> Self {
        Self {
            faults,
            chance,
            arriving: VecDeque::new(),
            block: Vec::new(),
            now: Instant::ZERO,
            last: Instant::ZERO,
        }
    }

    pub(crate) fn set_faults(&mut self, faults: WireFaults) {
        if faults.block != self.faults.block {
            // Another adapter, or another driver.
            self.block.clear();
        }
        self.faults = faults;
    }

    pub(crate) const fn echo(&self) -> Echo {
        self.faults.echo
    }

    pub(crate) const fn is_floating(&self) -> bool {
        self.faults.floating
    }

    /// A level that no driver holds is received as a byte.
    pub(crate) fn noise(&mut self, at: Instant) {
        self.now = at;
        self.arrive(at, &[0]);
    }

    /// A request on its way to the motors.
    pub(crate) fn request(&mut self, frame: Frame) -> Option<Frame> {
        if self.chance.chance(self.faults.lose_request) {
            return None;
        }
        let mut bytes = *frame.bytes();
        if self.chance.chance(self.faults.corrupt_request) {
            self.flip(&mut bytes);
        }
        Some(Frame::new(bytes))
    }

    /// A run of bytes that is over now, on its way to the host, while the fastest wheel turns at `fastest_rpm`. A motor that
    /// the host does not query is of this `model`.
    pub(crate) fn deliver(&mut self, now: Instant, run: Run, fastest_rpm: f32, model: Model) {
        self.now = now;
        let Run {
            echo: mut bytes,
            mut reply,
            end,
            mixed,
        } = run;
        let replied = !reply.is_empty();
        if mixed && self.chance.chance(self.faults.mix_answers) {
            self.mix(&mut reply);
        }
        if replied {
            if self.chance.chance(self.faults.lose_reply) {
                reply.clear();
            }
            let by_speed = self.faults.corrupt_reply_per_rpm * f64::from(fastest_rpm);
            if self.chance.chance(self.faults.corrupt_reply + by_speed) {
                self.flip(&mut reply);
            }
            self.add_strays(&mut reply);
            match self.faults.beside {
                Some(Beside::Before(byte)) => reply.insert(0, byte),
                Some(Beside::After(byte)) => reply.push(byte),
                None => {}
            }
        }
        bytes.append(&mut reply);
        self.split(end, &bytes);
        if let Some(id) = self.faults.stranger.filter(|_| replied) {
            self.arrive(
                end + model.frame_airtime(),
                of_a_stranger(model, id).bytes(),
            );
        }
    }

    /// The next chunk that has arrived by now.
    pub(crate) fn receive(&mut self, now: Instant) -> Option<Chunk> {
        if self.arriving.front()?.at > now {
            return None;
        }
        self.arriving.pop_front()
    }

    pub(crate) fn next_arrival(&self) -> Option<Instant> {
        self.arriving.front().map(|chunk| chunk.at)
    }

    /// Flips one bit of one byte.
    fn flip(&mut self, bytes: &mut [u8]) {
        let place = self.chance.below(bytes.len());
        let bit = self.chance.byte() % 8;
        if let Some(byte) = bytes.get_mut(place) {
            *byte ^= 1 << bit;
        }
    }

    /// Turns ten collided bytes into a good frame of one motor, chosen at random.
    fn mix(&mut self, reply: &mut [u8]) {
        let speaker = 1 + self.chance.byte() % MIXED_IDS;
        if let Some([id, body @ .., crc]) = reply.first_chunk_mut::<FRAME_LEN>() {
            let [mode, rest @ ..] = *body;
            let [b2, b3, b4, b5, b6, b7, b8] = rest;
            let frame = Frame::with_crc([speaker, mode, b2, b3, b4, b5, b6, b7, b8]);
            let [.., last] = *frame.bytes();
            (*id, *crc) = (speaker, last);
        }
    }

    fn add_strays(&mut self, reply: &mut Vec<u8>) {
        if !self.chance.chance(self.faults.stray) {
            return;
        }
        let count = 1 + self.chance.below(3);
        let place = if self.chance.chance(0.5) {
            0
        } else {
            reply.len()
        };
        for _ in 0..count {
            reply.insert(place, self.chance.byte());
        }
    }

    fn split(&mut self, end: Instant, bytes: &[u8]) {
        let Some(split) = self.faults.split else {
            return self.arrive(end, bytes);
        };
        let mut rest = bytes;
        let mut at = end;
        for _ in 1..split.pieces_max.min(FRAME_LEN) {
            if rest.len() < 2 {
                break;
            }
            let (piece, after) = rest.split_at(1 + self.chance.below(rest.len() - 1));
            self.arrive(at, piece);
            rest = after;
            at = at + split.gap_max.mul_f64(self.chance.unit());
        }
        self.arrive(at, rest);
    }

    /// Collects bytes to blocks, if the adapter does.
    fn arrive(&mut self, at: Instant, bytes: &[u8]) {
        let length = self.faults.block;
        if length < 2 {
            return self.queue(at, bytes);
        }
        self.block.extend_from_slice(bytes);
        while self.block.len() >= length {
            let rest = self.block.split_off(length);
            let block = std::mem::replace(&mut self.block, rest);
            self.queue(at, &block);
        }
    }

    /// Queues a piece after the ones before, held as long as the adapter holds bytes.
    fn queue(&mut self, at: Instant, bytes: &[u8]) {
        if bytes.is_empty() {
            return;
        }
        if self.faults.hold > Duration::ZERO {
            // The timer runs from the first byte held; what comes meanwhile goes with it.
            // A run with a collision ends before it is over. What the host may have read by then stays as it is.
            let open = at.max(self.now);
            let room = |chunk: &&mut Chunk| chunk.at > open && chunk.bytes.len() < PACKET_MAX;
            if let Some(held) = self.arriving.back_mut().filter(room) {
                held.bytes.extend_from_slice(bytes);
                if held.bytes.len() >= PACKET_MAX {
                    held.at = at;
                    self.last = at;
                }
                return;
            }
        }
        if self.arriving.len() >= CHUNKS_MAX {
            self.arriving.pop_front();
        }
        // Not of the queue: the host may have taken the one before.
        self.last = self.last.max(at + self.faults.hold);
        self.arriving.push_back(Chunk {
            at: self.last,
            bytes: bytes.to_vec(),
        });
    }
}

/// A reply at rest and at 30 degrees Celsius; in combined frames in the velocity loop.
fn of_a_stranger(model: Model, id: MotorId) -> Frame {
    if !model.has_separate_frames() {
        return Frame::with_crc([id.get(), 2, 0, 0, 0, 0, 30, 0, 0]);
    }
    let reading = Reading::Drive(DriveReading {
        id,
        value: 0,
        current: model.current_of_raw(0),
        acceleration: 0,
        temperature: Celsius::new(30),
        faults: Faults::of(model, 0),
    });
    reading.frame(model)
}
