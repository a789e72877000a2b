//! The signs of motors that are mounted mirrored: a run has those of the operator, the wire the opposite ones.

use motorlink_protocol::{Current, CurrentTarget, Setpoint, SpeedTarget};

use super::Telemetry;

/// The setpoint with the opposite sign of speed and current. Angles and the brake do not change.
pub(super) fn reversed(setpoint: Setpoint) -> Setpoint {
    match setpoint {
        Setpoint::Velocity {
            speed,
            acceleration,
        } => Setpoint::Velocity {
            speed: SpeedTarget::clamped(-i32::from(speed.rpm())),
            acceleration,
        },
        // The range is symmetric, so the result is in range.
        Setpoint::Current(target) => {
            Setpoint::Current(CurrentTarget::new(-i32::from(target.raw())).unwrap_or_default())
        }
        Setpoint::OpenLoop(target) => Setpoint::OpenLoop(target.reversed()),
        other => other,
    }
}

impl Telemetry {
    /// The reply with the angle that counts the other way, as speed and current do.
    pub(super) fn with_turned_angle(self) -> Self {
        Self {
            degrees: self.degrees.map(|degrees| (360.0 - degrees) % 360.0),
            ..self
        }
    }

    /// The reply with the opposite sign of speed and current.
    pub(super) fn reversed(self) -> Self {
        Self {
            rpm: self.rpm.map(i16::saturating_neg),
            current: self
                .current
                .map(|current| Current::from_raw(current.raw().saturating_neg())),
            ..self
        }
    }
}
