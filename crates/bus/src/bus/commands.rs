//! What operators ask for.

use motorlink_protocol::{Instant, Mode, MotorId, PositionTarget, Setpoint};

use super::Bus;
use crate::{
    Command, Consent, Event, Refusal, StopReason,
    exchange::Line,
    mode_switch::Switch,
    motor::{Control, Driven, Motor},
    safety::{check_drive, check_position_switch},
    stop::{ActiveStop, Stopping},
    timing::STOP_PATIENCE,
};

impl Bus {
    /// Carries out an operator's command.
    ///
    /// # Errors
    /// The [`Refusal`] says why; nothing has changed then.
    pub fn command(&mut self, now: Instant, command: Command) -> Result<(), Refusal> {
        // Whoever commands is alive.
        self.watchdog.answered(now);
        match command {
            Command::Watch(id) => {
                self.watch(now, id);
            }
            Command::Forget(id) => self.forget(id)?,
            Command::IdQuery => {
                let active = self
                    .motors
                    .iter()
                    .find(|motor| !matches!(motor.control, Control::Idle));
                active.map_or(Ok(()), |motor| Err(Refusal::Driven(motor.id)))?;
                self.id_query_wanted = true;
            }
            Command::SetRate(rate) => self.rate = rate,
            Command::SwitchMode { id, mode } => self.switch_mode(now, id, mode)?,
            Command::Drive {
                id,
                setpoint,
                consent,
            } => self.drive(now, id, setpoint, consent)?,
            Command::Adjust {
                id,
                setpoint,
                consent,
            } => self.adjust(now, id, setpoint, consent)?,
            Command::Hold(id) => self.hold(now, id)?,
            Command::Stop(id) => {
                self.watch(now, id);
                self.begin_stop(now, StopReason::OneMotor, |motor| motor.id == id);
            }
            Command::StopAll(reason) => self.stop_all(now, reason),
            Command::Release => self.halted = false,
        }
        Ok(())
    }

    fn forget(&mut self, id: MotorId) -> Result<(), Refusal> {
        match self.motor_mut(id).map(|motor| &motor.control) {
            Some(Control::Idle) => {
                self.motors.retain(|motor| motor.id != id);
                Ok(())
            }
            Some(_) => Err(Refusal::Driven(id)),
            None => Ok(()),
        }
    }

    fn switch_mode(&mut self, now: Instant, id: MotorId, mode: Mode) -> Result<(), Refusal> {
        self.check_not_halted()?;
        let motor = self.watch(now, id);
        if mode == Mode::Position {
            check_position_switch(id, motor.fresh_speed(now))?;
        }
        let driven_in = match motor.control {
            Control::Stopping(_) => return Err(Refusal::Stopping(id)),
            Control::Driven(driven) => Some(driven.goal.mode()),
            // Which loop the motor is in is in the air, so nothing may be sent that one could
            // misread: as if it were held at an angle.
            Control::Switching(switch) => switch.was_driven.then_some(Mode::Position),
            Control::Idle => None,
        };
        motor.control = Control::Switching(Switch::begin(now, mode, driven_in));
        Ok(())
    }

    fn drive(
        &mut self,
        now: Instant,
        id: MotorId,
        setpoint: Setpoint,
        consent: Consent,
    ) -> Result<(), Refusal> {
        self.check_not_halted()?;
        let motor = self.watch(now, id);
        let (mode, faults) = (motor.fresh_mode(now), motor.fresh_faults(now));
        match &mut motor.control {
            Control::Stopping(_) => return Err(Refusal::Stopping(id)),
            Control::Switching(switch) => {
                check_drive(id, setpoint, consent, Some(switch.to), faults)?;
                switch.then = Some(setpoint);
            }
            Control::Driven(driven) => {
                check_drive(id, setpoint, consent, mode, faults)?;
                driven.goal = setpoint;
            }
            Control::Idle => {
                check_drive(id, setpoint, consent, mode, faults)?;
                motor.control = Control::Driven(Driven::begin(now, setpoint));
                motor.may_turn = true;
            }
        }
        Ok(())
    }

    fn adjust(
        &mut self,
        now: Instant,
        id: MotorId,
        setpoint: Setpoint,
        consent: Consent,
    ) -> Result<(), Refusal> {
        match self.motor_mut(id).map(|motor| motor.control) {
            Some(Control::Driven(driven)) if driven.goal.mode() == setpoint.mode() => {
                self.drive(now, id, setpoint, consent)
            }
            _ => Err(Refusal::NotDriven(id)),
        }
    }

    fn hold(&mut self, now: Instant, id: MotorId) -> Result<(), Refusal> {
        let motor = self.motor_mut(id).ok_or(Refusal::NotHolding(id))?;
        let present = motor.fresh_position(now);
        match (&mut motor.control, present) {
            (
                Control::Driven(Driven {
                    goal: goal @ Setpoint::Position(_),
                    ..
                }),
                Some(present),
            ) => {
                *goal = Setpoint::Position(PositionTarget::from(present));
            }
            // Where it stands is not known, so it cannot be held there.
            (
                Control::Driven(Driven {
                    goal: Setpoint::Position(_),
                    ..
                }),
                None,
            ) => {
                self.begin_stop(now, StopReason::OneMotor, |motor| motor.id == id);
            }
            _ => return Err(Refusal::NotHolding(id)),
        }
        Ok(())
    }

    const fn check_not_halted(&self) -> Result<(), Refusal> {
        if self.halted {
            Err(Refusal::Halted)
        } else {
            Ok(())
        }
    }

    /// Stops whatever was driven or turns, and drives nothing until released.
    pub(super) fn stop_all(&mut self, now: Instant, reason: StopReason) {
        self.halted = true;
        self.id_query_wanted = false;
        self.begin_stop(now, reason, |motor| {
            let active = !matches!(motor.control, Control::Idle);
            // A wheel that reports no speed may turn; one that never answered is not there.
            let stands = motor
                .fresh_speed(now)
                .is_some_and(|speed| speed.magnitude() == 0);
            active || motor.may_turn || (motor.ever_heard() && !stands)
        });
    }

    /// Brings the chosen motors to a standstill, beginning with the next frame on the wire.
    pub(super) fn begin_stop(
        &mut self,
        now: Instant,
        reason: StopReason,
        concerns: impl Fn(&Motor) -> bool,
    ) {
        for motor in self.motors.iter_mut().filter(|motor| concerns(motor)) {
            if !matches!(motor.control, Control::Stopping(_)) {
                let (fresh, last) = known_loop(motor, now);
                motor.control = Control::Stopping(Stopping::begin(now, fresh, last));
                motor.may_turn = true;
            }
        }
        match &mut self.stop {
            Some(stop) => stop.join(reason),
            None => self.stop = Some(ActiveStop::new(reason)),
        }
        self.events.push_back(Event::StopBegan(reason));
        if let Line::Busy(exchange) = &mut self.line {
            let patience = (exchange.sent + STOP_PATIENCE).max(now);
            exchange.window_ends = exchange.window_ends.min(patience);
        }
    }
}

/// The loop of a motor by a fresh reply, and by older knowledge. While it is being changed nothing
/// is fresh, and the position loop, where zero moves the wheel, is assumed where it is possible.
fn known_loop(motor: &Motor, now: Instant) -> (Option<Mode>, Option<Mode>) {
    match motor.control {
        Control::Switching(switch) if switch.to == Mode::Position => (None, Some(Mode::Position)),
        Control::Switching(_) => (None, motor.last_mode()),
        _ => (motor.fresh_mode(now), motor.last_mode()),
    }
}
