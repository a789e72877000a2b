//! A healthy line, or one injected fault as real lines have it.

use std::time::Duration;

use motorlink_protocol::{MotorId, family::Model};
use strum::VariantArray;

use crate::{config::MotorConfig, wire::Echo, wire::WireFaults};

/// One wrong bit in every tenth reply at 100 rpm: much, but a wheel can still be driven.
const NOISE_PER_RPM: f64 = 0.001;

/// Default of FTDI's latency timer.
const LATENCY_TIMER: Duration = Duration::from_millis(16);

/// Start angle of the second motor in degrees. At the angle of the first motor most replies would
/// be identical, and identical replies do not collide.
const TWIN_ANGLE_DEG: f32 = 137.0;

/// A motor that the host does not query.
const STRANGER: u8 = 7;

/// A healthy line, or one injected fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, VariantArray)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum LineCondition {
    /// Healthy.
    #[default]
    Good,
    /// No reply: no power, A and B exchanged, or a broken wire.
    Dead,
    /// The adapter receives only its own echo.
    EchoOnly,
    /// Two motors have ID 1 and reply at once.
    SharedId,
    /// The faster the fastest wheel turns, the more replies have a wrong bit.
    NoiseGrowsWithSpeed,
    /// The adapter holds received bytes for 16 ms.
    HoldsBytes,
    /// Motor 7 replies, which the host does not query.
    Stranger,
}

impl LineCondition {
    /// Every condition, the healthy one first.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// The faults of the wire.
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

    /// The second motor of [`SharedId`](Self::SharedId).
    pub(crate) fn twin(model: Model) -> MotorConfig {
        MotorConfig {
            angle_deg: TWIN_ANGLE_DEG,
            ..MotorConfig::of(model, MotorId::FIRST)
        }
    }
}
