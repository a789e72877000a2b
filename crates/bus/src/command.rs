//! Operator commands.

use std::time::Duration;

use motorlink_protocol::{AssignableId, Frame, Mode, MotorId, Setpoint};

use crate::{
    event::StopReason, group::setpoints::GroupSetpoints, id_change::outcome::SetIdFrames,
    raw::hazard::is_hazardous, raw::status::Repeat, settings::BusSettings,
};

/// A command of the operator. Only [`Command::Start`], [`Command::StartGroup`], [`Command::Drive`],
/// [`Command::DriveGroup`] and a raw frame ([`Command::SendRaw`]) start motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Command {
    /// Poll this motor for telemetry.
    Watch(MotorId),
    /// Stop polling this motor. Refused while it is driven or being stopped.
    Forget(MotorId),
    /// Send the ID query, which every motor answers. Driven motors are stopped first.
    IdQuery,
    /// Query every address. Driven motors are stopped first, and nothing drives until the scan has
    /// ended.
    FullScan,
    /// Give the only motor on the bus another ID, which the motor stores. Refused unless a full
    /// scan of the last minute has proved that it is the only one.
    SetId {
        /// Its present ID.
        from: MotorId,
        /// The new one.
        to: AssignableId,
        /// How many set-ID frames are sent.
        frames: SetIdFrames,
    },
    /// Cancel a scan or an ID change.
    CancelJob,
    /// Send ten bytes as the operator wrote them: a raw frame.
    SendRaw {
        /// The bytes.
        frame: Frame,
        /// How often.
        repeat: Repeat,
        /// What the operator has confirmed.
        consent: Consent,
    },
    /// Stop repeating the raw frame, and stop motors that it may have moved.
    StopRaw,
    /// Apply these settings at once, to driven motors too.
    Configure(BusSettings),
    /// Switch to another loop. Starts no motion.
    SwitchMode {
        /// Which motor.
        id: MotorId,
        /// The loop to close.
        mode: Mode,
    },
    /// Drive until the next command, in the loop of the setpoint. A motor that turns in another loop, or that is being
    /// stopped, must stand first; then it is switched, and driven once it reports the loop. Any stop of the motor ends
    /// this.
    Start {
        /// Which motor.
        id: MotorId,
        /// The setpoint.
        setpoint: Setpoint,
        /// What the operator has confirmed.
        consent: Consent,
    },
    /// Drive until the next command. Refused if the motor is in another loop.
    Drive {
        /// Which motor.
        id: MotorId,
        /// The setpoint.
        setpoint: Setpoint,
        /// What the operator has confirmed.
        consent: Consent,
    },
    /// Change the setpoint of a motor that is driven in the same loop; never starts one. A slider
    /// sends it while it is dragged: a drag that outlasts a stop must not restart the motor.
    Adjust {
        /// Which motor.
        id: MotorId,
        /// The setpoint.
        setpoint: Setpoint,
        /// What the operator has confirmed.
        consent: Consent,
    },
    /// Drive several motors as a group until the next command. With speeds, all stop first if one of them is in another
    /// loop, or is being stopped, and none is driven before each stop is confirmed. For other setpoints each motor must be
    /// in their loop already, or the start is refused. Any stop of one of them ends this, and so does a group start that
    /// is refused.
    StartGroup {
        /// Each motor with its setpoint.
        setpoints: GroupSetpoints,
        /// What the operator has confirmed.
        consent: Consent,
    },
    /// Drive several motors as a group until the next command. If one of them may not be driven,
    /// none is. When one is stopped, withdrawn or silent, all are stopped.
    DriveGroup {
        /// Each motor with its setpoint.
        setpoints: GroupSetpoints,
        /// What the operator has confirmed.
        consent: Consent,
    },
    /// Change the setpoints of a group that is driven or waits to be; never starts one. Zeros end the wait.
    AdjustGroup {
        /// All motors of the group with their setpoints.
        setpoints: GroupSetpoints,
        /// What the operator has confirmed.
        consent: Consent,
    },
    /// Hold the present angle of a motor that is driven in the position loop.
    Hold(MotorId),
    /// Brake this motor to a standstill; it can be driven again at once.
    Stop(MotorId),
    /// Brake every motor that was driven, and drive none until [`Command::Release`].
    StopAll(StopReason),
    /// Allow driving again after [`Command::StopAll`]. Restores nothing.
    Release,
}

/// Commands older than this are dropped if they may move a wheel: a page that hung delivers old
/// clicks when it resumes. Half of [`PAGE_SILENCE_MAX`](crate::PAGE_SILENCE_MAX), and five times
/// the delay of a click on a slow machine.
pub const COMMAND_AGE_MAX: Duration = Duration::from_millis(500);

impl Command {
    /// Whether a command of this age is dropped.
    #[must_use]
    pub fn is_too_old(self, age: Duration) -> bool {
        (self.may_move() || self.releases()) && age > COMMAND_AGE_MAX
    }

    /// Whether the command releases a halt. A release given before a stop does not release that
    /// stop.
    #[must_use]
    pub fn releases(self) -> bool {
        matches!(self, Self::Release)
    }

    /// Whether the command may move a wheel or change a motor.
    #[must_use]
    pub fn may_move(self) -> bool {
        match self {
            Self::Start { .. }
            | Self::Drive { .. }
            | Self::Adjust { .. }
            | Self::StartGroup { .. }
            | Self::DriveGroup { .. }
            | Self::AdjustGroup { .. }
            | Self::SwitchMode { .. }
            | Self::SetId { .. } => true,
            Self::SendRaw { frame, .. } => is_hazardous(&frame),
            Self::Watch(_)
            | Self::Forget(_)
            | Self::IdQuery
            | Self::FullScan
            | Self::CancelJob
            | Self::StopRaw
            | Self::Configure(_)
            | Self::Hold(_)
            | Self::Stop(_)
            | Self::StopAll(_)
            | Self::Release => false,
        }
    }
}

/// What the operator confirmed before the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Consent {
    /// Nothing.
    #[default]
    None,
    /// A current above 25,000 raw (6.1 A).
    HighCurrent,
}
