//! Which command it was, without its values.

use motorlink_protocol::{Frame, Mode, MotorId};

use crate::{command::Command, raw::status::Repeat};

/// Which command was refused: what the page needs to say so. It never has to read a whole [`Command`] back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum CommandKind {
    /// [`Command::Start`] or [`Command::Drive`].
    Drive(MotorId),
    /// [`Command::StartGroup`] or [`Command::DriveGroup`].
    DriveGroup,
    /// [`Command::Adjust`].
    Adjust,
    /// [`Command::AdjustGroup`].
    AdjustGroup,
    /// [`Command::SwitchMode`].
    SwitchMode(Mode),
    /// [`Command::IdQuery`].
    IdQuery,
    /// [`Command::FullScan`].
    FullScan,
    /// [`Command::SetId`].
    SetId,
    /// [`Command::SendRaw`].
    SendRaw {
        /// The bytes.
        frame: Frame,
        /// How often.
        repeat: Repeat,
    },
    /// [`Command::StopRaw`].
    StopRaw,
    /// [`Command::Forget`].
    Forget,
    /// Another one.
    Other,
}

impl From<Command> for CommandKind {
    fn from(command: Command) -> Self {
        match command {
            Command::Start { id, .. } | Command::Drive { id, .. } => Self::Drive(id),
            Command::StartGroup { .. } | Command::DriveGroup { .. } => Self::DriveGroup,
            Command::Adjust { .. } => Self::Adjust,
            Command::AdjustGroup { .. } => Self::AdjustGroup,
            Command::SwitchMode { mode, .. } => Self::SwitchMode(mode),
            Command::IdQuery => Self::IdQuery,
            Command::FullScan => Self::FullScan,
            Command::SetId { .. } => Self::SetId,
            Command::SendRaw { frame, repeat, .. } => Self::SendRaw { frame, repeat },
            Command::StopRaw => Self::StopRaw,
            Command::Forget(_) => Self::Forget,
            Command::Watch(_)
            | Command::CancelJob
            | Command::Configure(_)
            | Command::Hold(_)
            | Command::Stop(_)
            | Command::StopAll(_)
            | Command::Release => Self::Other,
        }
    }
}
