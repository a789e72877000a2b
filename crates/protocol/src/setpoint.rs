//! Setpoints, and the drive frame that carries one.

use core::fmt;

use crate::{
    family::Speed,
    mode::Mode,
    model::Model,
    target::{Acceleration, CurrentTarget, OpenLoopTarget, PositionTarget, SpeedTarget},
};

/// A setpoint in its loop. Not every model has every loop.
///
/// **Zero is not "stop"**: it is 0 rpm in the velocity loop, coasting in the current loop and a move
/// to 0 degrees in the position loop. So a setpoint always knows its loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Setpoint {
    /// Hold a speed.
    Velocity {
        /// The speed.
        speed: SpeedTarget,
        /// How gently to reach it.
        acceleration: Acceleration,
    },
    /// Brake in the velocity loop, with 0 rpm. It holds only as long as frames keep coming.
    Brake,
    /// Hold a torque current.
    Current(CurrentTarget),
    /// Go to an angle and hold it.
    Position(PositionTarget),
    /// Put a share of the supply on the windings. Only of a model with separate frames.
    OpenLoop(OpenLoopTarget),
}

impl Setpoint {
    /// A speed at the motor's own acceleration.
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

    /// The setpoint of a motor that is mounted mirrored: the opposite sign of speed, current and share of the supply.
    /// Angles and the brake do not change.
    #[must_use]
    pub fn reversed(self) -> Self {
        match self {
            Self::Velocity {
                speed,
                acceleration,
            } => Self::Velocity {
                speed: SpeedTarget::clamped(-i32::from(speed.rpm())),
                acceleration,
            },
            Self::Current(target) => Self::Current(target.reversed()),
            Self::OpenLoop(target) => Self::OpenLoop(target.reversed()),
            Self::Brake | Self::Position(_) => self,
        }
    }

    /// What the drive frame to a motor of this model carries: the value in its units, within what the wire can carry.
    #[must_use]
    pub fn drive(self, model: Model) -> Drive {
        let drive = Drive::from(self);
        let value = match self {
            Self::Velocity { speed, .. } => {
                model.raw_of_speed(Speed::from_tenths(i32::from(speed.rpm()) * 10))
            }
            Self::Current(target) => {
                let full_scale = i32::from(model.spec().current.milliamps());
                let raw = i32::from(target.raw()) * CurrentTarget::FULL_SCALE_MA / full_scale;
                i16::try_from(raw).unwrap_or(if raw < 0 { -i16::MAX } else { i16::MAX })
            }
            Self::Brake | Self::Position(_) | Self::OpenLoop(_) => return drive,
        };
        Drive {
            value: value.to_be_bytes(),
            ..drive
        }
    }
}

/// `+100 rpm`, `brake`, `+0.488 A`, `90.00°`
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

/// The variable part of a drive frame, before any loop gives it a meaning.
///
/// | byte | content |
/// |---|---|
/// | 2-3 | value, big-endian: rpm (i16), raw current (i16) or raw position (u16), by the active loop |
/// | 6 | [`Acceleration`], velocity loop only |
/// | 7 | 0xFF brakes, any other value does nothing; velocity loop only |
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Drive {
    /// Bytes 2 and 3.
    pub value: [u8; 2],
    /// Byte 6.
    pub acceleration: Acceleration,
    /// Byte 7.
    pub brake: u8,
}

impl Drive {
    /// Byte 7 of a frame that brakes.
    pub const BRAKE: u8 = 0xFF;

    /// The value as a signed number: rpm or raw current.
    #[must_use]
    pub const fn signed(self) -> i16 {
        i16::from_be_bytes(self.value)
    }

    /// The value as an unsigned number: raw position.
    #[must_use]
    pub const fn unsigned(self) -> u16 {
        u16::from_be_bytes(self.value)
    }

    /// Whether the frame asks for the brake.
    #[must_use]
    pub const fn brakes(self) -> bool {
        self.brake == Self::BRAKE
    }

    /// The setpoint that a motor reads in this loop.
    #[must_use]
    pub fn setpoint(self, mode: Mode) -> Setpoint {
        match mode {
            Mode::Velocity if self.brakes() && self.signed() == 0 => Setpoint::Brake,
            Mode::Velocity => Setpoint::Velocity {
                speed: SpeedTarget::clamped(self.signed().into()),
                acceleration: self.acceleration,
            },
            Mode::Current => {
                Setpoint::Current(CurrentTarget::new(self.signed().into()).unwrap_or_default())
            }
            Mode::Position => {
                Setpoint::Position(PositionTarget::new(self.unsigned().into()).unwrap_or_default())
            }
            Mode::OpenLoop => Setpoint::OpenLoop(OpenLoopTarget::nearest(self.signed())),
        }
    }
}

impl From<Setpoint> for Drive {
    fn from(setpoint: Setpoint) -> Self {
        let plain = |value| Self {
            value,
            acceleration: Acceleration::DEFAULT,
            brake: 0,
        };
        match setpoint {
            Setpoint::Velocity {
                speed,
                acceleration,
            } => Self {
                acceleration,
                ..plain(speed.rpm().to_be_bytes())
            },
            Setpoint::Brake => Self {
                brake: Self::BRAKE,
                ..plain([0, 0])
            },
            Setpoint::Current(target) => plain(target.raw().to_be_bytes()),
            Setpoint::Position(target) => plain(target.raw().to_be_bytes()),
            Setpoint::OpenLoop(target) => plain(target.raw().to_be_bytes()),
        }
    }
}
