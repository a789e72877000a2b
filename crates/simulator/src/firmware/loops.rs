//! The three loops and the brake: from a drive frame's value to the power stage.

use std::f64::consts::TAU;

use motorlink_protocol::{
    Drive, PositionTarget,
    family::{Model, OpenLoopTarget},
};

use crate::{
    figures::Figures,
    physics::{Bridge, STEP_S, Winding, rad_s, rpm},
};

use super::{
    sense::Sense,
    speed_loop::SpeedLoop,
    speed_profile::{SpeedProfile, towards},
};

/// Position loop: rad/s per radian of error. Half a turn takes 0.8 s to within a degree.
const POSITION_GAIN_PER_S: f64 = 8.0;
/// Position loop: its greatest speed (120 rpm).
const POSITION_SPEED_MAX_RAD_S: f64 = 12.6;
/// Position loop: its greatest change of speed, 0.3 N.m in the wheel's inertia.
const POSITION_ACCEL_RAD_S2: f64 = 300.0;
/// Position loop: an error above this means that motion is wanted (3 degrees).
const POSITION_MOVES_RAD: f64 = 0.052;
/// Velocity loop: a target above this means that motion is wanted.
const VELOCITY_MOVES_RPM: f64 = 0.5;
/// Current loop: a current above this moves a free wheel for sure (bearing friction takes 0.002 A).
const CURRENT_MOVES_A: f64 = 0.1;

/// The active loop with what it remembers.
#[derive(Clone, Debug)]
pub(crate) enum Loops {
    /// Nothing is driven.
    Idle,
    /// Shorted windings.
    Brake,
    /// Velocity.
    Velocity {
        profile: SpeedProfile,
        speed: SpeedLoop,
        target_rpm: f64,
    },
    /// Torque current, or what flows in the open loop.
    Current { amps: f64 },
    /// Angle.
    Position {
        wanted_rad_s: f64,
        speed: SpeedLoop,
        error_rad: f64,
    },
}

impl Loops {
    /// Whether the command asks the wheel to turn, so that a standing wheel is a blocked one.
    pub(crate) fn want_motion(&self) -> bool {
        match self {
            Self::Idle | Self::Brake => false,
            Self::Velocity { target_rpm, .. } => target_rpm.abs() > VELOCITY_MOVES_RPM,
            Self::Current { amps } => amps.abs() > CURRENT_MOVES_A,
            Self::Position { error_rad, .. } => error_rad.abs() > POSITION_MOVES_RAD,
        }
    }

    /// Whether no current flows in a standing wheel, for good.
    pub(crate) const fn are_passive(&self) -> bool {
        matches!(self, Self::Idle | Self::Brake)
    }

    pub(crate) fn brake(&mut self) -> Bridge {
        *self = Self::Brake;
        Bridge::Short
    }

    /// Zero is no torque at all: the wheel coasts.
    pub(crate) fn current(&mut self, model: Model, drive: Drive) -> Bridge {
        let amps = f64::from(model.current_of_raw(drive.signed()).amps());
        let amps = limited(amps, Figures::of(model).current_limit_a);
        *self = Self::Current { amps };
        if amps == 0.0 {
            Bridge::Open
        } else {
            Bridge::Drive { amps }
        }
    }

    /// The voltage follows the frame at once; what flows is limited as in any loop.
    pub(crate) fn open_loop(&mut self, drive: Drive, sense: &Sense, winding: Winding) -> Bridge {
        let share = f64::from(drive.signed()) / f64::from(OpenLoopTarget::MAX);
        let amps = winding.amps_at(limited(share, 1.0), sense.speed_rad_s);
        *self = Self::Current { amps };
        if share == 0.0 {
            // Nothing says whether the windings are open or shorted at zero: assumed open.
            Bridge::Open
        } else {
            Bridge::Drive { amps }
        }
    }

    pub(crate) fn velocity(&mut self, model: Model, drive: Drive, sense: &Sense) -> Bridge {
        let actual_rpm = rpm(sense.speed_rad_s);
        let spec = model.spec();
        let wanted_rpm = f64::from(drive.signed()) / f64::from(spec.speed_units_per_rpm);
        let wanted_rpm = limited(wanted_rpm, f64::from(spec.speed_rpm_max));
        if !matches!(self, Self::Velocity { .. }) {
            *self = Self::Velocity {
                profile: SpeedProfile::from(actual_rpm),
                speed: SpeedLoop::default(),
                target_rpm: wanted_rpm,
            };
        }
        let Self::Velocity {
            profile,
            speed,
            target_rpm,
        } = self
        else {
            return Bridge::Open;
        };
        *target_rpm = wanted_rpm;
        // 0 is the motor's default, which is 1.
        let units = f64::from(drive.acceleration.byte().max(1));
        let rise_s_per_rpm = f64::from(spec.acceleration_us_per_rpm) / 1e6 * units;
        let now_rpm = profile.step(wanted_rpm, rise_s_per_rpm, actual_rpm);
        Bridge::Drive {
            amps: speed.step(rad_s(now_rpm), sense, Figures::of(model).gain),
        }
    }

    /// The shortest way to the angle, then hold it. `target_turns`: where the wheel is at this angle.
    pub(crate) fn position(&mut self, model: Model, target_turns: f64, sense: &Sense) -> Bridge {
        if !matches!(self, Self::Position { .. }) {
            *self = Self::Position {
                wanted_rad_s: sense.speed_rad_s,
                speed: SpeedLoop::default(),
                error_rad: 0.0,
            };
        }
        let Self::Position {
            wanted_rad_s,
            speed,
            error_rad,
        } = self
        else {
            return Bridge::Open;
        };
        let behind = (target_turns - sense.turns + 0.5).rem_euclid(1.0) - 0.5;
        *error_rad = behind * TAU;
        let goal_rad_s = limited(*error_rad * POSITION_GAIN_PER_S, POSITION_SPEED_MAX_RAD_S);
        *wanted_rad_s = towards(*wanted_rad_s, goal_rad_s, POSITION_ACCEL_RAD_S2 * STEP_S);
        Bridge::Drive {
            amps: speed.step(*wanted_rad_s, sense, Figures::of(model).gain),
        }
    }
}

/// The commanded angle as a share of a turn.
pub(crate) fn target_turn(drive: Drive) -> f64 {
    let full_scale = f64::from(PositionTarget::MAX);
    f64::from(drive.unsigned()).min(full_scale) / full_scale
}

/// The value, at most so large in either direction.
#[allow(
    clippy::manual_clamp,
    reason = "the panic of `f64::clamp` writes its bounds, and that code adds kilobytes to the web page"
)]
const fn limited(value: f64, most: f64) -> f64 {
    value.max(-most).min(most)
}
