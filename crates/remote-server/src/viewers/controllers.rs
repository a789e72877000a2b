//! What the controllers on the socket may do. They hold the same lease as the pages.

use std::{collections::BTreeMap, f64::consts::TAU, sync::Arc};

use motorlink_bus::{Activity, Command, Consent, GroupSetpoints, Limits, MotorStatus, StopReason};
use motorlink_driver::Status;
use motorlink_protocol::{Instant, MotorId, Setpoint, SpeedTarget, family::Model};
use motorlink_remote::{Ended, Participant, Stamp, Taken, ViewerId};
use tokio::sync::watch;

use super::{State, Viewers};
use crate::control_socket::{DriveState, EndReason, Line, NotArmed, Order};

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
pub(super) struct Controllers {
    list: BTreeMap<ViewerId, Controller>,
    /// How often a drive has begun or was ended here.
    changes: u32,
    /// Who has armed them and holds the lease.
    armed: Option<ViewerId>,
    /// Why the drive may have ended, by the first event that tells it.
    may_end: EndReason,
    limits: Limits,
    /// The greatest speed of the model; none is known before the first state of the driver.
    rpm_max: u16,
}

struct Controller {
    own: watch::Sender<Own>,
    sequence: u32,
    /// The setpoints that the bus has.
    given: Vec<(MotorId, Setpoint)>,
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
            self.changes += 1;
            controller.own.send_if_modified(|own| {
                let is_alive = own.is_alive();
                if is_alive {
                    (own.drive, own.ended) = (DriveState::Stopping, why);
                }
                is_alive
            });
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

    /// A speed in the limits of operator and model, at the resolution of the motors.
    fn target(&self, rad_per_s: f32) -> SpeedTarget {
        let max = f64::from(self.limits.speed_rpm().min(self.rpm_max));
        let rpm = (f64::from(rad_per_s) * 60.0 / TAU).clamp(-max, max).round();
        #[expect(clippy::cast_possible_truncation, reason = "a speed within the limits")]
        SpeedTarget::clamped(rpm as i32)
    }
}

impl Own {
    /// Whether its motors are driven, or will be.
    const fn is_alive(&self) -> bool {
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

impl State {
    /// Takes control and starts these motors at 0 rpm.
    fn arm(&mut self, now: Instant, viewer: ViewerId, order: &Order) -> Result<(), NotArmed> {
        if order.speeds.iter().any(|(_, speed)| *speed != 0.0) {
            return Err(NotArmed::NotZero);
        }
        let operator = self.control.operator();
        let holds = operator.is_some_and(|(_, epoch)| self.control.holds(now, viewer, epoch));
        let is_alive = |it: &Controller| it.own.borrow().is_alive();
        if holds && self.controllers.list.get(&viewer).is_some_and(is_alive) {
            return Err(NotArmed::StillDriven);
        }
        let zero = Setpoint::velocity(SpeedTarget::ZERO);
        let given: Vec<_> = order.speeds.iter().map(|(id, _)| (*id, zero)).collect();
        let setpoints = GroupSetpoints::new(&given).map_err(|_| NotArmed::Late)?;
        let taken = self.control.arm(now, viewer, order.challenge);
        match taken.map_err(|_| NotArmed::Late)? {
            Taken::Granted(ended) => self.stop_after(ended),
            Taken::Held => {}
            Taken::Asked => {
                self.tell_control();
                let operator = self.control.operator();
                let is_socket = operator.is_some_and(|(holder, _)| self.controllers.has(holder));
                return Err(if is_socket {
                    NotArmed::OtherHasControl
                } else {
                    NotArmed::PageHasControl
                });
            }
        }
        // The start is an explicit act, so it releases an earlier stop.
        self.commander.command(Command::Release);
        self.commander.command(Command::StartGroup {
            setpoints,
            consent: Consent::None,
        });
        let controllers = &mut self.controllers;
        controllers.changes += 1;
        controllers.armed = Some(viewer);
        controllers.may_end = EndReason::None;
        if let Some(controller) = controllers.list.get_mut(&viewer) {
            controller.own.send_modify(|own| {
                own.motors = given.iter().map(|(id, _)| *id).collect();
                (own.drive, own.ended) = (DriveState::Starting, EndReason::None);
            });
            controller.given = given;
        }
        self.tell_control();
        Ok(())
    }

    /// Gives new setpoints to the bus, if this controller drives.
    fn setpoints(&mut self, now: Instant, viewer: ViewerId, order: &Order) {
        let operator = self.control.operator();
        let Some((_, epoch)) = operator.filter(|(holder, _)| *holder == viewer) else {
            return;
        };
        let Some(controller) = self.controllers.list.get_mut(&viewer) else {
            return;
        };
        let own = controller.own.borrow().clone();
        let ids = order.speeds.iter().map(|(id, _)| *id);
        if own.is_alive() {
            let wrong = if !order.speeds.iter().all(|(_, speed)| speed.is_finite()) {
                Some(EndReason::NotFinite)
            } else if !ids.eq(own.motors.iter().copied()) {
                Some(EndReason::OtherMotors)
            } else {
                None
            };
            if let Some(why) = wrong {
                self.controllers.drive_ended(why);
                self.disarm(viewer);
                return;
            }
        }
        controller.sequence += 1;
        let stamp = Stamp {
            epoch,
            sequence: controller.sequence,
            challenge: order.challenge,
        };
        let done = self.control.act(now, viewer, stamp, true);
        // While the motors are stopped or switched first, a zero would end their start.
        if done.is_err() || own.drive != DriveState::Driven {
            return;
        }
        let given: Vec<_> = order
            .speeds
            .iter()
            .map(|(id, speed)| (*id, Setpoint::velocity(self.controllers.target(*speed))))
            .collect();
        // A zero that is only repeated would cut the replies of other motors short.
        let Some(controller) = self.controllers.list.get_mut(&viewer) else {
            return;
        };
        if controller.given != given
            && let Ok(setpoints) = GroupSetpoints::new(&given)
        {
            controller.given = given;
            self.commander.command(Command::AdjustGroup {
                setpoints,
                consent: Consent::None,
            });
        }
    }

    /// Stops what this controller drives, and gives up its control.
    fn disarm(&mut self, viewer: ViewerId) {
        let ended = self.control.give_up(viewer);
        self.stop_after(ended);
        self.tell_control();
    }
}

impl Viewers {
    /// A controller has connected. Returns nothing if there are too many.
    pub(crate) fn join_controller(&self) -> Option<(ViewerId, watch::Receiver<Own>)> {
        let mut state = self.state();
        let now = state.clock.now();
        let viewer = state.control.join(now, Participant::Controller)?;
        let (own, told) = watch::channel(Own::default());
        let controller = Controller {
            own,
            sequence: 0,
            given: Vec::new(),
        };
        state.controllers.list.insert(viewer, controller);
        let operator = state.control.operator();
        let operator = operator.map(|(holder, _)| holder);
        state.controllers.tell_operator(operator);
        Some((viewer, told))
    }

    /// The controller asks for control, and starts its motors at 0 rpm.
    pub(crate) fn arm(&self, viewer: ViewerId, order: &Order) {
        let mut state = self.state();
        let now = state.clock.now();
        state.control.answer(now, viewer, order.challenge);
        let armed = state.arm(now, viewer, order);
        if let Some(controller) = state.controllers.list.get(&viewer) {
            let arm = (order.number, armed.err());
            controller.own.send_modify(|own| own.arm = arm);
        }
    }

    /// Setpoints, which answer a challenge too.
    pub(crate) fn setpoints(&self, viewer: ViewerId, order: &Order) {
        let mut state = self.state();
        let now = state.clock.now();
        state.control.answer(now, viewer, order.challenge);
        state.setpoints(now, viewer, order);
    }

    pub(crate) fn disarm(&self, viewer: ViewerId) {
        self.state().disarm(viewer);
    }

    /// A client of the text form stops all motors, as a page that watches does.
    pub(crate) fn stop_all(&self) {
        let mut state = self.state();
        let now = state.clock.now();
        let stop = Command::StopAll(StopReason::Operator);
        state.commander.command(stop);
        state.control.stopped_by_other(now);
        state.controllers.stopped_by(stop);
    }

    /// Who has control, as a text shows it.
    pub(crate) fn operator_name(&self) -> String {
        let state = self.state();
        let operator = state.control.operator();
        let named = operator.and_then(|(holder, _)| state.named(holder));
        named.map_or_else(
            || "nobody".to_owned(),
            |viewer| format!("viewer {} ({})", viewer.number, viewer.address),
        )
    }

    /// How often the drives of controllers have changed, for [`Self::judge`].
    pub(crate) fn drive_changes(&self) -> u32 {
        self.state().controllers.changes
    }

    /// The drive of a controller may have ended for this reason. `of`: only if it is that of this motor.
    pub(crate) fn drive_may_end(&self, of: Option<MotorId>, why: EndReason) {
        let mut state = self.state();
        let controllers = &mut state.controllers;
        let armed = controllers
            .armed
            .and_then(|armed| controllers.list.get(&armed));
        let concerns = armed.is_some_and(|controller| {
            let own = controller.own.borrow();
            own.is_alive() && of.is_none_or(|id| own.motors.contains(&id))
        });
        if concerns && controllers.may_end == EndReason::None {
            controllers.may_end = why;
        }
    }

    /// Follows what the bus does. `status` was asked for after `changes` was read, so it shows what followed from them.
    pub(crate) fn judge(&self, changes: u32, status: &Status, model: Model) {
        let mut state = self.state();
        let controllers = &mut state.controllers;
        controllers.rpm_max = model.spec().speed_rpm_max;
        if controllers.changes != changes {
            return;
        }
        let mut stopped = Vec::new();
        for controller in controllers.list.values() {
            controller.own.send_if_modified(|own| {
                let before = (own.drive, own.is_alive());
                let motors: Vec<_> = own.motors.iter().map(|id| status.motor(*id)).collect();
                own.judge(&motors, controllers.may_end);
                if before.1 && !own.is_alive() {
                    let motors = motors.iter().flatten();
                    let may_drive = motors.filter(|motor| is_driven(motor) || is_starting(motor));
                    stopped.extend(may_drive.map(|motor| motor.id));
                }
                before.0 != own.drive
            });
        }
        // The bus has stopped them as one. This makes sure of it: nobody gives them setpoints any more.
        for id in stopped {
            state.commander.command(Command::Stop(id));
        }
    }

    /// Whether a client of the socket is there.
    pub(crate) fn has_clients(&self) -> bool {
        self.0.line.receiver_count() > 0
    }

    /// The newest state of the line, for the clients of the socket.
    pub(crate) fn line(&self) -> watch::Receiver<Arc<Line>> {
        self.0.line.subscribe()
    }

    pub(crate) fn tell_line(&self, line: Arc<Line>) {
        self.0.line.send_replace(line);
    }
}
