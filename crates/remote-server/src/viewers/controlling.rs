//! What a controller asks for, checked against the lease and given to the driver.

use std::sync::Arc;

use motorlink_bus::{Command, Consent, GroupSetpoints, StopReason};
use motorlink_controller_messages::{DriveState, EndReason, NotArmed, Setpoints};
use motorlink_driver::Status;
use motorlink_protocol::{Instant, MotorId, Setpoint, SpeedTarget, family::Model};
use motorlink_remote::{Participant, Stamp, Taken, ViewerId};
use tokio::sync::watch;

use super::{
    State, Viewers,
    controllers::{Controller, Own},
};
use crate::control_socket::Line;

impl State {
    /// Takes control and starts these motors at 0 rpm.
    fn arm(&mut self, now: Instant, viewer: ViewerId, order: &Setpoints) -> Result<(), NotArmed> {
        if order.speeds.iter().any(|(_, speed)| *speed != 0.0) {
            return Err(NotArmed::NotZero);
        }
        let operator = self.control.operator();
        let holds = operator.is_some_and(|(_, epoch)| self.control.holds(now, viewer, epoch));
        let is_alive = |it: &Controller| it.own.borrow().is_alive();
        if holds && self.controllers.list.get(&viewer).is_some_and(is_alive) {
            return Err(NotArmed::StillDriven);
        }
        if self.is_stopped_by_person {
            return Err(NotArmed::StoppedByPerson);
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
        // It releases the stop of an earlier lease.
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
    fn setpoints(&mut self, now: Instant, viewer: ViewerId, order: &Setpoints) {
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
        // After weeks. The next ARM would need a new connection, so this one ends what it drives.
        let Some(sequence) = controller.sequence.checked_add(1) else {
            self.disarm(viewer);
            return;
        };
        controller.sequence = sequence;
        let stamp = Stamp {
            epoch,
            sequence,
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
        drop(state);
        // Its first state has a challenge.
        self.turn();
        Some((viewer, told))
    }

    /// The controller asks for control, and starts its motors at 0 rpm.
    pub(crate) fn arm(&self, viewer: ViewerId, order: &Setpoints) {
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
    pub(crate) fn setpoints(&self, viewer: ViewerId, order: &Setpoints) {
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
        state.is_stopped_by_person = true;
        state.control.stopped_by_other(now);
        state.controllers.stopped_by(stop);
    }

    /// A person at the text form lets controllers start motors again. It starts none.
    pub(crate) fn release(&self) {
        self.state().is_stopped_by_person = false;
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

    /// The drive of a controller may have ended for this reason. `of`: only a drive with this motor.
    pub(crate) fn drive_may_end(&self, of: Option<MotorId>, why: EndReason) {
        self.state().controllers.drive_may_end(of, why);
    }

    /// Follows what the bus does. `status` was asked for after `changes` was read, so it shows what followed from them.
    pub(crate) fn judge(&self, changes: u32, status: &Status, model: Model) {
        let mut state = self.state();
        let stopped = state.controllers.judge(changes, status, model);
        // The bus stops the group. Each motor is stopped too, because no setpoints follow.
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
