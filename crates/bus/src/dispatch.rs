//! Checks operator commands and passes each to the part that carries it out.

use motorlink_protocol::{Instant, MotorId};

use crate::{
    bus::Bus,
    command::Command,
    event::StopReason,
    motor::{Control, Motor},
    refusal::Refusal,
    start::Start,
};

impl Bus {
    /// Carries out an operator's command.
    ///
    /// # Errors
    /// The [`Refusal`] says why; nothing has changed then.
    pub fn command(&mut self, now: Instant, command: Command) -> Result<(), Refusal> {
        let was_halted = self.halted;
        self.begin_call(now);
        if command.releases() && self.halted && !was_halted {
            // It was given before the gap that has just stopped the motors.
            return Err(Refusal::Halted);
        }
        if self.watchdog.has_expired() && (command.may_move() || command.releases()) {
            // The page hung. The operator may have given the command long ago.
            return Err(Refusal::PageSilent);
        }
        match command {
            Command::Watch(id) => {
                self.watch(now, id);
            }
            Command::Forget(id) => self.forget(id)?,
            Command::IdQuery => self.begin_id_query(now)?,
            Command::FullScan => self.begin_scan(now)?,
            Command::SetId { from, to, frames } => self.begin_id_change(now, from, to, frames)?,
            Command::CancelJob => self.cancel_job(now),
            Command::SendRaw {
                frame,
                repeat,
                consent,
            } => self.send_raw(now, frame, repeat, consent)?,
            Command::StopRaw => self.stop_raw(now),
            Command::Configure(settings) => self.configure(now, settings),
            Command::StartGroup { setpoints, consent } => {
                let started = self.start_group(now, &setpoints, consent);
                self.or_end_wait(started, &setpoints)?;
            }
            Command::DriveGroup { setpoints, consent } => {
                let driven = self.drive_group(now, &setpoints, consent);
                self.or_end_wait(driven, &setpoints)?;
            }
            Command::AdjustGroup { setpoints, consent } => {
                self.adjust_group(now, &setpoints, consent)?;
            }
            Command::SwitchMode { id, mode } => self.switch_mode(now, id, mode)?,
            Command::Start {
                id,
                setpoint,
                consent,
            } => {
                self.check_not_in_group(id)?;
                self.drive_in(now, id, Start { setpoint, consent }, true)?;
            }
            Command::Drive {
                id,
                setpoint,
                consent,
            } => {
                if !self.stops_group(now, id, setpoint) {
                    self.check_not_in_group(id)?;
                    self.drive(now, id, setpoint, consent)?;
                }
            }
            Command::Adjust {
                id,
                setpoint,
                consent,
            } => {
                if !self.stops_group(now, id, setpoint) {
                    self.check_not_in_group(id)?;
                    self.adjust(now, id, setpoint, consent)?;
                }
            }
            Command::Hold(id) => self.hold(now, id)?,
            Command::Stop(id) => {
                self.watch(now, id);
                self.begin_stop(now, StopReason::OneMotor, &|motor| motor.id == id);
            }
            Command::StopAll(reason) => self.stop_all(now, reason),
            Command::Release => self.release(now),
        }
        Ok(())
    }

    fn forget(&mut self, id: MotorId) -> Result<(), Refusal> {
        match self.motor_mut(id) {
            // A motor that never answered may not exist.
            Some(motor) if motor.may_turn() && motor.has_answered() => Err(Refusal::Driven(id)),
            Some(Motor {
                control: Control::Idle,
                ..
            }) => {
                self.motors.retain(|motor| motor.id != id);
                Ok(())
            }
            Some(_) => Err(Refusal::Driven(id)),
            None => Ok(()),
        }
    }
}
