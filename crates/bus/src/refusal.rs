//! Why the bus refuses a command.

use std::fmt;

use motorlink_protocol::{CurrentTarget, Faults, Mode, MotorId, Rpm, family::Model};

use crate::limits::ExceededLimit;

/// Why the bus refuses a command. A refused command changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Refusal {
    /// Stop all motors is in force until Release.
    Halted,
    /// No reply within the last 500 ms, so the motor's loop is unknown.
    NotAnswering(MotorId),
    /// The setpoint belongs to another loop than the one that the motor reports.
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
    /// The motor reports a fault. It ignores the command now and would obey it when the fault
    /// clears.
    FaultActive {
        /// Which motor.
        id: MotorId,
        /// What it reports.
        faults: Faults,
    },
    /// The operator must confirm first.
    NeedsConsent(CurrentTarget),
    /// The setpoint exceeds this speed limit in rpm.
    AboveSpeedLimit(u16),
    /// The motor is hotter than its limit.
    TooHot {
        /// Which motor.
        id: MotorId,
        /// The reported temperature and the limit.
        exceeded: ExceededLimit,
    },
    /// The motor is being stopped.
    Stopping(MotorId),
    /// The motor has not confirmed the stop that comes before the start.
    NotStopped(MotorId),
    /// The motor is not driven in the position loop, so there is no angle to hold.
    NotHolding(MotorId),
    /// The motor is not driven in that loop, so there is no setpoint to change.
    NotDriven(MotorId),
    /// The page has not answered its ping for a second or more.
    PageSilent,
    /// The motor is driven in a group.
    InGroup(MotorId),
    /// The motor is switching its loop.
    Switching(MotorId),
    /// A motor is driven and the command would disturb it.
    Driven(MotorId),
    /// A scan or an ID change is running.
    JobRunning,
    /// No full scan of the last minute has proved that this motor is the only one.
    NotProvedAlone,
    /// The motor has this ID already.
    SameId(MotorId),
    /// A frame of the raw editor is still being repeated.
    RawRunning,
    /// No motor may have this ID: see [`unassignable_id`](crate::unassignable_id).
    NotAssignable(u8),
    /// A raw frame asks for the opposite of a current that the motor may still follow.
    ReversesTorque(MotorId),
    /// Motors of this model have no such loop.
    NoSuchLoop {
        /// The model of the line.
        model: Model,
        /// The loop.
        mode: Mode,
    },
    /// Motors of this model do not take this speed.
    AboveSpeedOfModel(Model),
    /// The motors that an earlier connection left driven are being stopped.
    StopsFirst,
    /// Replies have shown motors of this model, so a value could be ten times too large.
    OtherModel {
        /// The model of the line.
        expected: Model,
        /// The model that the replies show.
        found: Model,
    },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Halted => f.write_str("All motors are stopped. Press Release to drive again."),
            Self::NotAnswering(id) => {
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
                "That is above your speed limit of {limit} rpm. Probe for less, or raise the limit."
            ),
            Self::TooHot { id, exceeded } => write!(
                f,
                "Motor {id} is at {exceeded}. Let it cool, or raise the limit."
            ),
            Self::Stopping(id) => write!(
                f,
                "Motor {id} is stopping. Press again when it has stopped."
            ),
            Self::NotStopped(id) => write!(
                f,
                "Motor {id} has not confirmed standstill."
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
            Self::InGroup(id) => write!(
                f,
                "Motor {id} is running in a group. Stop the group first."
            ),
            Self::Switching(id) => write!(
                f,
                "Motor {id} is switching loops. Press again afterwards."
            ),
            Self::Driven(id) => write!(f, "Motor {id} is running. Stop it first."),
            Self::JobRunning => f.write_str("A bus scan is running. Wait until it ends, or cancel it."),
            Self::NotProvedAlone => f.write_str(
                "Setting an ID affects every motor on the bus. Run a full scan first: it must find exactly one motor.",
            ),
            Self::SameId(id) => write!(f, "The motor already has ID {id}."),
            Self::RawRunning => f.write_str("A raw frame is repeating. Stop it first."),
            Self::ReversesTorque(id) => write!(
                f,
                "Motor {id} may still run at the opposite current. Send 0 first."
            ),
            Self::NoSuchLoop { model, mode } => {
                write!(f, "A {model} has no {mode}. Choose another loop.")
            }
            Self::AboveSpeedOfModel(model) => write!(
                f,
                "A {model} takes at most {} rpm. Set less.",
                model.spec().speed_rpm_max
            ),
            Self::StopsFirst => f.write_str(
                "Motors that were running when the connection was lost are being stopped. Press again when they stand.",
            ),
            Self::OtherModel { expected, found } => write!(
                f,
                "A {found} answers on this line, not a {expected}. Choose {found} under Model, or remove it and press Release."
            ),
            Self::NotAssignable(id) => write!(
                f,
                "ID 0x{id:02X} is not allowed: a scan cannot find 0x00 or 0xFF, and 0xC8 is reserved for the ID query. Use another ID."
            ),
        }
    }
}

impl std::error::Error for Refusal {}
