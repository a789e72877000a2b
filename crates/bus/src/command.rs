//! What an operator can ask of the bus, and why the bus may refuse.

use std::{fmt, time::Duration};

use motorlink_protocol::{
    AssignableId, CurrentTarget, Faults, Frame, Mode, MotorId, Rpm, Setpoint,
};

use crate::{
    event::StopReason,
    group::setpoints::Together,
    id_change::outcome::SetIdFrames,
    limits::{Crossed, Limits},
    ramp::Ramp,
    rate::CommandRate,
    raw::hazard::is_hazardous,
    raw::status::Repeat,
};

/// An operator's act. Motion starts by [`Command::Drive`], by [`Command::DriveTogether`], by a frame
/// that a person wrote ([`Command::SendRaw`]), and by nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Command {
    /// Ask this motor for telemetry from now on.
    Watch(MotorId),
    /// Ask no more. Refused for a motor that is driven or being stopped.
    Forget(MotorId),
    /// Ask who is there, by the ID query. What is driven is stopped first.
    IdQuery,
    /// Ask every address who is there. What is driven is stopped first, and nothing drives until it
    /// has ended.
    FullScan,
    /// Give the only motor on the bus another ID, which it keeps. Refused unless a full scan of the
    /// last minute has proved that it is the only one.
    SetId {
        /// Its present ID.
        from: MotorId,
        /// The new one.
        to: AssignableId,
        /// How often it is sent.
        frames: SetIdFrames,
    },
    /// End a scan or an ID change.
    CancelSurvey,
    /// Send ten bytes that a person wrote, as they are.
    SendRaw {
        /// The bytes.
        frame: Frame,
        /// How often.
        repeat: Repeat,
        /// What the operator was asked and said yes to.
        consent: Consent,
    },
    /// Send them no more. What they may have set in motion is stopped.
    StopRaw,
    /// Send this many drive frames a second to each driven motor.
    SetRate(CommandRate),
    /// Close another loop. The motor starts no motion by it.
    SwitchMode {
        /// Which motor.
        id: MotorId,
        /// The loop to close.
        mode: Mode,
    },
    /// Drive until told otherwise.
    Drive {
        /// Which motor.
        id: MotorId,
        /// What it is to do.
        setpoint: Setpoint,
        /// What the operator was asked and said yes to.
        consent: Consent,
    },
    /// Change the setpoint of a motor that is driven in the same loop; never starts one. What a
    /// slider sends while it is dragged: a drag that outlasts a stop must not undo it.
    Adjust {
        /// Which motor.
        id: MotorId,
        /// What it is to do.
        setpoint: Setpoint,
        /// What the operator was asked and said yes to.
        consent: Consent,
    },
    /// Drive several motors as one, until told otherwise. Where one of them may not be driven, none
    /// is. When one of them is stopped, withdrawn or falls silent, all are stopped.
    DriveTogether {
        /// Which motors, and what each is to do.
        parts: Together,
        /// What the operator was asked and said yes to.
        consent: Consent,
    },
    /// Change the setpoints of motors that are driven together; never starts one.
    AdjustTogether {
        /// All motors of the group, and what each is to do.
        parts: Together,
        /// What the operator was asked and said yes to.
        consent: Consent,
    },
    /// Let commanded speeds grow no faster than this; `None` is as fast as they are given. What is
    /// slower, and every stop, is sent at once.
    SetRamp(Option<Ramp>),
    /// Stop a driven motor that crosses one of these, and start none that asks for more or is hotter.
    SetLimits(Limits),
    /// Hold the present angle of a motor that is driven in the position loop.
    Hold(MotorId),
    /// Brake this motor to a standstill; it can be driven again at once.
    Stop(MotorId),
    /// Brake every motor that was driven, and drive none until [`Command::Release`].
    StopAll(StopReason),
    /// Allow driving again after [`Command::StopAll`]. Restores nothing.
    Release,
}

/// An act older than this is not carried out if a wheel may move by it: a page that hung hands over at
/// its end what was clicked at its beginning. Half of what the watchdog allows, and five times what a
/// click takes on a slow machine.
pub const ACT_AGE_MAX: Duration = Duration::from_millis(500);

impl Command {
    /// Whether this was asked for too long ago to be carried out.
    #[must_use]
    pub fn is_too_old(self, age: Duration) -> bool {
        (self.may_move() || self.releases()) && age > ACT_AGE_MAX
    }

    /// Whether motors may be driven again by it. One that was given before a stop does not release that.
    #[must_use]
    pub fn releases(self) -> bool {
        matches!(self, Self::Release)
    }

    /// Whether a wheel may move by it, or a motor change.
    #[must_use]
    pub fn may_move(self) -> bool {
        match self {
            Self::Drive { .. }
            | Self::Adjust { .. }
            | Self::DriveTogether { .. }
            | Self::AdjustTogether { .. }
            | Self::SwitchMode { .. }
            | Self::SetId { .. } => true,
            Self::SendRaw { frame, .. } => is_hazardous(&frame),
            Self::Watch(_)
            | Self::Forget(_)
            | Self::IdQuery
            | Self::FullScan
            | Self::CancelSurvey
            | Self::StopRaw
            | Self::SetRate(_)
            | Self::SetRamp(_)
            | Self::SetLimits(_)
            | Self::Hold(_)
            | Self::Stop(_)
            | Self::StopAll(_)
            | Self::Release => false,
        }
    }
}

/// What the operator was asked before the command was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Consent {
    /// Nothing.
    #[default]
    None,
    /// Whether a current above 25,000 raw (6.1 A) is really meant.
    HighCurrent,
}

/// Why a command was not carried out. Nothing has changed by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Refusal {
    /// Stop all motors stands until it is released.
    Halted,
    /// The motor has not answered lately, so its loop is not known.
    NotHeard(MotorId),
    /// The setpoint belongs to another loop than the motor reports.
    OtherLoop {
        /// Which motor.
        id: MotorId,
        /// The loop of the setpoint.
        asked: Mode,
        /// The loop that the motor reports.
        reported: Mode,
    },
    /// The position loop needs a speed measured within the last 500 ms.
    SpeedUnknown(MotorId),
    /// The position loop needs less than 10 rpm.
    TooFast(Rpm),
    /// The motor reports a fault and would ignore the command, then obey it when the fault clears.
    FaultActive {
        /// Which motor.
        id: MotorId,
        /// What it reports.
        faults: Faults,
    },
    /// The operator has to be asked first.
    NeedsConsent(CurrentTarget),
    /// It asks for more than the speed limit, in rpm.
    AboveSpeedLimit(u16),
    /// The motor is hotter than its limit.
    TooHot {
        /// Which motor.
        id: MotorId,
        /// How hot, and the limit.
        crossed: Crossed,
    },
    /// The motor is being stopped.
    Stopping(MotorId),
    /// The motor is not driven in the position loop, so there is no angle to hold.
    NotHolding(MotorId),
    /// The motor is not driven in that loop, so there is no setpoint to change.
    NotDriven(MotorId),
    /// The page did not answer for a second, and has not answered since.
    PageSilent,
    /// The motor is driven together with others.
    Together(MotorId),
    /// The motor changes its loop.
    Switching(MotorId),
    /// A motor is driven, and this would disturb it.
    Driven(MotorId),
    /// A scan or an ID change is under way.
    Surveying,
    /// No full scan of the last minute has proved that this motor is the only one.
    NotProvedAlone,
    /// The motor has this ID already.
    SameId(MotorId),
    /// A frame of the raw editor is still being repeated.
    RawRunning,
    /// No motor may have this ID: see [`unassignable_id`].
    NotAssignable(u8),
    /// A raw frame asks for the opposite of a current that the motor may still follow.
    ReversesTorque(MotorId),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Halted => f.write_str("All motors are stopped. Press Release to drive again."),
            Self::NotHeard(id) => {
                write!(
                    f,
                    "Motor {id} has not replied, so its loop is unknown. Check its power and ID."
                )
            }
            Self::OtherLoop {
                id,
                asked,
                reported,
            } => {
                write!(
                    f,
                    "Motor {id} is in the {reported}. Switch it to the {asked} first."
                )
            }
            Self::SpeedUnknown(id) => write!(
                f,
                "The position loop needs a known speed. Motor {id} has reported none for 500 ms: check the link."
            ),
            Self::TooFast(speed) => write!(
                f,
                "The wheel turns at {speed}. The position loop needs less than 10 rpm: stop the motor first."
            ),
            Self::FaultActive { id, faults } => write!(
                f,
                "Motor {id} reports a fault ({faults}) and ignores commands. When the fault clears, press again."
            ),
            Self::NeedsConsent(current) => {
                write!(f, "{current} is above 6.1 A. Confirm to continue.")
            }
            Self::AboveSpeedLimit(limit) => write!(
                f,
                "Above your speed limit of {limit} rpm. Lower the target, or raise the limit."
            ),
            Self::TooHot { id, crossed } => write!(
                f,
                "Motor {id} is at {crossed}. Let it cool, or raise the limit."
            ),
            Self::Stopping(id) => write!(
                f,
                "Motor {id} is stopping. Press again when it has stopped."
            ),
            Self::NotHolding(id) => {
                write!(
                    f,
                    "Motor {id} is not running in the position loop: nothing to stop."
                )
            }
            Self::NotDriven(id) => write!(f, "Motor {id} is not running. Press Start."),
            Self::PageSilent => {
                f.write_str("The page was not responding. Press again.")
            }
            Self::Together(id) => write!(
                f,
                "Motor {id} is running in a group. Stop the group first."
            ),
            Self::Switching(id) => write!(
                f,
                "Motor {id} is switching loops. Press again afterwards."
            ),
            Self::Driven(id) => write!(f, "Motor {id} is running. Stop it first."),
            Self::Surveying => f.write_str("A bus scan is running. Wait until it ends, or cancel it."),
            Self::NotProvedAlone => f.write_str(
                "Setting an ID affects every motor on the bus. Run a full scan first: it must find exactly one motor.",
            ),
            Self::SameId(id) => write!(f, "The motor already has ID {id}."),
            Self::RawRunning => f.write_str("A raw frame is repeating. Stop it first."),
            Self::ReversesTorque(id) => write!(
                f,
                "Motor {id} may still run at the opposite current. Send 0 first."
            ),
            Self::NotAssignable(id) => write!(
                f,
                "ID 0x{id:02X} is not allowed: a scan cannot find 0x00 or 0xFF, and 0xC8 is reserved for the ID query. Use another ID."
            ),
        }
    }
}

impl std::error::Error for Refusal {}
