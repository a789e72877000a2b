//! Setpoints of every model.

use core::fmt;

use crate::{
    mode::Mode,
    model::Model,
    open_loop::OpenLoopTarget,
    setpoint::Drive,
    target::{Acceleration, PositionTarget},
};

use super::{
    current::CurrentTarget,
    speed::{Speed, SpeedTarget},
};

/// A setpoint in its loop. Not every model has every loop.
///
/// **Zero is not "stop"**: it is 0 rpm in the velocity loop, coasting in the current loop and a move
/// to 0 degrees in the position loop. So a setpoint always knows its loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setpoint {
    /// Turn at this speed.
    Velocity {
        /// How fast.
        speed: SpeedTarget,
        /// How gently to get there.
        acceleration: Acceleration,
    },
    /// Brake electrically for as long as such frames keep coming. Works in the velocity loop.
    Brake,
    /// Push with this torque current.
    Current(CurrentTarget),
    /// Go to an angle and hold it. Of a model with separate frames, 0 degrees is where the position loop
    /// was entered.
    Position(PositionTarget),
    /// Put a share of the supply on the windings, without any loop.
    OpenLoop(OpenLoopTarget),
}

/// Why a model cannot be asked for something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotOfModel {
    /// The model has no such loop.
    Mode {
        /// The model.
        model: Model,
        /// The loop.
        mode: Mode,
    },
    /// The speed is beyond the range of the model.
    Speed {
        /// The model.
        model: Model,
        /// The greatest speed in rpm.
        rpm_max: u16,
    },
    /// The current is in the scale of another model.
    CurrentScale {
        /// The model.
        model: Model,
    },
    /// The model has no such frame.
    Request {
        /// The model.
        model: Model,
        /// What the frame does: `mode query`.
        name: &'static str,
    },
}

impl Setpoint {
    /// A speed, reached with the motor's default acceleration.
    #[must_use]
    pub const fn velocity(speed: SpeedTarget) -> Self {
        Self::Velocity {
            speed,
            acceleration: Acceleration::DEFAULT,
        }
    }

    /// The loop in which this setpoint means what it says.
    #[must_use]
    pub const fn mode(self) -> Mode {
        match self {
            Self::Velocity { .. } | Self::Brake => Mode::Velocity,
            Self::Current(_) => Mode::Current,
            Self::Position(_) => Mode::Position,
            Self::OpenLoop(_) => Mode::OpenLoop,
        }
    }

    /// What the drive frame carries, in the units of this model.
    ///
    /// # Errors
    /// A loop that the model does not have, a speed beyond its range, a current in another scale.
    pub fn drive(self, model: Model) -> Result<Drive, NotOfModel> {
        let mode = self.mode();
        if !model.has(mode) {
            return Err(NotOfModel::Mode { model, mode });
        }
        let plain = |value| Drive {
            value,
            acceleration: Acceleration::DEFAULT,
            brake: 0,
        };
        Ok(match self {
            Self::Velocity {
                speed,
                acceleration,
            } => {
                if speed.tenths().unsigned_abs() > model.speed_tenths_max().unsigned_abs() {
                    let rpm_max = model.spec().speed_rpm_max;
                    return Err(NotOfModel::Speed { model, rpm_max });
                }
                let raw = model.raw_of_speed(Speed::from_tenths(speed.tenths().into()));
                Drive {
                    acceleration,
                    ..plain(raw.to_be_bytes())
                }
            }
            Self::Brake => Drive {
                brake: Drive::BRAKE,
                ..plain([0, 0])
            },
            Self::Current(target) => {
                if target.scale() != model.spec().current {
                    return Err(NotOfModel::CurrentScale { model });
                }
                plain(target.raw().to_be_bytes())
            }
            Self::Position(target) => plain(target.raw().to_be_bytes()),
            Self::OpenLoop(target) => plain(target.raw().to_be_bytes()),
        })
    }
}

impl fmt::Display for Setpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Velocity { speed, .. } => speed.fmt(f),
            Self::Brake => f.write_str("brake"),
            Self::Current(target) => target.fmt(f),
            Self::Position(target) => target.fmt(f),
            Self::OpenLoop(target) => target.fmt(f),
        }
    }
}

impl fmt::Display for NotOfModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mode { model, mode } => {
                write!(f, "A {model} has no {mode}. Choose another loop.")
            }
            Self::Speed { model, rpm_max } => {
                write!(f, "A {model} takes at most {rpm_max} rpm. Ask for less.")
            }
            Self::CurrentScale { model } => write!(
                f,
                "The current is in the scale of another model than {model}. Set it again."
            ),
            Self::Request { model, name } => {
                write!(f, "A {model} has no {name}. Choose another frame.")
            }
        }
    }
}

impl core::error::Error for NotOfModel {}
