//! What may be wrong with a wire.

use std::time::Duration;

use motorlink_protocol::MotorId;

/// Whether the host's adapter hears what it sends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Echo {
    /// It does not.
    #[default]
    Off,
    /// Every byte comes back.
    Whole,
    /// Only so many bytes at the front of every frame come back, before its driver silences the
    /// receiver.
    Cut(usize),
}

impl Echo {
    /// Whether the byte at this place of a frame comes back.
    pub(crate) const fn reaches(self, place: usize) -> bool {
        match self {
            Self::Off => false,
            Self::Whole => true,
            Self::Cut(bytes) => place < bytes,
        }
    }
}

/// Delivery in pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Split {
    /// At most so many pieces. Less than 2 does nothing.
    pub pieces_max: usize,
    /// Each later piece comes up to so much after the one before it.
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

/// Faults round the wire. Probabilities are from 0 to 1, per frame. Default: a good wire.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WireFaults {
    /// What the host hears of itself.
    pub echo: Echo,
    /// A request is not heard by any motor.
    pub lose_request: f64,
    /// A reply does not reach the host.
    pub lose_reply: f64,
    /// One bit of a request is heard wrong.
    pub corrupt_request: f64,
    /// One bit of a reply is received wrong.
    pub corrupt_reply: f64,
    /// The same, more of it for each rpm of the fastest wheel: the motor's current is heard on the
    /// line, as where A and B are not terminated or the grounds lie apart.
    pub corrupt_reply_per_rpm: f64,
    /// Answers of several motors at once are received as one frame that nobody sent and whose CRC holds.
    /// Chance does that to one collision in 256, of which one in a few has a known ID.
    pub mix_answers: f64,
    /// One to three bytes of noise come right before or after a reply.
    pub stray: f64,
    /// What is received comes in pieces.
    pub split: Option<Split>,
    /// The adapter holds received bytes until so long after the first, as FTDI's latency timer does
    /// (16 ms by default there). Zero holds nothing.
    pub hold: Duration,
    /// Behind every reply comes a good one of this motor, as where another host asks it. It talks over
    /// nobody.
    pub stranger: Option<MotorId>,
}
