//! Why a run ends, and why it does not start.

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
#[derive(Clone, Copy, Debug, PartialEq, IntoStaticStr, thiserror::Error)]
#[strum(serialize_all = "snake_case")]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Cause {
    /// The user pressed stop.
    #[error("stopped by you")]
    Stopped,
    /// The user drove a motor of the run by hand.
    #[error("motor {} was driven by hand", .0.get())]
    Driven(MotorId),
    /// A motor reports a fault.
    #[error("motor {id} reports a fault: {1}", id = .0.get())]
    Fault(MotorId, Faults),
    /// A motor does not reply: the bus has withdrawn its setpoint, which it does after 0.2 s, or half a second has passed.
    #[error("motor {} does not reply", .0.get())]
    Silent(MotorId),
    /// A limit was exceeded.
    #[error("motor {id}: {1}", id = .0.get())]
    Limit(MotorId, ExceededLimit),
    /// A motor reports another loop: it lost power, or another host switched it.
    #[error("motor {id} is in the {1}", id = .0.get())]
    OtherLoop(MotorId, Mode),
    /// The bus refused a setpoint of the run.
    #[error("a setpoint of motor {} was refused", .0.get())]
    Refused(MotorId),
    /// The adapter was unplugged.
    #[error("the adapter was unplugged")]
    Unplugged,
    /// The page is closed, reloaded or frozen.
    #[error("the page was closed")]
    TabClosed,
    /// The page does not answer.
    #[error("the page did not respond")]
    PageSilent,
    /// The page that drove over a network has lost or given up control.
    #[error("remote control ended")]
    OperatorLost,
    /// The page has lost the focus, and [`Options::stop_on_lost_focus`](super::Options) is set.
    #[error("the page lost the focus")]
    FocusLost,
    /// The computer slept.
    #[error("the computer slept")]
    Slept,
    /// The worker did not run for over half a second.
    #[error("the computer was too busy for half a second")]
    Late,
    /// A condition was not fulfilled in time.
    #[error("a condition did not come to hold in its time")]
    WaitTimedOut {
        /// The instruction that waited: see [`Plan::place`](crate::plan::Plan::place).
        step: usize,
    },
    /// The pause was longer than allowed.
    #[error("paused for over ten minutes")]
    PausedTooLong,
    /// The user closed the port.
    #[error("the port was closed")]
    PortClosed,
    /// A scan or an ID query began.
    #[error("a scan began")]
    Scan,
    /// The user chose another model, or the motor reported one.
    #[error("another motor model is set")]
    OtherModel,
    /// A motor that had not answered was driven before. It answers again, and had to be stopped.
    #[error("a motor replied again and had to be stopped")]
    LeftDriven,
    /// The program that runs experiments failed.
    #[error("the program that runs experiments failed")]
    ProgramFailed,
}

/// An exceeded limit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ExceededLimit {
    /// Speed in rpm.
    #[error("{reached:.0} rpm, above the limit of {limit} rpm")]
    Rpm {
        /// Reported.
        reached: f64,
        /// Allowed.
        limit: f64,
    },
    /// Current in A, for half a second.
    #[error("{reached:.2} A, above the limit of {limit} A")]
    Amps {
        /// Reported.
        reached: f64,
        /// Allowed.
        limit: f64,
    },
    /// Temperature in deg C.
    #[error("{reached:.0} °C, above the limit of {limit} °C")]
    Celsius {
        /// Reported.
        reached: f64,
        /// Allowed.
        limit: f64,
    },
    /// A limit of the bus, which reports the details.
    #[error("above your limit")]
    OfBus,
}

/// Why a run does not start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StartRefusal {
    /// It is running or has ended.
    #[error("Not armed. Arm the run first.")]
    NotArmed,
    /// It was armed more than a minute ago.
    #[error("Armed over a minute ago. Arm the run again.")]
    ArmedTooLongAgo,
    /// The motor has not replied in the last half second.
    #[error("Motor {} has not replied for half a second. Check the link.", .0.get())]
    NotAnswering(MotorId),
    /// The motor is not in the loop that the run needs.
    #[error("Motor {} is in the {reported}. Switch it to the {needed} first.", .id.get())]
    OtherLoop {
        /// The motor.
        id: MotorId,
        /// The needed loop.
        needed: Mode,
        /// The reported loop.
        reported: Mode,
    },
    /// The motor reports a fault.
    #[error("Motor {id} reports a fault ({1}). Start when it has cleared.", id = .0.get())]
    Fault(MotorId, Faults),
    /// The motor has not reported its angle, at which the run begins.
    #[error("Motor {} has not reported its angle. Wait for telemetry.", .0.get())]
    NoAngle(MotorId),
    /// Its angle is that of its odometry. Position setpoints count from where the position loop was entered, which no reply
    /// tells.
    #[error("Position setpoints of motor {} do not count from the angle that it reports. Use a speed.", .0.get())]
    OtherAngle(MotorId),
    /// The start came too long after the person's act: the page did not respond in between.
    #[error("The page was not responding. Press Start again.")]
    TooLate,
}
