//! Faults of a wire.

use std::{ops::Range, time::Duration};

use motorlink_protocol::{FRAME_LEN, MotorId};

use crate::random::Random;

/// Echo: whether the host's adapter receives its own bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Echo {
    /// No echo.
    #[default]
    Off,
    /// Every byte comes back.
    Whole,
    /// Only this many bytes at the front of every frame, before the driver silences the receiver.
    Cut(usize),
    /// At random nothing, every byte, the first bytes or the last bytes of each frame.
    Parts,
}

impl Echo {
    /// The places of the bytes of the next frame that come back.
    pub(crate) fn part(self, chance: &mut Random) -> Range<usize> {
        match self {
            Self::Off => 0..0,
            Self::Whole => 0..FRAME_LEN,
            Self::Cut(bytes) => 0..bytes,
            Self::Parts => {
                let bytes = 1 + chance.below(FRAME_LEN - 1);
                match chance.below(4) {
                    0 => 0..0,
                    1 => 0..FRAME_LEN,
                    2 => 0..bytes,
                    _ => FRAME_LEN - bytes..FRAME_LEN,
                }
            }
        }
    }
}

/// A byte that comes with every reply, as a driver makes that is switched too early or too late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beside {
    /// This byte directly before every reply.
    Before(u8),
    /// This byte directly after every reply.
    After(u8),
}

/// Delivery in pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Split {
    /// Most pieces. Less than 2 does nothing.
    pub pieces_max: usize,
    /// Longest delay of each later piece after the one before.
    pub gap_max: Duration,
}

impl Default for Split {
    /// Up to 3 pieces, up to 1 ms apart: a USB frame each.
    fn default() -> Self {
        Self {
            pieces_max: 3,
            gap_max: Duration::from_millis(1),
        }
    }
}

/// Faults of the wire. Probabilities are 0 to 1, per frame. Default: none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WireFaults {
    /// Echo of the host's bytes.
    pub echo: Echo,
    /// No motor receives a request.
    pub lose_request: f64,
    /// A reply does not reach the host.
    pub lose_reply: f64,
    /// One bit of a request is received wrong.
    pub corrupt_request: f64,
    /// One bit of a reply is received wrong.
    pub corrupt_reply: f64,
    /// The same per rpm of the fastest wheel: the motor current couples into a line that is not
    /// terminated or whose grounds differ.
    pub corrupt_reply_per_rpm: f64,
    /// Simultaneous replies are received as one frame with a good CRC that no motor sent. Chance
    /// does that to one collision in 256, of which one in a few has a known ID.
    pub mix_answers: f64,
    /// One to three bytes of noise come right before or after a reply.
    pub stray: f64,
    /// Received bytes arrive in pieces.
    pub split: Option<Split>,
    /// The adapter holds received bytes for this long after the first, like FTDI's latency timer
    /// (default there 16 ms). Zero holds nothing.
    pub hold: Duration,
    /// A good reply of this motor follows every reply, as if another host queried it. It collides
    /// with nothing.
    pub stranger: Option<MotorId>,
    /// A byte beside every reply.
    pub beside: Option<Beside>,
    /// The adapter delivers received bytes only in blocks of this many. Zero and one deliver at once.
    pub block: usize,
    /// Nothing holds the idle pair at a level: a byte 00 comes every 2 to 19 ms while no frame is on it.
    pub floating: bool,
}
