//! The controllers on the socket, and what becomes of what one of them drives.

use std::{collections::BTreeMap, f64::consts::TAU};

use motorlink_bus::{Activity, Command, Limits, MotorStatus};
use motorlink_driver::Status;
use motorlink_protocol::{MotorId, Setpoint, SpeedTarget, family::Model};
use motorlink_remote::{Ended, ViewerId};
use tokio::sync::watch;

use motorlink_controller_messages::{DriveState, EndReason, NotArmed};

/// What one controller is told beside the state of the motors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Own {
    pub(crate) challenge: u64,
    /// The number of its newest ARM, and what became of it.
    pub(crate) arm: (u32, Option<NotArmed>),
    pub(crate) drive: DriveState,
    pub(crate) ended: EndReason,
    /// The motors of its newest ARM that was done.
    pub(crate) motors: Vec<MotorId>,
    /// Who has control, and whether it is a page.
    pub(crate) operator: Option<(ViewerId, bool)>,
}

/// The controllers, and what one of them drives.
#[derive(Debug)]
pub(super) struct Controllers {
    pub(super) list: BTreeMap<ViewerId, Controller>,
    /// How many drives have begun or ended. A status that was asked for before the newest change tells nothing of it.
    pub(super) changes: u32,
    /// The controller that has armed motors and holds the lease.
    pub(super) armed: Option<ViewerId>,
    /// Why the drive may have ended, by the first event that tells it.
    pub(super) may_end: EndReason,
    limits: Limits,
    /// The greatest speed of the model; none is known before the first state of the driver.
    rpm_max: u16,
}

#[derive(Debug)]
pub(super) struct Controller {
    pub(super) own: watch::Sender<Own>,
    /// The number of its newest setpoints.
    pub(super) sequence: u32,
    /// The setpoints that the bus has.
    pub(super) given: Vec<(MotorId, Setpoint)>,
}

impl Default for Controllers {
    fn default() -> Self {
        Self {
            list: BTreeMap::new(),
            changes: 0,
            armed: None,
            may_end: EndReason::None,
            limits: Limits::default(),
            rpm_max: 0,
        }
    }
}

impl Controllers {
    /// Tells a controller its challenge. Returns false if this viewer is none.
    pub(super) fn challenge(&self, viewer: ViewerId, challenge: u64) -> bool {
        let controller = self.list.get(&viewer);
        if let Some(controller) = controller {
            controller.own.send_modify(|own| own.challenge = challenge);
        }
        controller.is_some()
    }

    pub(super) fn has(&self, viewer: ViewerId) -> bool {
        self.list.contains_key(&viewer)
    }

    pub(super) fn remove(&mut self, viewer: ViewerId) {
        self.list.remove(&viewer);
    }

    /// The operator has given the bus these limits.
    pub(super) const fn limited_by(&mut self, limits: Limits) {
        self.limits = limits;
    }

    /// The lease has ended. If a controller held it, its motors are being stopped.
    pub(super) fn lease_ended(&mut self, why: Ended) {
        self.drive_ended(match why {
            Ended::Silent | Ended::Gone => EndReason::LeaseEnded,
            Ended::GivenUp => EndReason::Disarmed,
            Ended::Taken => EndReason::Taken,
        });
        self.armed = None;
    }

    /// What a controller drives is being stopped, if it was not before. The next ARM starts it again.
    pub(super) fn drive_ended(&mut self, why: EndReason) {
        let armed = self.armed.and_then(|armed| self.list.get(&armed));
        if let Some(controller) = armed {
            let has_ended = controller.own.send_if_modified(|own| {
                let is_alive = own.is_alive();
                if is_alive {
                    (own.drive, own.ended) = (DriveState::Stopping, why);
                }
                is_alive
            });
            self.changes += u32::from(has_ended);
        }
    }

    /// A person stops motors by this command. If a controller drives them, its drive has ended.
    pub(super) fn stopped_by(&mut self, stop: Command) {
        let armed = self.armed.and_then(|armed| self.list.get(&armed));
        let ends = match stop {
            Command::StopAll(_) => true,
            Command::Stop(id) => {
                armed.is_some_and(|controller| controller.own.borrow().motors.contains(&id))
            }
            _ => false,
        };
        if ends {
            self.drive_ended(EndReason::Stopped);
        }
    }

    pub(super) fn tell_operator(&self, operator: Option<ViewerId>) {
        let operator = operator.map(|operator| (operator, !self.has(operator)));
        for controller in self.list.values() {
            controller.own.send_if_modified(|own| {
                let is_new = own.operator != operator;
                own.operator = operator;
                is_new
            });
        }
    }

    /// The drive may have ended for this reason. `of`: only a drive with this motor.
    pub(super) fn drive_may_end(&mut self, of: Option<MotorId>, why: EndReason) {
        let armed = self.armed.and_then(|armed| self.list.get(&armed));
        let concerns = armed.is_some_and(|controller| {
            let own = controller.own.borrow();
            own.is_alive() && of.is_none_or(|id| own.motors.contains(&id))
        });
        if concerns && self.may_end == EndReason::None {
            self.may_end = why;
        }
    }

    /// Follows what the bus does, by a state that was asked for after so many `changes`. Returns motors that may be driven
    /// although their drive has ended.
    pub(super) fn judge(&mut self, changes: u32, status: &Status, model: Model) -> Vec<MotorId> {
        self.rpm_max = model.spec().speed_rpm_max;
        let mut stopped = Vec::new();
        if self.changes != changes {
            return stopped;
        }
        for controller in self.list.values_mut() {
            // The bus has refused a setpoint, or has not heard of it yet: the next one is given, whatever it is.
            let has = |(id, setpoint): &(MotorId, Setpoint)| {
                let setpoint = *setpoint;
                let motor = status.motor(*id);
                motor.is_some_and(|motor| motor.activity == Activity::Driven { setpoint })
            };
            if !controller.given.iter().all(has) {
                controller.given.clear();
            }
            let may_end = self.may_end;
            controller.own.send_if_modified(|own| {
                let (before, was_alive) = (own.drive, own.is_alive());
                let motors: Vec<_> = own.motors.iter().map(|id| status.motor(*id)).collect();
                own.judge(&motors, may_end);
                if was_alive && !own.is_alive() {
                    let motors = motors.iter().flatten();
                    let may_drive = motors.filter(|motor| is_driven(motor) || is_starting(motor));
                    stopped.extend(may_drive.map(|motor| motor.id));
                }
                before != own.drive
            });
        }
        // What happened before this state has ended nothing.
        let armed = self.armed.and_then(|armed| self.list.get(&armed));
        if armed.is_some_and(|controller| controller.own.borrow().drive == DriveState::Driven) {
            self.may_end = EndReason::None;
        }
        stopped
    }

    /// A speed in the limits of operator and model, at the resolution of the motors.
    pub(super) fn target(&self, rad_per_s: f32) -> SpeedTarget {
        let max = f64::from(self.limits.speed_rpm().min(self.rpm_max));
        let rpm = (f64::from(rad_per_s) * 60.0 / TAU).clamp(-max, max).round();
        #[expect(clippy::cast_possible_truncation, reason = "a speed within the limits")]
        SpeedTarget::clamped(rpm as i32)
    }
}

impl Own {
    /// Whether its motors are driven, or will be.
    pub(super) const fn is_alive(&self) -> bool {
        matches!(self.drive, DriveState::Starting | DriveState::Driven)
    }

    /// Follows what the bus does with the motors of this drive.
    fn judge(&mut self, motors: &[Option<&MotorStatus>], may_end: EndReason) {
        let all = |is: &dyn Fn(&MotorStatus) -> bool| {
            let mut motors = motors.iter();
            motors.all(|motor| motor.is_some_and(is))
        };
        match self.drive {
            DriveState::None | DriveState::Stands => {}
            DriveState::Starting | DriveState::Driven if all(&is_driven) => {
                self.drive = DriveState::Driven;
            }
            DriveState::Starting if all(&|motor| is_driven(motor) || is_starting(motor)) => {}
            DriveState::Starting | DriveState::Driven => {
                self.drive = standing(motors);
                self.ended = match may_end {
                    EndReason::None => EndReason::ServerStopped,
                    why => why,
                };
            }
            DriveState::Stopping | DriveState::NotConfirmed => self.drive = standing(motors),
        }
    }
}

fn is_driven(motor: &MotorStatus) -> bool {
    matches!(motor.activity, Activity::Driven { .. }) && motor.waiting.is_none()
}

fn is_starting(motor: &MotorStatus) -> bool {
    motor.waiting.is_some() || matches!(motor.activity, Activity::Switching { .. })
}

/// Whether these motors stand. Of one that is not there, nothing is known.
fn standing(motors: &[Option<&MotorStatus>]) -> DriveState {
    let mut known = motors.iter().flatten();
    if known.any(|motor| matches!(motor.activity, Activity::Stopping { .. })) {
        DriveState::Stopping
    } else if motors
        .iter()
        .all(|motor| motor.is_some_and(|motor| !motor.may_turn))
    {
        DriveState::Stands
    } else {
        DriveState::NotConfirmed
    }
}
