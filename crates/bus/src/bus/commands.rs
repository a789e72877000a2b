//! What operators ask for.

use motorlink_protocol::{Instant, Mode, MotorId, Setpoint};

use super::Bus;
use crate::{
    Command, CommandRate, Consent, Event, Refusal, StopReason,
    exchange::Line,
    mode_switch::Switch,
    motor::{Control, Driven, Motor},
    safety::{Known, check_drive, check_position_switch},
    stop::{ActiveStop, Stopping},
    timing::STOP_PATIENCE,
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
        if self.watchdog.has_bitten() && (command.may_move() || command.releases()) {
            // It may have been given long ago, to a page that has only now come to send it.
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
            Command::CancelSurvey => self.cancel_survey(now),
            Command::SendRaw {
                frame,
                repeat,
                consent,
            } => self.send_raw(now, frame, repeat, consent)?,
            Command::StopRaw => self.stop_raw(now),
            Command::SetRate(rate) => self.set_rate(now, rate),
            Command::SetRamp(ramp) => self.ramp = ramp,
            Command::SetLimits(limits) => self.limits = limits,
            Command::DriveTogether { parts, consent } => {
                self.drive_together(now, &parts, consent)?;
            }
            Command::AdjustTogether { parts, consent } => {
                self.adjust_together(now, &parts, consent)?;
            }
            Command::SwitchMode { id, mode } => self.switch_mode(now, id, mode)?,
            Command::Drive {
                id,
                setpoint,
                consent,
            } => {
                if !self.rests_with_its_group(now, id, setpoint) {
                    self.check_alone(id)?;
                    self.drive(now, id, setpoint, consent)?;
                }
            }
            Command::Adjust {
                id,
                setpoint,
                consent,
            } => {
                if !self.rests_with_its_group(now, id, setpoint) {
                    self.check_alone(id)?;
                    self.adjust(now, id, setpoint, consent)?;
                }
            }
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
        match self.motor_mut(id) {
            // One that never answered is perhaps not there.
            Some(motor) if motor.may_turn && motor.ever_heard() => Err(Refusal::Driven(id)),
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

    fn switch_mode(&mut self, now: Instant, id: MotorId, mode: Mode) -> Result<(), Refusal> {
        self.check_not_halted()?;
        self.check_no_survey()?;
        self.check_no_raw_hazard()?;
        self.check_alone(id)?;
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

    pub(super) fn drive(
        &mut self,
        now: Instant,
        id: MotorId,
        setpoint: Setpoint,
        consent: Consent,
    ) -> Result<(), Refusal> {
        self.check_not_halted()?;
        self.check_no_survey()?;
        self.check_no_raw_hazard()?;
        let limits = self.limits;
        let motor = self.watch(now, id);
        let known = motor.known(now);
        let speed = motor.fresh_speed(now);
        match &mut motor.control {
            Control::Stopping(_) => return Err(Refusal::Stopping(id)),
            Control::Switching(switch) => {
                let reported = Some(switch.to);
                check_drive(id, setpoint, consent, limits, Known { reported, ..known })?;
                switch.then = Some(setpoint);
            }
            Control::Driven(driven) => {
                // Whatever is known of its loop, values of that loop are sent already: rest is no worse.
                let comes_to_rest = rests(setpoint) && setpoint.mode() == driven.goal.mode();
                if !comes_to_rest {
                    check_drive(id, setpoint, consent, limits, known)?;
                }
                // An operator's act shows at once, at any rate.
                *driven = Driven {
                    goal: setpoint,
                    hold: None,
                    next_frame: now,
                    ..*driven
                };
                if rests(setpoint) {
                    self.cut_exchange_short(now);
                }
            }
            Control::Idle => {
                check_drive(id, setpoint, consent, limits, known)?;
                motor.control = Control::Driven(Driven::begin(now, setpoint, speed));
                motor.may_turn = true;
            }
        }
        Ok(())
    }

    pub(super) fn adjust(
        &mut self,
        now: Instant,
        id: MotorId,
        setpoint: Setpoint,
        consent: Consent,
    ) -> Result<(), Refusal> {
        match self.motor_mut(id).map(|motor| motor.control) {
            Some(Control::Driven(driven)) if driven.goal.mode() == setpoint.mode() => {
                self.drive(now, id, setpoint, consent)?;
                // Dragging keeps to the rate, unless it comes to rest.
                if let Some(Motor {
                    control: Control::Driven(adjusted),
                    ..
                }) = self.motor_mut(id)
                    && !rests(setpoint)
                {
                    adjusted.next_frame = driven.next_frame;
                }
                Ok(())
            }
            _ => Err(Refusal::NotDriven(id)),
        }
    }

    fn hold(&mut self, now: Instant, id: MotorId) -> Result<(), Refusal> {
        let motor = self.motor_mut(id).ok_or(Refusal::NotHolding(id))?;
        let Control::Driven(driven) = &mut motor.control else {
            return Err(Refusal::NotHolding(id));
        };
        if driven.goal.mode() != Mode::Position {
            return Err(Refusal::NotHolding(id));
        }
        if driven.group.is_some() {
            self.begin_stop(now, StopReason::OneMotor, |motor| motor.id == id);
            return Ok(());
        }
        let Some((hold, angle)) = motor.reckoning.hold(now) else {
            self.begin_stop(now, StopReason::OneMotor, |motor| motor.id == id);
            return Ok(());
        };
        // At once where the wheel should be by its speed; the next reply says it better.
        *driven = Driven {
            goal: Setpoint::Position(angle),
            hold: Some(hold),
            next_frame: now,
            ..*driven
        };
        self.cut_exchange_short(now);
        Ok(())
    }

    fn set_rate(&mut self, now: Instant, rate: CommandRate) {
        self.rate = rate;
        for motor in &mut self.motors {
            if let Control::Driven(driven) = &mut motor.control {
                driven.next_frame = driven.next_frame.min(now + rate.period());
            }
        }
    }

    pub(super) const fn check_not_halted(&self) -> Result<(), Refusal> {
        if self.halted {
            Err(Refusal::Halted)
        } else {
            Ok(())
        }
    }

    /// Stops whatever was driven or turns, and drives nothing until released.
    pub(super) fn stop_all(&mut self, now: Instant, reason: StopReason) {
        self.halted = true;
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
        if reason != StopReason::Survey {
            self.cancel_survey(now);
        }
        // Whatever a person repeats, it must not take the line from a stop.
        if let Some(raw) = &mut self.raw {
            raw.stop();
        }
        // None of a group goes on without the others.
        let mut ids: Vec<MotorId> = self
            .motors
            .iter()
            .filter(|motor| concerns(motor))
            .map(|motor| motor.id)
            .collect();
        self.add_companions(&mut ids);
        if self.stop.is_none() {
            self.silent_stop_round = 0;
            self.silent_firsts = 0;
        }
        let round = self.stop_round().unwrap_or(0);
        for motor in self
            .motors
            .iter_mut()
            .filter(|motor| ids.contains(&motor.id))
        {
            if let Control::Stopping(stop) = &mut motor.control {
                stop.asked_again(now);
                continue;
            }
            let (fresh, last) = motor.known_loop(now);
            motor.stops(Stopping::begin(now, fresh, last, round));
        }
        match &mut self.stop {
            Some(stop) => stop.join(reason),
            None => self.stop = Some(ActiveStop::new(reason)),
        }
        self.events.push_back(Event::StopBegan(reason));
        self.cut_exchange_short(now);
    }

    /// The frames of their stop that all motors which answer have got; `None` where none is stopped.
    pub(super) fn stop_round(&self) -> Option<u32> {
        let rounds = self.motors.iter().filter_map(|motor| match &motor.control {
            Control::Stopping(stop) if !motor.is_without_answer() => Some(stop.round),
            _ => None,
        });
        rounds.min()
    }

    /// A stop waits for the exchange in flight, but not for a motor that does not answer.
    fn cut_exchange_short(&mut self, now: Instant) {
        if let Line::Busy(exchange) = &mut self.line {
            let patience = (exchange.sent + STOP_PATIENCE).max(now);
            exchange.window_ends = exchange.window_ends.min(patience);
        }
    }
}

/// Whether a setpoint is what a person calls stopping: it does not wait for the next period.
pub(super) fn rests(setpoint: Setpoint) -> bool {
    match setpoint {
        Setpoint::Velocity { speed, .. } => speed.rpm() == 0,
        Setpoint::Current(current) => current.raw() == 0,
        Setpoint::Brake => true,
        Setpoint::Position(_) => false,
    }
}
