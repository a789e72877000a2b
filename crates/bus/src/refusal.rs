//! Why the bus refuses a command.

use motorlink_protocol::{CurrentTarget, Faults, Mode, MotorId, Rpm, family::Model};

use crate::limits::ExceededLimit;

/// Why the bus refuses a command. A refused command changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Refusal {
    /// Stop all motors is in force until Release.
    #[error("STOP is active. Press Release to drive again.")]
    Halted,
    /// No reply within the last 500 ms, so the motor's loop is unknown.
    #[error("Motor {0} has not replied, so its loop is unknown. Check its power and ID.")]
    NotAnswering(MotorId),
    /// The setpoint belongs to another loop than the one that the motor reports.
    #[error("Motor {id} is in the {reported}. Switch it to the {asked} first.")]
    OtherLoop {
        /// Which motor.
        id: MotorId,
        /// The loop of the setpoint.
        asked: Mode,
        /// The loop that the motor reports.
        reported: Mode,
    },
    /// The position loop needs a speed measured within the last 500 ms.
    #[error(
        "The position loop needs a known speed. Motor {0} has reported none for 500 ms: check the link."
    )]
    SpeedUnknown(MotorId),
    /// The position loop needs less than 10 rpm.
    #[error(
        "The wheel turns at {0}. The position loop needs less than 10 rpm: stop the motor first."
    )]
    TooFast(Rpm),
    /// The motor reports a fault. It ignores the command now and would obey it when the fault
    /// clears.
    #[error(
        "Motor {id} reports a fault ({faults}) and ignores commands. When the fault clears, press again."
    )]
    FaultActive {
        /// Which motor.
        id: MotorId,
        /// What it reports.
        faults: Faults,
    },
    /// The operator must confirm first.
    #[error("{0} is above 6.1 A. Confirm to continue.")]
    NeedsConsent(CurrentTarget),
    /// The setpoint exceeds this speed limit in rpm.
    #[error("That is above your speed limit of {0} rpm. Probe for less, or raise the limit.")]
    AboveSpeedLimit(u16),
    /// The motor is hotter than its limit.
    #[error("Motor {id} is at {exceeded}. Let it cool, or raise the limit.")]
    TooHot {
        /// Which motor.
        id: MotorId,
        /// The reported temperature and the limit.
        exceeded: ExceededLimit,
    },
    /// The motor is being stopped.
    #[error("Motor {0} is stopping. Press again when it has stopped.")]
    Stopping(MotorId),
    /// The motor has not confirmed the stop that comes before the start.
    #[error("Motor {0} has not confirmed standstill.")]
    NotStopped(MotorId),
    /// The motor is not driven in the position loop, so there is no angle to hold.
    #[error("Motor {0} is not running in the position loop: nothing to stop.")]
    NotHolding(MotorId),
    /// The motor is not driven in that loop, so there is no setpoint to change.
    #[error("Motor {0} is not running. Press Start.")]
    NotDriven(MotorId),
    /// The page has not answered its ping for a second or more.
    #[error("The page was not responding. Press again.")]
    PageSilent,
    /// The motor is driven in a group.
    #[error("Motor {0} is running in a group. Stop the group first.")]
    InGroup(MotorId),
    /// The motor is switching its loop.
    #[error("Motor {0} is switching loops. Press again afterwards.")]
    Switching(MotorId),
    /// A motor is driven and the command would disturb it.
    #[error("Motor {0} is running. Stop it first.")]
    Driven(MotorId),
    /// A scan or an ID change is running.
    #[error("A bus scan is running. Wait until it ends, or cancel it.")]
    JobRunning,
    /// No full scan of the last minute has proved that this motor is the only one.
    #[error(
        "Setting an ID affects every motor on the bus. Run a full scan first: it must find exactly one motor."
    )]
    NotProvedAlone,
    /// The motor has this ID already.
    #[error("The motor already has ID {0}.")]
    SameId(MotorId),
    /// A frame of the raw editor is still being repeated.
    #[error("A raw frame is repeating. Stop it first.")]
    RawRunning,
    /// No motor may have this ID: see [`unassignable_id`](crate::unassignable_id).
    #[error(
        "ID 0x{0:02X} is not allowed: a scan cannot find 0x00 or 0xFF, and 0xC8 is reserved for the ID query. Use another ID."
    )]
    NotAssignable(u8),
    /// A raw frame asks for the opposite of a current that the motor may still follow.
    #[error("Motor {0} may still run at the opposite current. Send 0 first.")]
    ReversesTorque(MotorId),
    /// Motors of this model have no such loop.
    #[error("A {model} has no {mode}. Choose another loop.")]
    NoSuchLoop {
        /// The model of the line.
        model: Model,
        /// The loop.
        mode: Mode,
    },
    /// Motors of this model do not take this speed.
    #[error("A {0} takes at most {most} rpm. Set less.", most = .0.spec().speed_rpm_max)]
    AboveSpeedOfModel(Model),
    /// The motors that an earlier connection left driven are being stopped.
    #[error(
        "Motors that were running when the connection was lost are being stopped. Press again when they stand."
    )]
    StopsFirst,
    /// Replies have shown motors of this model, so a value could be ten times too large.
    #[error(
        "A {found} answers on this line, not a {expected}. Choose {found} under Model, or remove it and press Release."
    )]
    OtherModel {
        /// The model of the line.
        expected: Model,
        /// The model that the replies show.
        found: Model,
    },
}
