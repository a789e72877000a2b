//! Frames that were sent: what they show that the bus does with a motor.

use motorlink_protocol::{
    Acceleration, Drive, Frame, Instant, Mode, MotorId, Setpoint, family::Request,
};

use super::Observer;
use crate::{
    event::StopReason,
    exchange::{Expects, Purpose},
    mode_switch::Switch,
    model::units::in_bus_units,
    motor::{Control, Driven, Motor},
    next_request::Sent,
    pending_transmit::{Effect, PendingTransmit},
    schedule::DueFrame,
    stop::{ActiveStop, Stopping},
    timing::STOP_PERIOD,
};

/// No effect beside the exchange itself.
const NONE: Effect = Effect::Job(DueFrame::IdQuery);

/// A stop is known to have begun after at most so many brake frames: the page notices it within a tenth of a second.
const BRAKES_MAX: usize = 20;

impl Observer {
    /// A stop has begun. The event may come a few frames after the first stop frame.
    pub fn stop_began(&mut self, at: Instant) {
        self.advance(at);
        self.bus
            .stop
            .get_or_insert(ActiveStop::new(StopReason::Operator));
        let stopped = self
            .bus
            .motors
            .iter()
            .filter(|motor| is_stopped_now(&motor.control));
        let stopped: Vec<MotorId> = stopped.map(|motor| motor.id).collect();
        for id in stopped {
            self.stops(at, id);
        }
    }

    /// The motor is being stopped from now on. Its last brake frames were not commands.
    fn stops(&mut self, at: Instant, id: MotorId) {
        let heard = self.heard.iter_mut().find(|heard| heard.id == id);
        if let (Some(motor), Some(heard)) = (self.bus.motor_mut(id), heard) {
            let switched = match motor.control {
                Control::Switching(switch) => switch.began,
                _ => at,
            };
            let braked = heard.brakes.first().copied().unwrap_or(at);
            begin_stop(motor, switched.min(braked));
            for sent in heard.brakes.drain(..) {
                motor.drive_frames.take_back(sent);
            }
        }
    }

    /// The stop has ended.
    pub fn stop_ended(&mut self, at: Instant) {
        self.advance(at);
        self.bus.stop = None;
        for motor in &mut self.bus.motors {
            if let Control::Stopping(_) = motor.control {
                motor.control = Control::Idle;
            }
        }
    }

    pub(super) fn sent(&mut self, at: Instant, frame: Frame, mode: Option<Mode>) {
        self.exchange_ended(at);
        self.has_requests = true;
        let pending = self.pending(at, frame, mode);
        self.bus.pending_transmit = Some(pending);
        self.bus.commit_transmit();
        self.forget_those_not_asked(at);
    }

    pub(super) fn not_sent(&mut self, at: Instant, frame: Frame) {
        self.exchange_ended(at);
        let expects = Expects::Nothing;
        let (mode, effect, purpose) = (None, NONE, Purpose::Control);
        self.bus.pending_transmit = Some(PendingTransmit {
            at,
            frame,
            expects,
            purpose,
            mode,
            effect,
        });
        // A sequence of refused frames has no other effect here: the bus is never polled.
        self.bus.refused_in_a_row = 0;
        self.bus.transmit_failed();
        self.bus.job_retry = None;
    }

    /// What a recording knows of a motor whose requests it does not have.
    pub(super) fn known(&mut self, at: Instant, id: MotorId, mode: Mode, value: Option<[u8; 2]>) {
        self.hear(at, id);
        let model = self.bus.model;
        if let Some(motor) = self
            .bus
            .motor_mut(id)
            .filter(|_| model.has_separate_frames())
            && motor.separate.loop_known.last() != Some(mode)
        {
            motor.separate.loop_known.reported(at, mode);
        }
        let Some(value) = value else { return };
        let drive = Drive {
            value,
            acceleration: Acceleration::DEFAULT,
            brake: 0,
        };
        self.hear(at, id).drove = at;
        let drive = in_bus_units(model, drive, mode);
        let (control, _) = self.driven(at, id, drive, Some(mode));
        if let Some(motor) = self.bus.motor_mut(id) {
            motor.control = control;
        }
    }

    /// A motor with separate frames that has not named its loop since the records begin is in this one.
    fn reads_in(&mut self, at: Instant, id: MotorId, mode: Mode) {
        let separate = self.bus.model.has_separate_frames();
        if let Some(motor) = self.bus.motor_mut(id).filter(|_| separate)
            && motor.separate.loop_known.last().is_none()
        {
            motor.separate.loop_known.reported(at, mode);
        }
    }

    fn pending(&mut self, at: Instant, frame: Frame, mode: Option<Mode>) -> PendingTransmit {
        let model = self.bus.model;
        let request = Request::parse(model, &frame);
        let addressee = request.ok().and_then(|request| request.addressee());
        let (expects, purpose) = match request {
            Ok(request) => (Expects::of(model, request), Purpose::Control),
            Err(_) => (Expects::of_raw(model, &frame), Purpose::Raw),
        };
        let mut pending = PendingTransmit {
            at,
            frame,
            expects,
            purpose,
            mode,
            effect: NONE,
        };
        let Some(id) = addressee else {
            return pending;
        };
        let (control, sent) = match request {
            Ok(Request::Drive { drive, .. }) => {
                self.hear(at, id).drove = at;
                let drive = mode.map_or(drive, |mode| {
                    self.reads_in(at, id, mode);
                    in_bus_units(model, drive, mode)
                });
                let (control, sent) = self.driven(at, id, drive, mode);
                let brakes = &mut self.hear(at, id).brakes;
                if !drive.brakes() || !matches!(sent, Sent::Drive(_)) {
                    brakes.clear();
                } else if brakes.len() < BRAKES_MAX {
                    brakes.push(at);
                }
                (control, sent)
            }
            Ok(Request::SwitchMode { mode, .. }) => {
                let goes_on = std::mem::take(&mut self.hear(at, id).is_enabled);
                self.switched(at, id, mode, goes_on)
            }
            Ok(Request::Enable { on: true, .. }) => {
                // The bus enables no motor while it stops: the end of the stop is only noticed later.
                if self.bus.stop.is_some() {
                    self.stop_ended(at);
                }
                self.hear(at, id).is_enabled = true;
                let (control, _) = self.switched(at, id, Mode::Velocity, false);
                if let Some(motor) = self.bus.motor_mut(id) {
                    motor.control = control;
                }
                return pending;
            }
            _ => {
                // A query of an unknown motor may be the probe of a scan. Its answer shows whether there is a motor.
                if self.knows(id) {
                    self.hear(at, id);
                } else {
                    pending.purpose = Purpose::Job;
                }
                return pending;
            }
        };
        pending.effect = Effect::Motor { id, control, sent };
        pending
    }

    /// What a drive frame in units of the bus shows.
    fn driven(
        &mut self,
        at: Instant,
        id: MotorId,
        drive: Drive,
        mode: Option<Mode>,
    ) -> (Control, Sent) {
        let is_stop = self.bus.stop.is_some();
        let model = self.bus.model;
        let goal = mode.map(|mode| drive.setpoint(mode));
        let motor = self.bus.motors.iter().find(|motor| motor.id == id);
        let switches = motor.is_some_and(|motor| matches!(motor.control, Control::Switching(_)));
        // The neutral frames of a switch do not brake.
        if goal == Some(Setpoint::Brake) && (is_stop || switches) {
            self.stops(at, id);
        }
        let Some(motor) = self.bus.motor_mut(id) else {
            return (Control::Idle, Sent::Drive(None));
        };
        match (motor.control, goal) {
            (Control::Stopping(mut stop), Some(Setpoint::Brake)) => {
                stop.sent(at, model, Request::Drive { id, drive }, STOP_PERIOD, true);
                (Control::Stopping(stop), Sent::Stop)
            }
            // The neutral frame of a switch.
            (switching @ Control::Switching(_), _) if drive.signed() == 0 => {
                (switching, Sent::Drive(None))
            }
            (Control::Driven(driven), Some(goal)) => {
                let control = Control::Driven(Driven { goal, ..driven });
                (control, Sent::Drive(Some(goal)))
            }
            (_, Some(goal)) => {
                let speed = motor.fresh_speed(at);
                let driven = Driven::begin(at, goal, speed);
                (Control::Driven(driven), Sent::Drive(Some(goal)))
            }
            // Without its loop, the value has no unit.
            (control, None) => (control, Sent::Drive(None)),
        }
    }

    /// What a mode switch shows. `goes_on` if the frame before it enabled the motor for it.
    fn switched(&mut self, at: Instant, id: MotorId, to: Mode, goes_on: bool) -> (Control, Sent) {
        let is_stop = self.bus.stop.is_some() && to == Mode::Velocity;
        let model = self.bus.model;
        if is_stop {
            self.stops(at, id);
        }
        let Some(motor) = self.bus.motor_mut(id) else {
            return (Control::Idle, Sent::Stop);
        };
        let begin = |driven_in| Switch::begin(at, to, driven_in);
        let mut switch = match motor.control {
            Control::Stopping(mut stop) if to == Mode::Velocity => {
                let request = Request::SwitchMode { id, mode: to };
                stop.sent(at, model, request, STOP_PERIOD, true);
                return (Control::Stopping(stop), Sent::Stop);
            }
            Control::Switching(switch)
                if (switch.to == to || goes_on) && switch.next_frame().is_some() =>
            {
                let mut goes_on = switch;
                goes_on.to = to;
                goes_on
            }
            Control::Driven(driven) => begin(Some(driven.goal.mode())),
            Control::Switching(_) | Control::Idle | Control::Stopping(_) => begin(None),
        };
        switch.frame_sent(at);
        let is_last = switch.next_frame().is_none();
        (Control::Switching(switch), Sent::Switch { to, is_last })
    }
}

/// The motor is being stopped from now on, if it is not already.
fn begin_stop(motor: &mut Motor, at: Instant) {
    if !matches!(motor.control, Control::Stopping(_)) {
        let (fresh, last) = motor.known_loop(at);
        motor.stops(Stopping::begin(at, fresh, last));
    }
}

/// Whether what a motor does belongs to a stop that has just begun: it is braked, or switched to the loop that can
/// brake.
const fn is_stopped_now(control: &Control) -> bool {
    match control {
        Control::Driven(driven) => matches!(driven.goal, Setpoint::Brake),
        Control::Switching(switch) => matches!(switch.to, Mode::Velocity),
        Control::Idle | Control::Stopping(_) => false,
    }
}
