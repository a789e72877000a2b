//! Replies of motors with combined frames: DDSM115 and DDSM315. [`Reading`](crate::family::Reading) reads those of every
//! model.

use core::fmt;

use crate::{
    faults::Faults,
    frame::Frame,
    measured::{Angle, Celsius, CoarsePosition, Current, Position, Rpm},
    mode::{Mode, UnknownMode},
    motor_id::{MotorId, MotorIdError},
};

/// Meaning of bytes 6 and 7 of a reply. It depends on the request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Layout {
    /// Of a drive frame or the ID query: the fine position.
    Drive,
    /// Of a feedback query: temperature and the coarse position.
    Query,
}

/// A reply: what a motor reports in one frame.
///
/// | byte | content |
/// |---|---|
/// | 0 | ID |
/// | 1 | mode |
/// | 2-3 | torque current, i16 big-endian |
/// | 4-5 | velocity in rpm, i16 big-endian |
/// | 6-7 | [`Detail`], by [`Layout`] |
/// | 8 | [`Faults`] |
/// | 9 | CRC |
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reply {
    /// The motor.
    pub id: MotorId,
    /// The loop that the motor closes.
    pub mode: Mode,
    /// Torque current; `None` if the reply does not tell it, in separate frames.
    pub current: Option<Current>,
    /// Speed of the wheel; `None` if the reply does not tell it, in separate frames.
    pub speed: Option<Rpm>,
    /// Bytes 6 and 7.
    pub detail: Detail,
    /// Active faults.
    pub faults: Faults,
}

/// Bytes 6 and 7 of a reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Detail {
    /// In [`Layout::Drive`].
    Drive {
        /// Big-endian in bytes 6 and 7.
        position: Position,
    },
    /// In [`Layout::Query`].
    Query {
        /// Byte 6.
        temperature: Celsius,
        /// Byte 7.
        position: CoarsePosition,
    },
    /// The request is unknown, so the bytes have no meaning.
    Undetermined([u8; 2]),
    /// Of a drive reply in separate frames, which has no position.
    Temperature(Celsius),
    /// Of an odometry reply in separate frames. It has no current, and no speed but that by two such replies.
    Odometry {
        /// Whole turns since power-up.
        turns: i32,
        /// The angle within the turn.
        position: Position,
    },
}

impl Detail {
    /// The temperature, if the reply tells it.
    #[must_use]
    pub const fn temperature(self) -> Option<Celsius> {
        match self {
            Self::Query { temperature, .. } | Self::Temperature(temperature) => Some(temperature),
            Self::Drive { .. } | Self::Odometry { .. } | Self::Undetermined(_) => None,
        }
    }

    /// The angle within the turn, if the reply tells it.
    #[must_use]
    pub const fn angle(self) -> Option<Angle> {
        match self {
            Self::Drive { position } | Self::Odometry { position, .. } => {
                Some(Angle::Fine(position))
            }
            Self::Query { position, .. } => Some(Angle::Coarse(position)),
            Self::Temperature(_) | Self::Undetermined(_) => None,
        }
    }

    /// The same, if it is fine.
    #[must_use]
    pub const fn fine(self) -> Option<Position> {
        match self.angle() {
            Some(Angle::Fine(position)) => Some(position),
            Some(Angle::Coarse(_)) | None => None,
        }
    }
}

/// Why ten bytes are no reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplyError {
    /// Byte 9 is not the CRC of the rest.
    BadCrc {
        /// The CRC that bytes 0-8 ask for.
        expected: u8,
        /// Byte 9.
        found: u8,
    },
    /// Byte 0 is no motor's address.
    BadId(MotorIdError),
    /// Byte 1 is not a mode. An echoed request fails here.
    BadMode(UnknownMode),
}

impl Reply {
    /// Decodes a frame in the layout that was asked for; with `None`, bytes 6 and 7 stay
    /// undetermined.
    ///
    /// # Errors
    /// A wrong CRC, an address that no motor has, or an unknown mode, checked in this order.
    pub fn decode(frame: &Frame, asked: Option<Layout>) -> Result<Self, ReplyError> {
        let &[id, mode, i_hi, i_lo, v_hi, v_lo, d0, d1, faults, found] = frame.bytes();
        let expected = frame.crc_expected();
        if found != expected {
            return Err(ReplyError::BadCrc { expected, found });
        }
        Ok(Self {
            id: MotorId::new(id).map_err(ReplyError::BadId)?,
            mode: Mode::from_byte(mode).map_err(ReplyError::BadMode)?,
            current: Some(Current::from_raw(i16::from_be_bytes([i_hi, i_lo]))),
            speed: Some(Rpm::new(i16::from_be_bytes([v_hi, v_lo]))),
            detail: Detail::read([d0, d1], asked),
            faults: Faults::from_byte(faults),
        })
    }

    /// The ten bytes that a motor with combined frames sends for this reply.
    #[must_use]
    pub fn frame(&self) -> Frame {
        let [i_hi, i_lo] = self.current.unwrap_or_default().raw().to_be_bytes();
        let [v_hi, v_lo] = self.speed.unwrap_or_default().rpm().to_be_bytes();
        let [d0, d1] = self.detail.bytes();
        let (id, mode) = (self.id.get(), self.mode.byte());
        Frame::with_crc([id, mode, i_hi, i_lo, v_hi, v_lo, d0, d1, self.faults.byte()])
    }

    /// This reply with bytes 6 and 7 read in another layout; with `None` they stay undetermined.
    ///
    /// A receiver that learns the layout after the frame decodes the frame once and reads the two bytes
    /// later.
    #[must_use]
    pub const fn in_layout(self, asked: Option<Layout>) -> Self {
        Self {
            detail: Detail::read(self.detail.bytes(), asked),
            ..self
        }
    }

    /// This reply without a meaning for bytes 6 and 7.
    #[must_use]
    pub const fn undetermined(self) -> Self {
        self.in_layout(None)
    }
}

impl Detail {
    const fn read(bytes: [u8; 2], asked: Option<Layout>) -> Self {
        let [high, low] = bytes;
        match asked {
            Some(Layout::Drive) => Self::Drive {
                position: Position::from_raw(u16::from_be_bytes(bytes)),
            },
            Some(Layout::Query) => Self::Query {
                temperature: Celsius::new(high),
                position: CoarsePosition::from_raw(low),
            },
            None => Self::Undetermined(bytes),
        }
    }

    const fn bytes(self) -> [u8; 2] {
        match self {
            Self::Drive { position } | Self::Odometry { position, .. } => {
                position.raw().to_be_bytes()
            }
            Self::Query {
                temperature,
                position,
            } => [temperature.degrees(), position.raw()],
            Self::Undetermined(bytes) => bytes,
            Self::Temperature(temperature) => [temperature.degrees(), 0],
        }
    }
}

impl fmt::Display for ReplyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadCrc { expected, found } => {
                write!(f, "CRC {found:02X}, expected {expected:02X}")
            }
            Self::BadId(error) => error.fmt(f),
            Self::BadMode(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ReplyError {}
