//! Why a run ends, and why it does not start.

use std::fmt;

use motorlink_protocol::{Faults, Instant, Mode, MotorId};
use strum::IntoStaticStr;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum End {
    /// Its last step has ended.
    Finished {
        /// When.
        at: Instant,
    },
    /// It was aborted before.
    Aborted {
        /// Why.
        cause: Cause,
        /// When.
        at: Instant,
    },
}

/// Why a run is aborted. The bus reports some of the causes, the worker others.
#[derive(Clone, Copy, Debug, PartialEq, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Cause {
    /// The user pressed stop.
    Stopped,
    /// The user drove a motor of the run by hand.
    Driven(MotorId),
    /// A motor reports a fault.
    Fault(MotorId, Faults),
    /// A motor does not reply: the bus has withdrawn its setpoint, which it does after 0.2 s, or half a second has passed.
    Silent(MotorId),
    /// A limit was exceeded.
    Limit(MotorId, ExceededLimit),
    /// A motor reports another loop: it lost power, or another host switched it.
    OtherLoop(MotorId, Mode),
    /// The bus refused a setpoint of the run.
    Refused(MotorId),
    /// The adapter was unplugged.
    Unplugged,
    /// The page is closed, reloaded or frozen.
    TabClosed,
    /// The page does not answer.
    PageSilent,
    /// The page that drove over a network has lost or given up control.
    OperatorLost,
    /// The page has lost the focus, and [`Options::stop_on_lost_focus`](super::Options) is set.
    FocusLost,
    /// The computer slept.
    Slept,
    /// The worker did not run for over half a second.
    Late,
    /// A condition was not fulfilled in time.
    WaitTimedOut {
        /// The instruction that waited: see [`Plan::place`](crate::plan::Plan::place).
        step: usize,
    },
    /// The pause was longer than allowed.
    PausedTooLong,
    /// The user closed the port.
    PortClosed,
    /// A scan or an ID query began.
    Scan,
    /// The user chose another model, or the motor reported one.
    OtherModel,
    /// A motor that had not answered was driven before. It answers again, and had to be stopped.
    LeftDriven,
    /// The program that runs experiments failed.
    ProgramFailed,
}

/// An exceeded limit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ExceededLimit {
    /// Speed in rpm.
    Rpm {
        /// Reported.
        reached: f64,
        /// Allowed.
        limit: f64,
    },
    /// Current in A, for half a second.
    Amps {
        /// Reported.
        reached: f64,
        /// Allowed.
        limit: f64,
    },
    /// Temperature in deg C.
    Celsius {
        /// Reported.
        reached: f64,
        /// Allowed.
        limit: f64,
    },
    /// A limit of the bus, which reports the details.
    OfBus,
}

/// Why a run does not start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StartRefusal {
    /// It is running or has ended.
    NotArmed,
    /// It was armed more than a minute ago.
    ArmedTooLongAgo,
    /// The motor has not replied in the last half second.
    NotAnswering(MotorId),
    /// The motor is not in the loop that the run needs.
    OtherLoop {
        /// The motor.
        id: MotorId,
        /// The needed loop.
        needed: Mode,
        /// The reported loop.
        reported: Mode,
    },
    /// The motor reports a fault.
    Fault(MotorId, Faults),
    /// The motor has not reported its angle, at which the run begins.
    NoAngle(MotorId),
    /// Its angle is that of its odometry. Position setpoints count from where the position loop was entered, which no reply
    /// tells.
    OtherAngle(MotorId),
    /// The start came too long after the person's act: the page did not respond in between.
    TooLate,
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stopped => f.write_str("stopped by you"),
            Self::Driven(id) => write!(f, "motor {} was driven by hand", id.get()),
            Self::Fault(id, faults) => write!(f, "motor {} reports a fault: {faults}", id.get()),
            Self::Silent(id) => write!(f, "motor {} does not reply", id.get()),
            Self::Limit(id, exceeded) => write!(f, "motor {}: {exceeded}", id.get()),
            Self::OtherLoop(id, mode) => write!(f, "motor {} is in the {mode}", id.get()),
            Self::Refused(id) => write!(f, "a setpoint of motor {} was refused", id.get()),
            Self::Unplugged => f.write_str("the adapter was unplugged"),
            Self::TabClosed => f.write_str("the page was closed"),
            Self::PageSilent => f.write_str("the page did not respond"),
            Self::OperatorLost => f.write_str("remote control ended"),
            Self::FocusLost => f.write_str("the page lost the focus"),
            Self::Slept => f.write_str("the computer slept"),
            Self::Late => f.write_str("the computer was too busy for half a second"),
            Self::WaitTimedOut { .. } => {
                f.write_str("a condition did not come to hold in its time")
            }
            Self::PausedTooLong => f.write_str("paused for over ten minutes"),
            Self::PortClosed => f.write_str("the port was closed"),
            Self::Scan => f.write_str("a scan began"),
            Self::OtherModel => f.write_str("another motor model is set"),
            Self::LeftDriven => f.write_str("a motor replied again and had to be stopped"),
            Self::ProgramFailed => f.write_str("the program that runs experiments failed"),
        }
    }
}

impl fmt::Display for ExceededLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rpm { reached, limit } => {
                write!(f, "{reached:.0} rpm, above the limit of {limit} rpm")
            }
            Self::Amps { reached, limit } => {
                write!(f, "{reached:.2} A, above the limit of {limit} A")
            }
            Self::Celsius { reached, limit } => {
                write!(f, "{reached:.0} °C, above the limit of {limit} °C")
            }
            Self::OfBus => f.write_str("above your limit"),
        }
    }
}

impl fmt::Display for StartRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotArmed => f.write_str("Not armed. Arm the run first."),
            Self::ArmedTooLongAgo => f.write_str("Armed over a minute ago. Arm the run again."),
            Self::NotAnswering(id) => write!(
                f,
                "Motor {} has not replied for half a second. Check the link.",
                id.get()
            ),
            Self::OtherLoop {
                id,
                needed,
                reported,
            } => write!(
                f,
                "Motor {} is in the {reported}. Switch it to the {needed} first.",
                id.get()
            ),
            Self::Fault(id, faults) => write!(
                f,
                "Motor {} reports a fault ({faults}). Start when it has cleared.",
                id.get()
            ),
            Self::NoAngle(id) => write!(
                f,
                "Motor {} has not reported its angle. Wait for telemetry.",
                id.get()
            ),
            Self::OtherAngle(id) => write!(
                f,
                "Position setpoints of motor {} do not count from the angle that it reports. Use a speed.",
                id.get()
            ),
            Self::TooLate => f.write_str("The page was not responding. Press Start again."),
        }
    }
}

impl std::error::Error for StartRefusal {}
