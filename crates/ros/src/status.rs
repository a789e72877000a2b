//! How the drive and each motor are: one judgement, for `/diagnostics` and for the fleet.

use std::fmt;

use motorlink_controller_messages::{Activity, DriveState, EndReason, Motor, NotArmed, State};
use serde::{Deserialize, Serialize};

use crate::drive::Why;

/// How bad it is. The order is that of `diagnostic_msgs`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// As it should be.
    Ok,
    /// A person should look.
    Warning,
    /// Something has failed.
    Error,
    /// Nothing is known.
    Stale,
}

/// The way to the motors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// motorlink is not connected.
    NoConnection,
    /// motorlink has no serial port.
    NoPort,
    /// The port is open.
    Open,
}

/// What the drive does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// The motors follow `cmd_vel`.
    Drives,
    /// A page or another client drives motors.
    DrivenByOther,
    /// They are being started.
    Starting,
    /// They are being stopped.
    Stopping,
    /// This program drives nothing.
    Stopped,
    /// Not every motor is known to stand.
    NotConfirmed,
}

/// How the drive is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveStatus {
    /// The way to the motors.
    pub link: Link,
    /// What it does.
    pub phase: Phase,
    /// Why it does not drive.
    pub why: Option<Why>,
    /// It drives only after `cmd_vel` has rested.
    pub must_rest: bool,
}

impl DriveStatus {
    /// From the newest state of motorlink, and from what this program does. Without a connection, nobody knows whether the motors stand.
    #[must_use]
    pub fn of(state: Option<&State>, drives: Result<(), Why>, must_rest: bool) -> Self {
        let link = match state {
            None => Link::NoConnection,
            Some(state) if !state.is_open => Link::NoPort,
            Some(_) => Link::Open,
        };
        let phase = match (drives, state.map(|state| state.drive)) {
            (_, None | Some(DriveState::NotConfirmed)) => Phase::NotConfirmed,
            (Ok(()), _) => Phase::Drives,
            (_, Some(DriveState::Starting)) => Phase::Starting,
            // It still turns when motorlink has not read yet that it must not.
            (_, Some(DriveState::Stopping | DriveState::Driven)) => Phase::Stopping,
            (_, Some(DriveState::None | DriveState::Stands)) => {
                state.map_or(Phase::Stopped, without_own_drive)
            }
        };
        let why = match link {
            Link::NoConnection => Some(Why::NoConnection),
            _ => drives.err(),
        };
        Self {
            link,
            phase,
            why,
            must_rest,
        }
    }

    /// Whether it was stopped by a person or because something failed: it may not be left alone.
    const fn is_held(self) -> bool {
        match self.why {
            None
            | Some(
                Why::NotAsked
                // The link says whether there is one now.
                | Why::NoConnection
                | Why::Refused(NotArmed::PageHasControl | NotArmed::OtherHasControl)
                | Why::Ended(EndReason::None | EndReason::Disarmed | EndReason::Taken),
            ) => false,
            Some(_) => true,
        }
    }

    /// How bad it is.
    #[must_use]
    pub const fn level(self) -> Level {
        match (self.link, self.phase) {
            (Link::NoConnection | Link::NoPort, _) | (_, Phase::NotConfirmed) => Level::Error,
            (_, Phase::Stopped) if self.must_rest || self.is_held() => Level::Warning,
            _ => Level::Ok,
        }
    }
}

impl fmt::Display for DriveStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let why = self.why.map_or_else(
            || "the reason is not known".to_owned(),
            |why| why.to_string(),
        );
        match (self.link, self.phase) {
            (Link::NoConnection, _) => f.write_str("no connection to motorlink"),
            (Link::NoPort, _) => f.write_str("motorlink has no serial port"),
            (_, Phase::Drives) => f.write_str("drives"),
            (_, Phase::DrivenByOther) => f.write_str("driven by a page or another client"),
            (_, Phase::Starting) => f.write_str("starting"),
            (_, Phase::Stopping) => f.write_str("the motors are being stopped"),
            (_, Phase::NotConfirmed) => {
                write!(f, "NOT CONFIRMED THAT THE MOTORS STAND. Stopped: {why}")
            }
            (_, Phase::Stopped) if self.must_rest => write!(
                f,
                "stopped: {why}. Drives again after cmd_vel has rested for 2 s"
            ),
            (_, Phase::Stopped) => write!(f, "stopped: {why}"),
        }
    }
}

/// What the motors do that this program does not drive.
fn without_own_drive(state: &State) -> Phase {
    let does = |activities: &[Activity]| {
        let mut motors = state.motors.iter();
        motors.any(|motor| activities.contains(&motor.activity))
    };
    if does(&[Activity::Driven, Activity::Switching, Activity::DrivenRaw]) {
        Phase::DrivenByOther
    } else if does(&[Activity::Stopping]) {
        Phase::Stopping
    } else {
        Phase::Stopped
    }
}

/// How a motor is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorStatus {
    /// motorlink does not know it.
    NoReplyYet,
    /// It has not replied for 2 s.
    Silent,
    /// It reports these.
    Faults(u8),
    /// It was driven, and may still turn.
    NotConfirmed,
    /// It turns though nothing drives it.
    TurnsUnasked,
    /// Nothing is wrong.
    Does(Activity),
}

impl MotorStatus {
    /// From the newest state of motorlink, if that names the motor.
    #[must_use]
    pub fn of(motor: Option<&Motor>) -> Self {
        let Some(motor) = motor else {
            return Self::NoReplyYet;
        };
        match motor.faults {
            _ if motor.is_silent => Self::Silent,
            Some(faults) if faults != 0 => Self::Faults(faults),
            _ if motor.may_turn && motor.activity == Activity::Idle => Self::NotConfirmed,
            _ if motor.turns_unasked => Self::TurnsUnasked,
            _ => Self::Does(motor.activity),
        }
    }

    /// How bad it is.
    #[must_use]
    pub const fn level(self) -> Level {
        match self {
            Self::NoReplyYet | Self::Silent => Level::Stale,
            Self::Faults(_) | Self::NotConfirmed => Level::Error,
            Self::TurnsUnasked => Level::Warning,
            Self::Does(_) => Level::Ok,
        }
    }
}

impl fmt::Display for MotorStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoReplyYet => "no reply yet",
            Self::Silent => "no reply for 2 s",
            Self::Faults(faults) => return write!(f, "faults {faults:#04x}"),
            Self::NotConfirmed => "has not confirmed that it stands",
            Self::TurnsUnasked => "turns though nothing drives it",
            Self::Does(Activity::Idle) => "idle",
            Self::Does(Activity::Driven) => "driven",
            Self::Does(Activity::Stopping) => "is being stopped",
            Self::Does(Activity::Switching) => "is switched to another loop",
            Self::Does(Activity::DrivenRaw) => "driven by a raw frame",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::tests::{motor, state};

    fn status(activity: Activity, why: Why) -> DriveStatus {
        let doing = Motor {
            activity,
            ..motor(1)
        };
        DriveStatus::of(Some(&state(vec![doing, motor(2)])), Err(why), false)
    }

    #[test]
    fn what_others_drive_does_not_stand() {
        let phase = |activity| status(activity, Why::NotAsked).phase;
        assert_eq!(phase(Activity::Driven), Phase::DrivenByOther);
        assert_eq!(phase(Activity::DrivenRaw), Phase::DrivenByOther);
        assert_eq!(phase(Activity::Stopping), Phase::Stopping);
        assert_eq!(phase(Activity::Idle), Phase::Stopped);
    }

    #[test]
    fn what_a_person_or_a_failure_has_stopped_is_no_good_state() {
        let level = |why| status(Activity::Idle, why).level();
        for why in [
            Why::EStop,
            Why::Refused(NotArmed::StoppedByPerson),
            Why::Ended(EndReason::Stopped),
            Why::Ended(EndReason::Fault),
            Why::Ended(EndReason::Limit),
            Why::Frozen,
        ] {
            assert_eq!(level(why), Level::Warning, "{why}");
        }
        for why in [Why::NotAsked, Why::Refused(NotArmed::PageHasControl)] {
            assert_eq!(level(why), Level::Ok, "{why}");
        }
    }
}
