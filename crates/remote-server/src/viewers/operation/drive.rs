//! The drive of a controller, from its ARM until its motors stand: a state machine without a clock and without I/O.

use std::mem;

use motorlink_bus::{Activity, GroupSetpoints, MotorStatus};
use motorlink_controller_messages::{DriveState, EndReason};
use motorlink_driver::Status;
use motorlink_protocol::{MotorId, Setpoint};

/// The drive of a controller.
#[derive(Debug, Default)]
pub(super) struct Drive {
    /// The motors of the newest ARM that was done.
    pub(super) motors: Vec<MotorId>,
    phase: Phase,
}

/// How far the drive has come.
#[derive(Debug, Default)]
enum Phase {
    /// Nothing was armed.
    #[default]
    None,
    /// The motors are stopped or switched to the velocity loop first.
    Starting(Live),
    /// The motors follow the setpoints.
    Driven(Live),
    /// The drive has ended, and its motors are being stopped.
    Stopping(EndReason),
    /// The stop has ended, and not every motor has confirmed that it stands.
    NotConfirmed(EndReason),
    /// Every motor has confirmed that it stands.
    Stands(EndReason),
}

/// What a drive has until it ends.
#[derive(Debug)]
struct Live {
    /// The setpoints that the bus has. Empty if that is not known.
    given: Vec<(MotorId, Setpoint)>,
    /// Why the drive may have ended, by the first event that tells it.
    may_end: Option<EndReason>,
}

impl Drive {
    /// The bus has been told to start these motors.
    pub(super) fn start(given: Vec<(MotorId, Setpoint)>) -> Self {
        let motors = given.iter().map(|(id, _)| *id).collect();
        let may_end = None;
        let phase = Phase::Starting(Live { given, may_end });
        Self { motors, phase }
    }

    /// As the controller is told.
    pub(super) const fn told(&self) -> (DriveState, EndReason) {
        match self.phase {
            Phase::None => (DriveState::None, EndReason::None),
            Phase::Starting(_) => (DriveState::Starting, EndReason::None),
            Phase::Driven(_) => (DriveState::Driven, EndReason::None),
            Phase::Stopping(why) => (DriveState::Stopping, why),
            Phase::NotConfirmed(why) => (DriveState::NotConfirmed, why),
            Phase::Stands(why) => (DriveState::Stands, why),
        }
    }

    /// Whether its motors are driven, or will be.
    pub(super) const fn is_live(&self) -> bool {
        matches!(self.phase, Phase::Starting(_) | Phase::Driven(_))
    }

    /// What it has while it is live. `of`: only if it has this motor.
    fn live(&mut self, of: Option<MotorId>) -> Option<&mut Live> {
        match &mut self.phase {
            Phase::Starting(live) | Phase::Driven(live)
                if of.is_none_or(|id| self.motors.contains(&id)) =>
            {
                Some(live)
            }
            _ => None,
        }
    }

    /// Its motors are being stopped. `of`: only if it has this motor. Returns whether a live drive has ended.
    pub(super) fn end(&mut self, of: Option<MotorId>, why: EndReason) -> bool {
        let ends = self.live(of).is_some();
        if ends {
            self.phase = Phase::Stopping(why);
        }
        ends
    }

    /// It may have ended for this reason: the next status shows it. `of`: only if it has this motor.
    pub(super) fn may_end(&mut self, of: Option<MotorId>, why: EndReason) {
        if let Some(live) = self.live(of) {
            live.may_end.get_or_insert(why);
        }
    }

    /// Why these speeds end the drive, if they do.
    pub(super) fn check(&self, speeds: &[(MotorId, f32)]) -> Option<EndReason> {
        let ids = speeds.iter().map(|(id, _)| id);
        if !self.is_live() {
            None
        } else if !speeds.iter().all(|(_, speed)| speed.is_finite()) {
            Some(EndReason::NotFinite)
        } else {
            (!ids.eq(&self.motors)).then_some(EndReason::OtherMotors)
        }
    }

    /// The controller gives new setpoints. Returns those that the bus needs.
    pub(super) fn adjust(&mut self, new: Vec<(MotorId, Setpoint)>) -> Option<GroupSetpoints> {
        // While the motors are stopped or switched first, a zero would end their start. A zero that is only repeated
        // would cut the replies of other motors short.
        let Phase::Driven(live) = &mut self.phase else {
            return None;
        };
        let setpoints = GroupSetpoints::new(&new)
            .ok()
            .filter(|_| live.given != new)?;
        live.given = new;
        Some(setpoints)
    }

    /// Follows what the bus does with the motors. Returns those that may be driven although the drive has ended by this.
    pub(super) fn follow(&mut self, status: &Status) -> Vec<MotorId> {
        let has = |&(id, setpoint): &(MotorId, Setpoint)| {
            let motor = status.motor(id);
            motor.is_some_and(|motor| motor.activity == Activity::Driven { setpoint })
        };
        // The bus has refused a setpoint, or has not heard of it yet: the next one is given, whatever it is.
        if let Some(live) = self.live(None)
            && !live.given.iter().all(has)
        {
            live.given.clear();
        }
        let motors: Vec<_> = self.motors.iter().map(|id| status.motor(*id)).collect();
        let mut may_drive = Vec::new();
        self.phase = match mem::take(&mut self.phase) {
            Phase::Starting(live) | Phase::Driven(live) if are_all(&motors, is_driven) => {
                // What happened before this status has ended nothing.
                let may_end = None;
                Phase::Driven(Live { may_end, ..live })
            }
            Phase::Starting(live) if are_all(&motors, is_live) => Phase::Starting(live),
            Phase::Starting(live) | Phase::Driven(live) => {
                let driven = motors.iter().flatten().filter(|motor| is_live(motor));
                may_drive.extend(driven.map(|motor| motor.id));
                standing(&motors, live.may_end.unwrap_or(EndReason::ServerStopped))
            }
            Phase::Stopping(why) | Phase::NotConfirmed(why) => standing(&motors, why),
            phase @ (Phase::None | Phase::Stands(_)) => phase,
        };
        may_drive
    }
}

fn is_driven(motor: &MotorStatus) -> bool {
    matches!(motor.activity, Activity::Driven { .. }) && motor.waiting.is_none()
}

/// Whether it is driven, or will be.
fn is_live(motor: &MotorStatus) -> bool {
    let is_switched = matches!(motor.activity, Activity::Switching { .. });
    is_driven(motor) || is_switched || motor.waiting.is_some()
}

/// Whether this is so of each motor. Of one that is not there, nothing is known.
fn are_all(motors: &[Option<&MotorStatus>], so: fn(&MotorStatus) -> bool) -> bool {
    motors.iter().all(|motor| motor.is_some_and(so))
}

/// Whether the motors of a drive that has ended stand.
fn standing(motors: &[Option<&MotorStatus>], why: EndReason) -> Phase {
    let mut known = motors.iter().flatten();
    if known.any(|motor| matches!(motor.activity, Activity::Stopping { .. })) {
        Phase::Stopping(why)
    } else if are_all(motors, |motor| !motor.may_turn) {
        Phase::Stands(why)
    } else {
        Phase::NotConfirmed(why)
    }
}
