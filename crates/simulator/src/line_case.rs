//! Lines that are ill in the ways in which real ones are.

use std::time::Duration;

use motorlink_protocol::MotorId;

use crate::{Echo, MotorConfig, WireFaults};

/// A bit of every tenth reply is wrong at 100 rpm: much, and yet a wheel can be driven.
const NOISE_PER_RPM: f64 = 0.001;

/// What FTDI's latency timer is set to by default.
const LATENCY_TIMER: Duration = Duration::from_millis(16);

/// Where the reported angle of a second motor starts, in degrees: with the angle of the first, most of
/// its replies would be the same to the bit, and two that say the same do not collide.
const TWIN_ANGLE_DEG: f32 = 137.0;

/// A motor that nobody asks.
const STRANGER: u8 = 7;

/// A line that is well, or ill in one way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LineCase {
    /// Nothing is wrong.
    #[default]
    Good,
    /// Nothing comes: no power, A and B exchanged, or a wire off.
    Dead,
    /// The adapter hears itself and nobody else.
    EchoOnly,
    /// A second motor has the ID 1, and both answer at once.
    SharedId,
    /// The faster the fastest wheel turns, the more replies have a wrong bit.
    NoiseGrowsWithSpeed,
    /// The adapter holds what it has received for 16 ms.
    HoldsBytes,
    /// Motor 7 is heard, which nobody asks.
    Stranger,
}

impl LineCase {
    /// Every case, the good one first.
    pub const ALL: [Self; 7] = [
        Self::Good,
        Self::Dead,
        Self::EchoOnly,
        Self::SharedId,
        Self::NoiseGrowsWithSpeed,
        Self::HoldsBytes,
        Self::Stranger,
    ];

    /// What is wrong with the wire, apart from who is on it.
    #[must_use]
    pub fn faults(self) -> WireFaults {
        let good = WireFaults::default();
        match self {
            Self::Good | Self::SharedId => good,
            Self::Dead => WireFaults {
                lose_request: 1.0,
                ..good
            },
            Self::EchoOnly => WireFaults {
                echo: Echo::Whole,
                lose_request: 1.0,
                ..good
            },
            Self::NoiseGrowsWithSpeed => WireFaults {
                corrupt_reply_per_rpm: NOISE_PER_RPM,
                ..good
            },
            Self::HoldsBytes => WireFaults {
                hold: LATENCY_TIMER,
                ..good
            },
            Self::Stranger => WireFaults {
                stranger: MotorId::new(STRANGER).ok(),
                ..good
            },
        }
    }

    /// The motor that is there beside the others in [`SharedId`](Self::SharedId).
    pub(crate) fn twin() -> MotorConfig {
        MotorConfig {
            angle_deg: TWIN_ANGLE_DEG,
            ..MotorConfig::new(MotorId::FIRST)
        }
    }
}
