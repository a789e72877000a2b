//! Replies of every model.

use core::fmt;

use crate::{
    faults::Faults,
    frame::Frame,
    measured::{Celsius, Position},
    mode::Mode,
    model::{FrameSet, Model},
    motor_id::MotorId,
    reply::{Reply, ReplyError},
};

use super::{current::Current, speed::Speed};

/// Byte 1 of the replies of a DDSM210; those of a DDSM400 are one higher.
const DRIVE: u8 = 0x64;
const ODOMETRY: u8 = 0x74;
const MODE: u8 = 0x75;
const SWITCH: u8 = 0xA0;

/// The layout of a reply, by what was asked.
///
/// Combined frames have the first two, and nothing in a frame tells which. Separate frames say it in
/// byte 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layout {
    /// Of a drive frame or the ID query.
    Drive,
    /// Of a query.
    Query,
    /// Of a mode query. Only in separate frames.
    Mode,
    /// Of a mode switch. Only in separate frames.
    Switch,
}

/// A reply of any model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// The only reply in combined frames.
    Combined(Reply),
    /// The reply to a drive frame or the ID query.
    Drive(DriveReading),
    /// The reply to a query.
    Odometry(Odometry),
    /// The reply to a mode query or a mode switch.
    Mode(ModeReading),
}

/// `ID 64 speed speed current current accel temperature faults CRC`, with byte 1 by the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveReading {
    /// The motor.
    pub id: MotorId,
    /// Bytes 2 and 3: the speed; in the position loop something else, see [`speed`](Self::speed).
    pub value: i16,
    /// Torque current.
    pub current: Current,
    /// Byte 6, as it was commanded.
    pub acceleration: u8,
    /// Temperature of the winding.
    pub temperature: Celsius,
    /// Active faults.
    pub faults: Faults,
}

/// `ID 74 turns turns turns turns position position faults CRC`, with byte 1 by the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Odometry {
    /// The motor.
    pub id: MotorId,
    /// Whole turns since power-up.
    pub turns: i32,
    /// The angle within the turn.
    pub position: Position,
    /// Active faults.
    pub faults: Faults,
}

/// `ID 75 mode 00 00 00 00 00 00 CRC` or `ID A0 mode ..`, with byte 1 by the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModeReading {
    /// The motor.
    pub id: MotorId,
    /// The mode as it came: a loop of the model, or [`ENABLED`](Self::ENABLED) or
    /// [`DISABLED`](Self::DISABLED).
    pub byte: u8,
    /// Whether it answers a mode switch.
    pub switched: bool,
}

/// Why ten bytes are no reply of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadingError {
    /// A wrong CRC, an address that no motor has, or a byte 1 that is no mode of combined frames.
    Frame(ReplyError),
    /// Byte 1 begins no reply of the model. It may be a motor of another model, or an echo.
    NoReply {
        /// The model.
        model: Model,
        /// Byte 1.
        byte: u8,
    },
}

impl DriveReading {
    /// The speed, if the motor is in this loop. In the position loop one source has the position
    /// in these bytes (DDSM210) and none says what is there (DDSM400): unknown.
    #[must_use]
    pub fn speed(&self, model: Model, mode: Mode) -> Option<Speed> {
        (mode != Mode::Position).then(|| model.speed_of_raw(self.value))
    }
}

impl ModeReading {
    /// The mode byte that enables a motor.
    pub const ENABLED: u8 = 8;
    /// The mode byte that makes a motor ignore drive frames.
    pub const DISABLED: u8 = 9;

    /// The loop, if the byte is one of the model.
    #[must_use]
    pub fn mode(&self, model: Model) -> Option<Mode> {
        model.mode_of(self.byte)
    }

    pub(super) const fn enabled_byte(on: bool) -> u8 {
        if on { Self::ENABLED } else { Self::DISABLED }
    }
}

impl Reading {
    /// Decodes a frame of this model. `asked` is the layout that was asked for; separate frames say it
    /// themselves.
    ///
    /// # Errors
    /// A wrong CRC, an address that no motor has, or a byte 1 that begins no reply, checked in this
    /// order.
    pub fn decode(
        model: Model,
        frame: &Frame,
        asked: Option<Layout>,
    ) -> Result<Self, ReadingError> {
        let FrameSet::Separate { reply_offset } = model.spec().frames else {
            let asked = asked.and_then(Layout::combined);
            let reply = Reply::decode(frame, asked).map_err(ReadingError::Frame)?;
            return Ok(Self::Combined(reply));
        };
        let &[id, command, b2, b3, b4, b5, b6, b7, b8, found] = frame.bytes();
        let expected = frame.crc_expected();
        if found != expected {
            return Err(ReadingError::Frame(ReplyError::BadCrc { expected, found }));
        }
        let bad_id = |error| ReadingError::Frame(ReplyError::BadId(error));
        let id = MotorId::new(id).map_err(bad_id)?;
        let faults = Faults::of(model, b8);
        match command.wrapping_sub(reply_offset) {
            DRIVE => Ok(Self::Drive(DriveReading {
                id,
                value: i16::from_be_bytes([b2, b3]),
                current: model.current_of_raw(i16::from_be_bytes([b4, b5])),
                acceleration: b6,
                temperature: Celsius::new(b7),
                faults,
            })),
            ODOMETRY => Ok(Self::Odometry(Odometry {
                id,
                turns: i32::from_be_bytes([b2, b3, b4, b5]),
                position: Position::from_raw(u16::from_be_bytes([b6, b7])),
                faults,
            })),
            kind @ (MODE | SWITCH) => Ok(Self::Mode(ModeReading {
                id,
                byte: b2,
                switched: kind == SWITCH,
            })),
            _ => Err(ReadingError::NoReply {
                model,
                byte: command,
            }),
        }
    }

    /// The ten bytes that a motor of this model sends for this reading.
    #[must_use]
    pub fn frame(&self, model: Model) -> Frame {
        let byte_1 = |of_a_ddsm210: u8| match model.spec().frames {
            FrameSet::Combined => of_a_ddsm210,
            FrameSet::Separate { reply_offset } => of_a_ddsm210.wrapping_add(reply_offset),
        };
        match self {
            Self::Combined(reply) => reply.frame(),
            Self::Drive(reading) => {
                let [v_hi, v_lo] = reading.value.to_be_bytes();
                let [i_hi, i_lo] = reading.current.raw().to_be_bytes();
                let (id, faults) = (reading.id.get(), reading.faults.byte());
                let (accel, temperature) = (reading.acceleration, reading.temperature.degrees());
                let command = byte_1(DRIVE);
                Frame::with_crc([
                    id,
                    command,
                    v_hi,
                    v_lo,
                    i_hi,
                    i_lo,
                    accel,
                    temperature,
                    faults,
                ])
            }
            Self::Odometry(odometry) => {
                let [t0, t1, t2, t3] = odometry.turns.to_be_bytes();
                let [p0, p1] = odometry.position.raw().to_be_bytes();
                let (id, faults) = (odometry.id.get(), odometry.faults.byte());
                Frame::with_crc([id, byte_1(ODOMETRY), t0, t1, t2, t3, p0, p1, faults])
            }
            Self::Mode(ModeReading { id, byte, switched }) => {
                let command = byte_1(if *switched { SWITCH } else { MODE });
                Frame::with_crc([id.get(), command, *byte, 0, 0, 0, 0, 0, 0])
            }
        }
    }

    /// The loop that it names, if it names one.
    #[must_use]
    pub fn names_loop(&self, model: Model) -> Option<Mode> {
        match self {
            Self::Combined(reply) => Some(reply.mode),
            Self::Mode(reading) => reading.mode(model),
            Self::Drive(_) | Self::Odometry(_) => None,
        }
    }

    /// The motor.
    #[must_use]
    pub const fn id(&self) -> MotorId {
        match self {
            Self::Combined(reply) => reply.id,
            Self::Drive(reading) => reading.id,
            Self::Odometry(odometry) => odometry.id,
            Self::Mode(reading) => reading.id,
        }
    }
}

impl Layout {
    /// The layout in combined frames, if they have it.
    #[must_use]
    pub const fn combined(self) -> Option<crate::Layout> {
        match self {
            Self::Drive => Some(crate::Layout::Drive),
            Self::Query => Some(crate::Layout::Query),
            Self::Mode | Self::Switch => None,
        }
    }
}

impl From<crate::Layout> for Layout {
    fn from(layout: crate::Layout) -> Self {
        match layout {
            crate::Layout::Drive => Self::Drive,
            crate::Layout::Query => Self::Query,
        }
    }
}

impl fmt::Display for ReadingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frame(error) => error.fmt(f),
            Self::NoReply { model, byte } => {
                write!(
                    f,
                    "byte 1 is {byte:02X}, which begins no reply of a {model}"
                )
            }
        }
    }
}

impl core::error::Error for ReadingError {}
