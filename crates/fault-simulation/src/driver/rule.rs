//! What must hold for a driver on a computer that fails: the rules by name.

use std::time::Duration;

use strum::VariantArray;

use crate::rule::Violation;

/// On a good port a wheel stands within this, from any speed.
pub(super) const STANDS_WITHIN: Duration = Duration::from_millis(1_500);

/// A rule's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, VariantArray)]
pub enum DriverRule {
    /// A motor is driven only if the program of this process has asked for it on this port.
    DrivenByProgramOnly,
    /// What turns, or is driven, is named by the file, or the program was told that it is not.
    IsRemembered,
    /// On a good port a stop lets the wheels stand in time.
    StopsInTime,
    /// What an earlier process or port left driven stands in time once the port is good.
    LeftIsStopped,
    /// The motors of a program that answers nothing stand in time.
    SilentProgramIsStopped,
    /// The motors of a driver that fails stand in time.
    FailureStops,
    /// A driver ends only if it is asked to, and names every motor that may turn.
    EndingIsTrue,
    /// On a good port a driver ends with every motor at rest, and says so.
    EndsAtRest,
    /// A driver ends in time on every port.
    EndsInTime,
    /// An opening ends in time on every port.
    OpensInTime,
    /// On a good port the model of the motors is found.
    FindsModel,
    /// The loss of a port is told in time, with what was driven.
    LossIsTold,
    /// A port that is back is opened in time.
    ComesBack,
    /// A question for the state is answered in time.
    StatusIsAnswered,
}

/// A broken rule.
pub type DriverViolation = Violation<DriverRule>;

pub(super) type Outcome = Result<(), DriverViolation>;
