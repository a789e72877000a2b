//! The present state of the bus and its motors, for the caller.

use motorlink_protocol::{Instant, family::Model};

use crate::{
    bus::Bus,
    motor::{Control, Motor},
    motor_status::{Activity, MotorStatus},
};

impl Bus {
    /// The model of all motors on the line.
    #[must_use]
    pub const fn model(&self) -> Model {
        self.model
    }

    /// Whether a motor has answered as this model.
    #[must_use]
    pub const fn model_known(&self) -> bool {
        self.evidence.own
    }

    /// The other model that the last frame of another model shows. A single frame may be noise.
    #[must_use]
    pub const fn likely_model(&self) -> Option<Model> {
        self.evidence.likely()
    }

    /// Whether Stop all motors is in force.
    #[must_use]
    pub const fn is_halted(&self) -> bool {
        self.halted
    }

    /// Whether a motor is driven, switched or being stopped, or still turns after the bus has driven it. While
    /// this is so, the caller must keep the port open.
    #[must_use]
    pub fn is_active(&self, now: Instant) -> bool {
        let turns = |motor: &Motor| {
            let speed = motor.fresh_speed(now);
            motor.may_turn() && speed.is_some_and(|speed| speed.magnitude() > 0)
        };
        let active = |motor: &Motor| !matches!(motor.control, Control::Idle) || turns(motor);
        self.motors.iter().any(active) || self.raw.is_some_and(|raw| raw.is_hazard_running())
    }

    /// Whether the motors must be stopped before the port is closed: one is active, or no reply has confirmed that it
    /// stands since it was driven.
    #[must_use]
    pub fn needs_stop(&self, now: Instant) -> bool {
        self.is_active(now) || self.left_driven().next().is_some()
    }

    /// Whether a motor is being stopped.
    #[must_use]
    pub fn is_stopping(&self) -> bool {
        let stops = |motor: &Motor| matches!(motor.control, Control::Stopping(_));
        self.motors.iter().any(stops)
    }

    /// Status of every watched motor.
    pub fn motors(&self, now: Instant) -> impl Iterator<Item = MotorStatus> {
        self.motors.iter().map(move |motor| {
            let mut status = motor.status(now);
            status.activity = self.activity(motor);
            status.waiting = status.waiting.or(self.waiting_in_group(motor.id));
            status
        })
    }

    fn activity(&self, motor: &Motor) -> Activity {
        match motor.activity() {
            Activity::Idle if self.is_driven_raw(motor.id) => Activity::DrivenRaw,
            activity => activity,
        }
    }
}
