//! What the bus refuses in the state that it reports, so that a control can say why before it is used.

use motorlink_protocol::{Instant, Mode, MotorId, Rpm, family::Model};

use crate::{
    command::Refusal,
    motor_status::{Activity, MotorStatus},
    safety::{check_faults, check_loop, check_position_switch},
    timing::FRESH_FOR,
};

/// The state of a line. The bus knows more: what a motor of a group, a limit or an ID query forbids, only it refuses.
#[derive(Clone, Copy, Debug)]
pub struct ReportedState<'a> {
    /// The time for which ages are computed.
    pub now: Instant,
    /// The model of the line.
    pub model: Model,
    /// See [`Bus::is_halted`](crate::Bus::is_halted).
    pub halted: bool,
    /// Whether there is a [`Bus::job`](crate::Bus::job).
    pub has_job: bool,
    /// See [`Bus::motors`](crate::Bus::motors).
    pub motors: &'a [MotorStatus],
}

impl ReportedState<'_> {
    /// Whether anything can be driven.
    ///
    /// # Errors
    /// Stop all motors is in force, or a job or a raw frame runs.
    pub fn check_motion(&self) -> Result<(), Refusal> {
        if self.halted {
            return Err(Refusal::Halted);
        }
        self.check_scan()?;
        let mut activities = self.motors.iter().map(|motor| motor.activity);
        if activities.any(|activity| activity == Activity::DrivenRaw) {
            return Err(Refusal::RawRunning);
        }
        Ok(())
    }

    /// Whether a motor can be driven in this loop. One that switches to it is driven when it has switched.
    ///
    /// # Errors
    /// What [`Command::Drive`](crate::Command::Drive) is refused for.
    pub fn check_drive(&self, id: MotorId, mode: Mode) -> Result<(), Refusal> {
        self.check_motion()?;
        let motor = self.motor(id)?;
        let fresh = motor.last.filter(|last| self.is_fresh(last.at));
        let fresh = fresh.map(|last| last.reply);
        let reported = match motor.activity {
            Activity::Stopping { .. } => return Err(Refusal::Stopping(id)),
            Activity::Switching { to } => Some(to),
            Activity::Driven { setpoint } => fresh.map(|it| it.mode).or(Some(setpoint.mode())),
            Activity::Idle | Activity::DrivenRaw => fresh.map(|it| it.mode),
        };
        self.check_model(mode)?;
        check_faults(id, fresh.map(|it| it.faults))?;
        check_loop(id, mode, reported)
    }

    /// Whether a motor of a group can be driven in this loop.
    ///
    /// # Errors
    /// What [`Command::DriveGroup`](crate::Command::DriveGroup) is refused for.
    pub fn check_member(&self, id: MotorId, mode: Mode) -> Result<(), Refusal> {
        let checked = self.check_drive(id, mode);
        let switches = |motor: &MotorStatus| matches!(motor.activity, Activity::Switching { .. });
        match self.motor(id) {
            // All motors of a group start at once.
            Ok(motor) if switches(motor) => self.check_motion().and(Err(Refusal::Switching(id))),
            _ => checked,
        }
    }

    /// Whether a motor can be switched to this loop.
    ///
    /// # Errors
    /// What [`Command::SwitchMode`](crate::Command::SwitchMode) is refused for.
    pub fn check_switch(&self, id: MotorId, mode: Mode) -> Result<(), Refusal> {
        self.check_motion()?;
        self.check_model(mode)?;
        let motor = self.motor(id)?;
        if mode == Mode::Position {
            check_position_switch(id, self.fresh_speed(motor))?;
        }
        match motor.activity {
            Activity::Stopping { .. } => Err(Refusal::Stopping(id)),
            _ => Ok(()),
        }
    }

    /// Whether a scan can start. It stops driven motors first.
    ///
    /// # Errors
    /// What [`Command::FullScan`](crate::Command::FullScan) is refused for.
    pub const fn check_scan(&self) -> Result<(), Refusal> {
        if self.has_job {
            Err(Refusal::JobRunning)
        } else {
            Ok(())
        }
    }

    /// Whether a raw frame can be sent. While all motors are stopped, only one that moves nothing can be.
    ///
    /// # Errors
    /// What [`Command::SendRaw`](crate::Command::SendRaw) is refused for, of any bytes, while no other raw frame runs.
    pub fn check_raw(&self, is_hazardous: bool) -> Result<(), Refusal> {
        self.check_scan()?;
        if is_hazardous && self.halted {
            return Err(Refusal::Halted);
        }
        Ok(())
    }

    fn check_model(&self, mode: Mode) -> Result<(), Refusal> {
        let model = self.model;
        if model.has(mode) {
            Ok(())
        } else {
            Err(Refusal::NoSuchLoop { model, mode })
        }
    }

    fn motor(&self, id: MotorId) -> Result<&MotorStatus, Refusal> {
        let mut motors = self.motors.iter();
        let motor = motors.find(|motor| motor.id == id);
        motor.ok_or(Refusal::NotAnswering(id))
    }

    fn fresh_speed(&self, motor: &MotorStatus) -> Option<Rpm> {
        let (_, speed) = motor.speed.filter(|(at, _)| self.is_fresh(*at))?;
        Some(speed)
    }

    fn is_fresh(&self, at: Instant) -> bool {
        self.now.since(at) <= FRESH_FOR
    }
}
