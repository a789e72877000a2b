//! Events of the bus.

use motorlink_protocol::{AssignableId, Faults, Mode, MotorId, Rpm, family::Model};

use crate::{
    id_change::outcome::IdChangeOutcome, limits::ExceededLimit, line_event::LineEvent,
    refusal::Refusal, sample::Sample, scan::report::ScanReport,
};

/// What happened, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// A reply of a motor.
    Telemetry(Sample),
    /// The ID query has ended.
    IdQueryEnded(IdQueryOutcome),
    /// An event of the line, for the packet log.
    Line(LineEvent),
    /// A full scan has ended.
    ScanEnded(ScanReport),
    /// An ID change has ended.
    IdChangeEnded {
        /// The ID that the motor had.
        from: MotorId,
        /// The new ID.
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
        /// The loop that it reports instead; `None` without a fresh reply.
        reported: Option<Mode>,
    },
    /// A motor that was started is not driven: its stop was not confirmed, or what has changed meanwhile forbids it.
    NotStarted {
        /// Which motor.
        id: MotorId,
        /// Why.
        refusal: Refusal,
    },
    /// The bus has withdrawn a setpoint and stops the motor.
    Withdrawn {
        /// Which motor.
        id: MotorId,
        /// Why.
        reason: WithdrawReason,
    },
    /// A motor has not answered for two seconds.
    MotorSilent {
        /// Which motor.
        id: MotorId,
        /// Whether invalid bytes came in most of its reply windows since.
        garbled: bool,
    },
    /// A motor that was silent answers again.
    MotorBack(MotorId),
    /// A stop has begun.
    StopBegan(StopReason),
    /// Every motor of the stop stands, or its stop window has ended.
    StopEnded(StopReport),
    /// Replies show motors of another model. All motors are stopped, and nothing drives until `Release`.
    OtherModel {
        /// The model of the line.
        expected: Model,
        /// The model that the replies show. A DDSM115 stands for a DDSM315 too.
        found: Model,
    },
    /// Another device than a motor sends text. Motors that have never answered are not asked while it does.
    SendsText {
        /// Whether it is JSON, as of a driver board that is not switched to its plain bridge.
        is_json: bool,
    },
    /// Ping the page. It answers through [`Bus::page_answered`](crate::Bus::page_answered).
    PingPage,
}

/// Result of the ID query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum IdQueryOutcome {
    /// No reply.
    NoReply,
    /// One motor, with a clean reply.
    One(MotorId),
    /// Bytes that are not one clean reply: several motors answered at once, or noise.
    Garbled,
    /// A stop came before the query was sent.
    Cancelled,
}

/// Why all motors are stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StopReason {
    /// The operator pressed Stop all motors.
    Operator,
    /// The page was hidden, and is set to stop in that case.
    PageHidden,
    /// The page was closed, reloaded or frozen.
    PageGone,
    /// The page did not answer for a second.
    PageSilent,
    /// The computer slept, or the wall clock was set forward, which looks the same.
    ComputerSlept,
    /// The worker that owns the port did not run for over half a second.
    LoopDelayed,
    /// The operator disconnects.
    Disconnect,
    /// A scan or an ID change begins.
    Job,
    /// The operator or the bus stops one motor or group.
    OneMotor,
    /// A reply shows a motor of another model.
    OtherModel,
    /// The motors were driven when an earlier connection ended: see [`Bus::stop_first`](crate::Bus::stop_first).
    LeftDriven,
    /// The page that drove over a network has lost or given up control.
    OperatorLost,
}

/// Why the bus withdrew a setpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum WithdrawReason {
    /// No reply for 200 ms.
    Silent,
    /// The motor reports a fault.
    Fault(Faults),
    /// The motor reports another loop than the setpoint's: it lost power, or another host switched
    /// it.
    OtherLoop {
        /// The loop that it reports.
        reported: Mode,
    },
    /// A limit of the operator was exceeded.
    Limit(ExceededLimit),
    /// The motor is not enabled any more: it has lost power.
    NotEnabled,
    /// The temperature has not been known for two seconds, so its limit cannot be judged.
    TemperatureUnknown,
    /// Hold was asked for, and the reported angle does not fit the motion: held, it could turn the wheel anywhere.
    AngleMisfits,
}

/// Result of a stop.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StopReport {
    /// Why it began.
    pub reason: StopReason,
    /// One outcome per motor.
    pub motors: Vec<StopOutcome>,
}

/// Result of a stop for one motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StopOutcome {
    /// Which motor.
    pub id: MotorId,
    /// Whether the motor's replies reported standstill.
    pub confirmed: bool,
    /// Speed by a reply of the last 500 ms; `None` is unknown, not zero.
    pub speed: Option<Rpm>,
}
