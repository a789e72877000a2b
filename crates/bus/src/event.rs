//! What the bus tells.

use motorlink_protocol::{AssignableId, Faults, Mode, MotorId, Rpm};

use crate::{
    id_change::outcome::IdChangeOutcome, limits::Crossed, sample::Sample, scan::report::ScanReport,
    traffic::Traffic,
};

/// Something that happened, in the order in which it happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// A motor has reported.
    Telemetry(Sample),
    /// The ID query has been answered, or not.
    IdQueryEnded(IdQueryOutcome),
    /// Something has passed on the line.
    Traffic(Traffic),
    /// A full scan has ended.
    ScanEnded(ScanReport),
    /// An ID change has ended.
    IdChangeEnded {
        /// The ID that the motor had.
        from: MotorId,
        /// The ID that it was to get.
        to: AssignableId,
        /// How it ended.
        outcome: IdChangeOutcome,
    },
    /// A reply reports the loop that was asked for.
    ModeSwitched {
        /// Which motor.
        id: MotorId,
        /// The loop it reports.
        mode: Mode,
    },
    /// Five mode switches were sent and no reply reports the loop that was asked for.
    ModeSwitchFailed {
        /// Which motor.
        id: MotorId,
        /// The loop that was asked for.
        asked: Mode,
        /// The loop that it reports instead; `None` where it reports nothing.
        reported: Option<Mode>,
    },
    /// A setpoint was withdrawn by the bus and its motor is being stopped.
    Withdrawn {
        /// Which motor.
        id: MotorId,
        /// Why.
        reason: WithdrawReason,
    },
    /// A motor has not answered for two seconds.
    MotorSilent(MotorId),
    /// A motor that was silent answers again.
    MotorBack(MotorId),
    /// A stop has begun.
    StopBegan(StopReason),
    /// Every motor of the stop stands, or its window is spent.
    StopEnded(StopReport),
    /// Ask the page whether it lives; it has to answer through [`Bus::page_answered`](crate::Bus::page_answered).
    PingPage,
}

/// Who answered the ID query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum IdQueryOutcome {
    /// Nobody.
    Nobody,
    /// One motor, undisturbed.
    One(MotorId),
    /// Bytes came that are not one clean reply: several motors answered at once, or noise.
    Garbled,
    /// A stop came before it was asked.
    Cancelled,
}

/// Why all motors are stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StopReason {
    /// The operator pressed Stop all motors.
    Operator,
    /// The page was hidden and is set to stop then.
    PageHidden,
    /// The page was closed, reloaded or frozen.
    PageGone,
    /// The page did not answer for a second.
    PageSilent,
    /// The computer slept, or the wall clock was set forward, which looks the same.
    ComputerSlept,
    /// The program that owns the port did nothing for over half a second.
    LoopDelayed,
    /// The operator disconnects.
    Disconnect,
    /// The bus is to be scanned.
    Survey,
    /// One motor was to be stopped, by the operator or by the bus.
    OneMotor,
}

/// Why the bus took a setpoint back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum WithdrawReason {
    /// It did not answer for 200 ms.
    Silent,
    /// It reports a fault.
    Fault(Faults),
    /// It reports another loop than the setpoint belongs to: it lost power, or another master spoke.
    OtherLoop {
        /// The loop that it reports.
        reported: Mode,
    },
    /// It crossed a limit that a person has set.
    Limit(Crossed),
}

/// How a stop ended, motor by motor.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StopReport {
    /// Why it began.
    pub reason: StopReason,
    /// Every motor that it was for.
    pub motors: Vec<StopOutcome>,
}

/// How a stop ended for one motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StopOutcome {
    /// Which motor.
    pub id: MotorId,
    /// Whether its own replies reported standstill.
    pub confirmed: bool,
    /// Its speed by the last reply of the last 500 ms; `None` is unknown, not zero.
    pub speed: Option<Rpm>,
}
