//! Frames from the host.

use core::fmt;

use crate::{
    frame::Frame,
    mode::{Mode, UnknownMode},
    motor_id::{AssignableId, MotorId, MotorIdError},
    reply::Layout,
    setpoint::{Drive, Setpoint},
    target::Acceleration,
};

const DRIVE: u8 = 0x64;
const QUERY: u8 = 0x74;
const SWITCH_MODE: u8 = 0xA0;
/// The CRC of the ID query.
const ID_QUERY_END: u8 = 0xDE;
const SET_ID: [u8; 3] = [0xAA, 0x55, 0x53];
const ID_QUERY: [u8; 9] = [0xC8, DRIVE, 0, 0, 0, 0, 0, 0, 0];

/// Requests of a host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Request {
    /// `ID 64 hi lo 00 00 accel brake 00 CRC`: do this, and answer in [`Layout::Drive`].
    ///
    /// Many motors keep it for ever when frames cease.
    Drive {
        /// Who.
        id: MotorId,
        /// What.
        drive: Drive,
    },
    /// `ID 74 00 00 00 00 00 00 00 CRC`: answer in [`Layout::Query`], change nothing.
    Query {
        /// Who.
        id: MotorId,
    },
    /// `ID A0 00 00 00 00 00 00 00 mode`, without CRC and without answer.
    ///
    /// To be sent five times, 20 ms apart. The position loop is silently refused above 10 rpm.
    SwitchMode {
        /// Who.
        id: MotorId,
        /// The loop to close from now on.
        mode: Mode,
    },
    /// `C8 64 00 00 00 00 00 00 00 DE`: every motor answers in [`Layout::Drive`], at once.
    IdQuery,
    /// `AA 55 53 id 00 00 00 00 00 00`, for all motors, without a reply.
    ///
    /// Takes effect after five in a row, once per power cycle, and is kept in flash. One published
    /// table ends it with a CRC, the maker's samples with 00: this crate sends 00 and reads both.
    SetId {
        /// The new address of every motor on the bus.
        id: AssignableId,
    },
    /// A raw frame: ten bytes, sent as they are.
    Raw(Frame),
}

/// Why a frame is no request. The frame itself stays printable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequestError {
    /// Byte 9 is not the CRC of the rest.
    BadCrc {
        /// The CRC that bytes 0-8 ask for.
        expected: u8,
        /// Byte 9.
        found: u8,
    },
    /// Byte 0, or the new ID in byte 3, is no motor's address.
    BadId(MotorIdError),
    /// The new ID in byte 3 is 0xC8.
    NotAssignable,
    /// Byte 1 is none of 64, 74, A0.
    UnknownCommand(u8),
    /// Byte 9 of a mode switch is not a mode.
    BadMode(UnknownMode),
    /// A byte that is always zero is not.
    NotZero {
        /// Its place, 0-9.
        place: usize,
    },
}

impl Request {
    /// The drive request that asks a motor for a setpoint.
    #[must_use]
    pub fn drive(id: MotorId, setpoint: Setpoint) -> Self {
        Self::Drive {
            id,
            drive: setpoint.into(),
        }
    }

    /// The ten bytes to send.
    ///
    /// The bare zero drive frame to motor 0xC8 would be, byte for byte, the ID query that all
    /// motors answer. It is sent with the default acceleration spelled out as 1 instead of 0.
    #[must_use]
    pub fn frame(&self) -> Frame {
        match *self {
            Self::Drive {
                id,
                drive:
                    Drive {
                        value: [hi, lo],
                        acceleration,
                        brake,
                    },
            } => {
                let body = [id.get(), DRIVE, hi, lo, 0, 0, acceleration.byte(), brake, 0];
                if body == ID_QUERY {
                    let [id, command, hi, lo, ..] = body;
                    let spelled_out = Acceleration::FASTEST.byte();
                    Frame::with_crc([id, command, hi, lo, 0, 0, spelled_out, 0, 0])
                } else {
                    Frame::with_crc(body)
                }
            }
            Self::Query { id } => Frame::with_crc([id.get(), QUERY, 0, 0, 0, 0, 0, 0, 0]),
            Self::SwitchMode { id, mode } => {
                Frame::new([id.get(), SWITCH_MODE, 0, 0, 0, 0, 0, 0, 0, mode.byte()])
            }
            Self::IdQuery => Frame::with_crc(ID_QUERY),
            Self::SetId { id } => {
                let [b0, b1, b2] = SET_ID;
                Frame::new([b0, b1, b2, id.id().get(), 0, 0, 0, 0, 0, 0])
            }
            Self::Raw(frame) => frame,
        }
    }

    /// Reads a frame that a host sent. Never gives [`Request::Raw`].
    ///
    /// # Errors
    /// Says why the frame is not a request that the motor knows.
    pub fn parse(frame: &Frame) -> Result<Self, RequestError> {
        let &[b0, b1, b2, b3, b4, b5, b6, b7, b8, b9] = frame.bytes();
        let zero = |first_place: usize, bytes: &[u8]| {
            let wrong = bytes.iter().position(|byte| *byte != 0);
            wrong.map_or(Ok(()), |place| {
                Err(RequestError::NotZero {
                    place: first_place + place,
                })
            })
        };
        let id = || MotorId::new(b0).map_err(RequestError::BadId);
        let crc = || match (frame.crc_expected(), b9) {
            (expected, found) if expected != found => Err(RequestError::BadCrc { expected, found }),
            _ => Ok(()),
        };
        if [b0, b1, b2] == SET_ID {
            let id = MotorId::new(b3).map_err(RequestError::BadId)?;
            let id = AssignableId::new(id).map_err(|_| RequestError::NotAssignable)?;
            zero(4, &[b4, b5, b6, b7, b8])?;
            if b9 != 0 {
                crc()?;
            }
            return Ok(Self::SetId { id });
        }
        match b1 {
            DRIVE => {
                crc()?;
                let id = id()?;
                zero(4, &[b4, b5])?;
                zero(8, &[b8])?;
                let drive = Drive {
                    value: [b2, b3],
                    acceleration: Acceleration::new(b6),
                    brake: b7,
                };
                let is_id_query = [b0, b1, b2, b3, b4, b5, b6, b7, b8] == ID_QUERY;
                Ok(if is_id_query {
                    Self::IdQuery
                } else {
                    Self::Drive { id, drive }
                })
            }
            QUERY => {
                crc()?;
                zero(2, &[b2, b3, b4, b5, b6, b7, b8])?;
                Ok(Self::Query { id: id()? })
            }
            SWITCH_MODE => {
                zero(2, &[b2, b3, b4, b5, b6, b7, b8])?;
                let mode = Mode::from_byte(b9).map_err(RequestError::BadMode)?;
                Ok(Self::SwitchMode { id: id()?, mode })
            }
            other => Err(RequestError::UnknownCommand(other)),
        }
    }

    /// The new ID of a set-ID frame with any ending that is in use: `00` as in the maker's samples, the CRC as in the
    /// article's table, or the `DE` of the ID query, which another program may send.
    #[must_use]
    pub fn set_id_of(frame: &Frame) -> Option<AssignableId> {
        let [body @ .., last] = *frame.bytes();
        let ends = matches!(last, 0 | ID_QUERY_END) || frame.crc_holds();
        match Self::parse(&Frame::with_crc(body)) {
            Ok(Self::SetId { id }) if ends => Some(id),
            _ => None,
        }
    }

    /// The motor that the request addresses, if it is a single one.
    #[must_use]
    pub const fn addressee(&self) -> Option<MotorId> {
        match *self {
            Self::Drive { id, .. } | Self::Query { id } | Self::SwitchMode { id, .. } => Some(id),
            Self::IdQuery | Self::SetId { .. } | Self::Raw(_) => None,
        }
    }

    /// The layout of the reply, if the request has one.
    ///
    /// A raw frame has the reply of the request that it parses to.
    #[must_use]
    pub fn reply_layout(&self) -> Option<Layout> {
        match self {
            Self::Drive { .. } | Self::IdQuery => Some(Layout::Drive),
            Self::Query { .. } => Some(Layout::Query),
            Self::SwitchMode { .. } | Self::SetId { .. } => None,
            Self::Raw(frame) => Self::parse(frame)
                .ok()
                .and_then(|parsed| parsed.reply_layout()),
        }
    }
}

impl fmt::Display for RequestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadCrc { expected, found } => {
                write!(f, "CRC {found:02X}, expected {expected:02X}")
            }
            Self::BadId(error) => error.fmt(f),
            Self::NotAssignable => crate::NotAssignable.fmt(f),
            Self::UnknownCommand(byte) => {
                write!(
                    f,
                    "byte 1 is {byte:02X}; expected 64 (drive), 74 (query) or A0 (mode)"
                )
            }
            Self::BadMode(error) => error.fmt(f),
            Self::NotZero { place } => write!(f, "byte {place} must be 00 in this frame"),
        }
    }
}

impl core::error::Error for RequestError {}
