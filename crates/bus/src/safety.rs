//! Safety decisions: pure functions from the known state to the required action.

use std::time::Duration;

use motorlink_protocol::{
    Celsius, CurrentTarget, Drive, Faults, Mode, MotorId, OpenLoopTarget, Rpm, Setpoint,
    family::Model,
};

use crate::{
    command::Consent,
    event::WithdrawReason,
    limits::{ExceededLimit, Limits},
    refusal::Refusal,
    timing::{DRIVEN_SILENCE_MAX, DRIVEN_UNANSWERED_MAX, POSITION_SWITCH_RPM},
};

/// A current above this needs consent: 25,000 raw is 6.1 A.
pub const HIGH_CURRENT_RAW: u16 = 25_000;

/// How a motor is stopped, by what is known of its loop.
///
/// A stop is zero and brake in the velocity loop. The same frame is "coast" in the current loop and
/// "turn to 0 degrees" in the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopPlan {
    /// In the velocity loop: brake, without a switch.
    Brake,
    /// A brake frame is harmless before the switch and brakes after it: send both in turn.
    BrakeWhileSwitching,
    /// A brake frame before the switch would turn the wheel: switch first.
    SwitchThenBrake,
}

/// How to stop a motor whose loop is `fresh` by a reply of the last 500 ms, or was `last` known
/// before.
#[must_use]
pub const fn stop_plan(fresh: Option<Mode>, last: Option<Mode>) -> StopPlan {
    match (fresh, last) {
        (Some(Mode::Velocity), _) => StopPlan::Brake,
        // A motor leaves a loop by itself only through a power cycle, which ends in the velocity
        // loop. So a motor that was not in the position loop is not in it now.
        // Zero in the open loop is no voltage.
        (Some(Mode::Current | Mode::OpenLoop), _)
        | (None, Some(Mode::Velocity | Mode::Current | Mode::OpenLoop)) => {
            StopPlan::BrakeWhileSwitching
        }
        (Some(Mode::Position), _) | (None, Some(Mode::Position) | None) => {
            StopPlan::SwitchThenBrake
        }
    }
}

/// The frame to send while a driven motor switches loops, harmless in both.
///
/// Zero is 0 rpm, 0 A and no voltage. No frame is harmless in the position loop and another loop: any angle
/// would be read as a speed or a current, and zero as "turn to 0 degrees". Then the drive frames
/// pause.
#[must_use]
pub(crate) fn neutral_between(from: Mode, to: Mode) -> Option<Drive> {
    match (from, to) {
        (Mode::Position, _) | (_, Mode::Position) => None,
        (
            Mode::Velocity | Mode::Current | Mode::OpenLoop,
            Mode::Velocity | Mode::Current | Mode::OpenLoop,
        ) => Some(Setpoint::Current(CurrentTarget::ZERO).into()),
    }
}

/// Checks a switch to the position loop: the motor silently refuses it at 10 rpm and above.
///
/// `speed` comes from a reply of the last 500 ms.
///
/// # Errors
/// [`Refusal::SpeedUnknown`] and [`Refusal::TooFast`].
pub const fn check_position_switch(id: MotorId, speed: Option<Rpm>) -> Result<(), Refusal> {
    match speed {
        None => Err(Refusal::SpeedUnknown(id)),
        Some(speed) if speed.magnitude() >= POSITION_SWITCH_RPM => Err(Refusal::TooFast(speed)),
        Some(_) => Ok(()),
    }
}

/// The consent that this setpoint needs.
#[must_use]
pub const fn needs_consent(setpoint: Setpoint) -> Consent {
    match setpoint {
        Setpoint::Current(target) if target.raw().unsigned_abs() > HIGH_CURRENT_RAW => {
            Consent::HighCurrent
        }
        _ => Consent::None,
    }
}

/// What replies of the last 500 ms tell about a motor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Known {
    pub(crate) reported: Option<Mode>,
    pub(crate) faults: Option<Faults>,
    pub(crate) temperature: Option<Celsius>,
}

impl Known {
    /// A motor without fresh replies.
    pub(crate) const NOTHING: Self = Self {
        reported: None,
        faults: None,
        temperature: None,
    };
}

/// Checks whether a motor may be driven to a setpoint now.
pub(crate) fn check_drive(
    model: Model,
    id: MotorId,
    setpoint: Setpoint,
    consent: Consent,
    limits: Limits,
    known: Known,
) -> Result<(), Refusal> {
    let Known {
        reported,
        faults,
        temperature,
    } = known;
    let mode = setpoint.mode();
    if !model.has(mode) {
        return Err(Refusal::NoSuchLoop { model, mode });
    }
    if let Setpoint::Velocity { speed, .. } = setpoint
        && speed.rpm().unsigned_abs() > model.spec().speed_rpm_max
    {
        return Err(Refusal::AboveSpeedOfModel(model));
    }
    if !limits.allow(setpoint) {
        return Err(Refusal::AboveSpeedLimit(limits.speed_rpm()));
    }
    if let Setpoint::Current(target) = setpoint
        && needs_consent(setpoint) != Consent::None
        && consent != Consent::HighCurrent
    {
        return Err(Refusal::NeedsConsent(target));
    }
    check_faults(id, faults)?;
    if let Some(exceeded) = limits.too_hot(temperature) {
        return Err(Refusal::TooHot { id, exceeded });
    }
    check_loop(id, mode, reported)
}

/// Checks that a motor reports no fault.
pub(crate) fn check_faults(id: MotorId, faults: Option<Faults>) -> Result<(), Refusal> {
    match faults.filter(|faults| faults.any_named()) {
        Some(faults) => Err(Refusal::FaultActive { id, faults }),
        None => Ok(()),
    }
}

/// Checks that a motor reports the loop that a setpoint is for.
pub(crate) fn check_loop(id: MotorId, asked: Mode, reported: Option<Mode>) -> Result<(), Refusal> {
    match reported {
        None => Err(Refusal::NotAnswering(id)),
        Some(reported) if reported != asked => Err(Refusal::OtherLoop {
            id,
            asked,
            reported,
        }),
        Some(_) => Ok(()),
    }
}

/// Whether a driven motor's setpoint must be withdrawn, by its last reply, the limit that it
/// exceeded and the silence since.
///
/// When a fault clears, the wheel would start by itself. A motor that lost power restarts in the
/// velocity loop, where a raw current is read as a speed.
#[must_use]
pub(crate) fn check_driven(
    asked: Option<Mode>,
    reported: Option<Mode>,
    faults: Faults,
    exceeded: Option<ExceededLimit>,
    silent_for: Duration,
    unanswered: u32,
) -> Option<WithdrawReason> {
    if faults.any_named() {
        return Some(WithdrawReason::Fault(faults));
    }
    if let (Some(asked), Some(reported)) = (asked, reported)
        && asked != reported
    {
        return Some(WithdrawReason::OtherLoop { reported });
    }
    if let Some(exceeded) = exceeded {
        return Some(WithdrawReason::Limit(exceeded));
    }
    let silent = silent_for >= DRIVEN_SILENCE_MAX && unanswered >= DRIVEN_UNANSWERED_MAX;
    silent.then_some(WithdrawReason::Silent)
}

/// The setpoint of the next frame on the way to `goal`. A torque reversal passes through a zero
/// that the motor has answered. `possible` is the current that the motor may still follow.
#[must_use]
pub(crate) fn step_towards(goal: Setpoint, possible: Option<CurrentTarget>) -> Setpoint {
    let (raw, zero) = match goal {
        Setpoint::Current(goal) => (goal.raw(), Setpoint::Current(CurrentTarget::ZERO)),
        Setpoint::OpenLoop(goal) => (goal.raw(), Setpoint::OpenLoop(OpenLoopTarget::ZERO)),
        Setpoint::Velocity { .. } | Setpoint::Brake | Setpoint::Position(_) => return goal,
    };
    let reverses = |present: CurrentTarget| i32::from(raw) * i32::from(present.raw()) < 0;
    if possible.is_some_and(reverses) {
        zero
    } else {
        goal
    }
}

#[cfg(test)]
#[path = "safety_tests.rs"]
mod tests;
