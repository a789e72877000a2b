//! Frames to motors of every model.

use core::fmt;

use crate::{
    frame::Frame,
    mode::Mode,
    model::Model,
    motor_id::{AssignableId, MotorId},
    request as combined,
    setpoint::{Drive, Setpoint},
};

use super::reading::{Layout, ModeReading};

const MODE_QUERY: u8 = 0x75;
const SWITCH_MODE: u8 = 0xA0;

/// A frame from the host. The last three columns are bytes 1-9 in combined and in separate frames, and
/// the layout of the reply.
///
/// | request | combined | separate | reply |
/// |---|---|---|---|
/// | drive | `64` value (2) `00 00` acceleration, brake, `00` CRC | the same | [`Layout::Drive`] |
/// | query | `74 00 ..` CRC | the same, the odometry query | [`Layout::Query`] |
/// | mode query | none | `75 00 ..` CRC | [`Layout::Mode`] |
/// | mode switch | `A0 00 ..` mode | `A0` mode `00 ..` CRC | none, or [`Layout::Switch`] |
/// | enable | none | a mode switch to 8 or 9 | [`Layout::Switch`] |
/// | ID query | `C8 64 00 ..` `DE` | the same | [`Layout::Drive`] |
/// | set ID | `AA 55 53` new ID `00 ..` | the same with CRC | none |
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Drives the motor, in the loop that it is in.
    Drive {
        /// Who.
        id: MotorId,
        /// What, as the wire carries it: see [`Setpoint::drive`].
        drive: Drive,
    },
    /// Asks for what the reply to a drive frame does not have.
    Query {
        /// Who.
        id: MotorId,
    },
    /// Asks for the loop. Only of a model with separate frames.
    ModeQuery {
        /// Who.
        id: MotorId,
    },
    /// Switches to a loop.
    SwitchMode {
        /// Who.
        id: MotorId,
        /// To which loop.
        mode: Mode,
    },
    /// Obey drive frames from now on, or ignore them. Only of a model that
    /// [needs it](super::Spec::needs_enable).
    Enable {
        /// Who.
        id: MotorId,
        /// Whether to obey.
        on: bool,
    },
    /// Asks every motor for its ID. More than one answer collide.
    IdQuery,
    /// Sets the ID of every motor on the line: connect only one.
    SetId {
        /// The new ID.
        id: AssignableId,
    },
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
    /// The model has no such frame.
    Request {
        /// The model.
        model: Model,
        /// What the frame does: `mode query`.
        name: &'static str,
    },
}

/// Why ten bytes are no request that the model knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequestError {
    /// No request of any model.
    Frame(combined::RequestError),
    /// The mode of a mode switch is none of the model.
    Mode {
        /// The model.
        model: Model,
        /// The mode byte.
        byte: u8,
    },
}

impl Request {
    /// The drive request that asks a motor of this model for a setpoint. The motor must be in its loop.
    #[must_use]
    pub fn drive(model: Model, id: MotorId, setpoint: Setpoint) -> Self {
        let drive = setpoint.drive(model);
        Self::Drive { id, drive }
    }

    /// The ten bytes to send to motors of this model.
    ///
    /// # Errors
    /// The model has no such frame, or not this loop.
    pub fn frame(&self, model: Model) -> Result<Frame, NotOfModel> {
        let separate = model.has_separate_frames();
        let none = |name| NotOfModel::Request { model, name };
        let plain = match *self {
            Self::Drive { id, drive } => combined::Request::Drive { id, drive },
            Self::Query { id } => combined::Request::Query { id },
            Self::IdQuery => combined::Request::IdQuery,
            Self::SetId { id } if model.spec().set_id_has_crc => {
                return Ok(set_id_with_crc(id));
            }
            Self::SetId { id } => combined::Request::SetId { id },
            Self::ModeQuery { id } if separate => {
                return Ok(Frame::with_crc([id.get(), MODE_QUERY, 0, 0, 0, 0, 0, 0, 0]));
            }
            Self::ModeQuery { .. } => return Err(none("mode query")),
            Self::SwitchMode { mode, .. } if !model.has(mode) => {
                return Err(NotOfModel::Mode { model, mode });
            }
            Self::SwitchMode { id, mode } if separate => return Ok(switch(id, mode.byte())),
            Self::SwitchMode { id, mode } => combined::Request::SwitchMode { id, mode },
            Self::Enable { id, on } if model.spec().needs_enable => {
                return Ok(switch(id, ModeReading::enabled_byte(on)));
            }
            Self::Enable { .. } => return Err(none("enabling")),
        };
        Ok(plain.frame())
    }

    /// Reads a frame that a host sent to motors of this model.
    ///
    /// # Errors
    /// Says why the frame is not a request that the model knows.
    pub fn parse(model: Model, frame: &Frame) -> Result<Self, RequestError> {
        let &[id, command, mode, ..] = frame.bytes();
        if model.has_separate_frames() && matches!(command, MODE_QUERY | SWITCH_MODE) {
            return Self::parse_separate(model, frame, id, command, mode);
        }
        let parsed = combined::Request::parse(frame).map_err(RequestError::Frame)?;
        Ok(match parsed {
            combined::Request::Drive { id, drive } => Self::Drive { id, drive },
            combined::Request::Query { id } => Self::Query { id },
            combined::Request::SwitchMode { id, mode } => Self::SwitchMode { id, mode },
            combined::Request::IdQuery => Self::IdQuery,
            combined::Request::SetId { id } => Self::SetId { id },
            combined::Request::Raw(_) => {
                let error = combined::RequestError::UnknownCommand(command);
                return Err(RequestError::Frame(error));
            }
        })
    }

    /// A mode query or a mode switch in separate frames.
    fn parse_separate(
        model: Model,
        frame: &Frame,
        id: u8,
        command: u8,
        mode: u8,
    ) -> Result<Self, RequestError> {
        let [.., found] = *frame.bytes();
        let expected = frame.crc_expected();
        if found != expected {
            let error = combined::RequestError::BadCrc { expected, found };
            return Err(RequestError::Frame(error));
        }
        let is_query = command == MODE_QUERY;
        let first_zero = if is_query { 2 } else { 3 };
        let reserved = frame
            .bytes()
            .iter()
            .enumerate()
            .skip(first_zero)
            .take(9 - first_zero);
        if let Some((place, _)) = reserved.into_iter().find(|(_, byte)| **byte != 0) {
            let error = combined::RequestError::NotZero { place };
            return Err(RequestError::Frame(error));
        }
        let bad_id = |error| RequestError::Frame(combined::RequestError::BadId(error));
        let id = MotorId::new(id).map_err(bad_id)?;
        if is_query {
            return Ok(Self::ModeQuery { id });
        }
        match (model.mode_of(mode), mode) {
            (Some(mode), _) => Ok(Self::SwitchMode { id, mode }),
            (None, ModeReading::ENABLED | ModeReading::DISABLED) if model.spec().needs_enable => {
                let on = mode == ModeReading::ENABLED;
                Ok(Self::Enable { id, on })
            }
            (None, byte) => Err(RequestError::Mode { model, byte }),
        }
    }

    /// The motor that the request addresses, if it is a single one.
    #[must_use]
    pub const fn addressee(&self) -> Option<MotorId> {
        match *self {
            Self::Drive { id, .. }
            | Self::Query { id }
            | Self::ModeQuery { id }
            | Self::SwitchMode { id, .. }
            | Self::Enable { id, .. } => Some(id),
            Self::IdQuery | Self::SetId { .. } => None,
        }
    }

    /// The layout of the reply of this model, if the request has one.
    #[must_use]
    pub const fn reply_layout(&self, model: Model) -> Option<Layout> {
        match self {
            Self::Drive { .. } | Self::IdQuery => Some(Layout::Drive),
            Self::Query { .. } => Some(Layout::Query),
            Self::ModeQuery { .. } => Some(Layout::Mode),
            Self::SwitchMode { .. } | Self::Enable { .. } if model.has_separate_frames() => {
                Some(Layout::Switch)
            }
            // The reply `new 64 00 ..` of a model with separate frames: no source says after which of the
            // five frames it comes.
            Self::SwitchMode { .. } | Self::Enable { .. } | Self::SetId { .. } => None,
        }
    }
}

/// A mode switch in separate frames.
fn switch(id: MotorId, mode: u8) -> Frame {
    Frame::with_crc([id.get(), SWITCH_MODE, mode, 0, 0, 0, 0, 0, 0])
}

fn set_id_with_crc(id: AssignableId) -> Frame {
    let [b0, b1, b2, b3, b4, b5, b6, b7, b8, _] = *combined::Request::SetId { id }.frame().bytes();
    Frame::with_crc([b0, b1, b2, b3, b4, b5, b6, b7, b8])
}

impl fmt::Display for NotOfModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mode { model, mode } => {
                write!(f, "A {model} has no {mode}. Choose another loop.")
            }
            Self::Request { model, name } => {
                write!(f, "A {model} has no {name}. Choose another frame.")
            }
        }
    }
}

impl core::error::Error for NotOfModel {}

impl fmt::Display for RequestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frame(error) => error.fmt(f),
            Self::Mode { model, byte } => {
                write!(f, "mode byte is {byte:02X}; a {model} has")?;
                for (place, mode) in model.modes().iter().enumerate() {
                    let separator = if place == 0 { " " } else { ", " };
                    write!(f, "{separator}{:02X} ({mode})", mode.byte())?;
                }
                Ok(())
            }
        }
    }
}

impl core::error::Error for RequestError {}
