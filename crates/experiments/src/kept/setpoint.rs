//! A setpoint as a number with its unit, without loss.

use motorlink_protocol::{
    Acceleration, CurrentTarget, OpenLoopTarget, PositionTarget, Setpoint, SpeedTarget,
};

/// The unit, the raw value and the acceleration.
pub(super) const fn parts(setpoint: Setpoint) -> (&'static str, i32, u8) {
    match setpoint {
        Setpoint::Velocity {
            speed,
            acceleration,
        } => ("rpm", speed.rpm() as i32, acceleration.byte()),
        Setpoint::Brake => ("brake", 0, 0),
        Setpoint::Current(target) => ("current_raw", target.raw() as i32, 0),
        Setpoint::Position(target) => ("position_raw", target.raw() as i32, 0),
        Setpoint::OpenLoop(target) => ("open_loop_raw", target.raw() as i32, 0),
    }
}

/// The setpoint of such parts.
pub(super) fn of_parts(unit: &str, value: i32, acceleration: u8) -> Option<Setpoint> {
    Some(match unit {
        "rpm" => Setpoint::Velocity {
            speed: SpeedTarget::new(value).ok()?,
            acceleration: Acceleration::new(acceleration),
        },
        "brake" => Setpoint::Brake,
        "current_raw" => Setpoint::Current(CurrentTarget::new(value).ok()?),
        "position_raw" => Setpoint::Position(PositionTarget::new(value).ok()?),
        "open_loop_raw" => Setpoint::OpenLoop(OpenLoopTarget::new(value).ok()?),
        _ => return None,
    })
}
