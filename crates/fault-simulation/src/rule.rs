//! The rules by name, and a violation of one.

use std::fmt;

use motorlink_protocol::Instant;
use strum::VariantArray;

/// A rule's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, VariantArray)]
pub enum Rule {
    /// A wheel is driven only while a command of the operator for it is in force.
    DrivenByCommandOnly,
    /// A late command starts nothing.
    NoOldActs,
    /// A sent setpoint lies between rest and the commanded one.
    NoMoreThanCommanded,
    /// A motor that is silent for 200 ms loses its setpoint.
    SilentIsWithdrawn,
    /// A motor that exceeds a limit is not driven any more.
    LimitsHold,
    /// A stop reaches every driven motor in time.
    StopIsNext,
    /// A stop ends, and reports truly for each motor whether it stands.
    StopEnds,
    /// The motors of a hung page are stopped.
    DeadPageStops,
    /// Reported telemetry was measured by that motor, in that layout.
    TelemetryIsTrue,
    /// Two frames are never on the wire at once.
    OneFrameAtATime,
    /// On a good line every reply is received, after any history.
    GoodRepliesAreHeard,
    /// An ID changes only with the proof of a full scan.
    IdChangeIsProved,
    /// Every sent frame and every received one is in the log, in order.
    LogIsComplete,
    /// No panic, no busy loop, and rest in the end.
    ComesToRest,
    /// A late call of the bus withdraws all setpoints.
    GapWithdraws,
    /// A wheel that is stopped turns no further than its momentum carries it.
    StopMovesNothing,
    /// A held wheel does not move on.
    HoldHolds,
    /// No frame asks for more than a limit, in any loop that the motor may be in.
    NothingAboveALimit,
    /// A torque is reversed only after a zero that the motor has answered.
    ReversalPassesZero,
    /// What was driven when the port was lost is stopped first when it is back, and the report names it.
    StoppedAfterALoss,
    /// What was driven when a line died is stopped before anything else once it answers again, and the report names it.
    StoppedAfterADeadLine,
    /// No motor that turns is reported to stand, also if it reports no speed.
    StandstillIsTrue,
    /// A motor that moves though nothing drives it is said to, from the first report of it on, and no other is.
    UnaskedIsSaid,
    /// On a good line each motor of a stop is braked in time, in the velocity loop.
    FirstBrakeInTime,
    /// On a good line a stop ends in time, and every motor of it has confirmed.
    StopsConfirm,
    /// Every value of a sample was in a reply of that age.
    NoInventedValue,
    /// Every motor that is not known to be silent is asked in time, on every line.
    AskedInTime,
    /// On a line whose adapter is slow and does nothing else wrong, nearly all replies come in their windows.
    RepliesInTime,
    /// A start ends in time on a good line: the motor is driven, from its first frame on in the loop of the setpoint, or an
    /// event says why not.
    StartEnds,
}

/// A broken rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation<R = Rule> {
    /// The rule.
    pub rule: R,
    /// When, in virtual time.
    pub at: Instant,
    /// What happened.
    pub what: String,
}

impl<R: fmt::Debug> fmt::Display for Violation<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} at {:?}: {}", self.rule, self.at, self.what)
    }
}

pub(crate) type Outcome = Result<(), Violation>;

pub(crate) fn broken<T, R>(
    rule: R,
    at: Instant,
    what: impl Into<String>,
) -> Result<T, Violation<R>> {
    let what = what.into();
    Err(Violation { rule, at, what })
}
