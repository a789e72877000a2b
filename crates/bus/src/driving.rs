//! Drive, adjust, hold and mode switch of one motor.

use motorlink_protocol::{Instant, Mode, MotorId, Setpoint};

use crate::{
    bus::Bus,
    command::Consent,
    event::{Event, StopReason, WithdrawReason},
    mode_switch::Switch,
    motor::{Control, Driven, Motor},
    refusal::Refusal,
    safety::{Known, check_drive, check_position_switch},
    settings::BusSettings,
    start::Start,
};

impl Bus {
    pub(crate) fn switch_mode(
        &mut self,
        now: Instant,
        id: MotorId,
        mode: Mode,
    ) -> Result<(), Refusal> {
        self.check_not_halted()?;
        self.check_no_job()?;
        self.check_no_raw_hazard()?;
        self.check_not_in_group(id)?;
        let model = self.model;
        if !model.has(mode) {
            return Err(Refusal::NoSuchLoop { model, mode });
        }
        let motor = self.watch(now, id);
        if mode == Mode::Position {
            check_position_switch(id, motor.fresh_speed(now))?;
        }
        let driven_in = match motor.control {
            Control::Stopping(_) => return Err(Refusal::Stopping(id)),
            Control::Driven(driven) => Some(driven.goal.mode()),
            // The motor's loop is unconfirmed during a switch. The position loop is the safe
            // assumption: no drive frame is sent between it and another loop.
            Control::Switching(switch) => switch.was_driven.then_some(Mode::Position),
            Control::Idle => None,
        };
        motor.control = Control::Switching(Switch::begin(now, mode, driven_in));
        Ok(())
    }

    /// Drives a motor in the loop that it is in, or is being switched to.
    pub(crate) fn drive(
        &mut self,
        now: Instant,
        id: MotorId,
        setpoint: Setpoint,
        consent: Consent,
    ) -> Result<(), Refusal> {
        self.drive_in(now, id, Start { setpoint, consent }, false)
    }

    /// Drives a motor. If it `switches`, a motor in another loop is stopped and switched first.
    pub(crate) fn drive_in(
        &mut self,
        now: Instant,
        id: MotorId,
        start: Start,
        switches: bool,
    ) -> Result<(), Refusal> {
        self.check_not_halted()?;
        self.check_no_job()?;
        self.check_no_raw_hazard()?;
        let limits = self.settings.limits;
        let model = self.model;
        let Start { setpoint, consent } = start;
        let mode = setpoint.mode();
        let motor = self.watch(now, id);
        let is_next = motor.is_switching_to(mode);
        // Zero in the loop that the motor leaves is a stop: what waits for the next loop must not turn the wheel.
        if !switches && !is_next && is_rest(setpoint) && motor.will_drive() {
            self.begin_stop(now, StopReason::OneMotor, &|motor| motor.id == id);
            return Ok(());
        }
        let known = motor.known(now);
        let speed = motor.fresh_speed(now);
        let obeys = motor.obeys();
        let answers = known.reported.is_some() || speed.is_some();
        let reported = match motor.control {
            Control::Stopping(_) if !switches => return Err(Refusal::Stopping(id)),
            // It is not driven before it reports that loop.
            Control::Switching(switch) if !switches => Some(switch.to),
            _ if switches => answers.then_some(mode),
            _ => known.reported,
        };
        // The motor already gets values of this loop, so a zero makes nothing worse.
        let is_driven_so = matches!(motor.control, Control::Driven(it) if it.goal.mode() == mode);
        let comes_to_rest = is_rest(setpoint) && is_driven_so;
        if !comes_to_rest {
            let known = Known { reported, ..known };
            check_drive(model, id, setpoint, consent, limits, known)?;
        }
        let is_there = obeys && motor.fresh_mode(now) == Some(mode);
        match &mut motor.control {
            Control::Switching(switch) if is_next => switch.queued_setpoint = Some(setpoint),
            Control::Driven(driven) if driven.goal.mode() == mode => {
                // A command takes effect at once, at any command rate.
                driven.end_silence(now);
                *driven = Driven {
                    goal: setpoint,
                    hold: None,
                    next_frame: now,
                    is_new: true,
                    ..*driven
                };
                if is_rest(setpoint) {
                    self.cut_exchange_short(now);
                }
            }
            Control::Idle if is_there => {
                motor.control = Control::Driven(Driven::begin(now, setpoint, speed));
                motor.rest.doubt();
            }
            // The motor ignores drive frames until it is enabled and in this loop.
            Control::Idle if check_position_switch(id, speed).is_ok() => {
                let mut switch = Switch::begin(now, mode, None);
                switch.queued_setpoint = Some(setpoint);
                motor.control = Control::Switching(switch);
            }
            Control::Stopping(stop) => stop.then = Some(start),
            _ => {
                self.begin_stop(now, StopReason::OneMotor, &|motor| motor.id == id);
                if let Some(Motor {
                    control: Control::Stopping(stop),
                    ..
                }) = self.motor_mut(id)
                {
                    stop.then = Some(start);
                }
            }
        }
        Ok(())
    }

    pub(crate) fn adjust(
        &mut self,
        now: Instant,
        id: MotorId,
        setpoint: Setpoint,
        consent: Consent,
    ) -> Result<(), Refusal> {
        match self.motor_mut(id).map(|motor| motor.control) {
            Some(Control::Driven(driven)) if driven.goal.mode() == setpoint.mode() => {
                self.drive(now, id, setpoint, consent)?;
                // A dragged slider keeps the command rate. A zero is sent at once.
                if let Some(Motor {
                    control: Control::Driven(adjusted),
                    ..
                }) = self.motor_mut(id)
                    && !is_rest(setpoint)
                {
                    adjusted.next_frame = driven.next_frame;
                    adjusted.is_new = driven.is_new;
                }
                Ok(())
            }
            _ if self.waits_in(id, setpoint.mode()) => {
                self.drive_in(now, id, Start { setpoint, consent }, true)
            }
            _ => Err(Refusal::NotDriven(id)),
        }
    }

    pub(crate) fn hold(&mut self, now: Instant, id: MotorId) -> Result<(), Refusal> {
        let has_separate_frames = self.model.has_separate_frames();
        let waits = self.waiting_in_group(id).is_some();
        let motor = self.motor_mut(id).ok_or(Refusal::NotHolding(id))?;
        if waits || motor.will_drive() {
            self.begin_stop(now, StopReason::OneMotor, &|motor| motor.id == id);
            return Ok(());
        }
        let Control::Driven(driven) = &mut motor.control else {
            return Err(Refusal::NotHolding(id));
        };
        if driven.goal.mode() != Mode::Position {
            return Err(Refusal::NotHolding(id));
        }
        if driven.group.is_some() {
            self.begin_stop(now, StopReason::OneMotor, &|motor| motor.id == id);
            return Ok(());
        }
        // With separate frames an angle is asked for from where the loop was entered, and reported from
        // elsewhere.
        let estimate = motor
            .angle_estimate
            .hold(now)
            .filter(|_| !has_separate_frames);
        let Some((hold, angle)) = estimate else {
            if motor.angle_estimate.misfits() && !has_separate_frames {
                let reason = WithdrawReason::AngleMisfits;
                self.events.push_back(Event::Withdrawn { id, reason });
            }
            self.begin_stop(now, StopReason::OneMotor, &|motor| motor.id == id);
            return Ok(());
        };
        // The first frame holds the estimated angle. The next reply refines it.
        *driven = Driven {
            goal: Setpoint::Position(angle),
            hold: Some(hold),
            next_frame: now,
            is_new: true,
            ..*driven
        };
        self.cut_exchange_short(now);
        Ok(())
    }

    pub(crate) fn configure(&mut self, now: Instant, settings: BusSettings) {
        self.settings = settings;
        for motor in &mut self.motors {
            if let Control::Driven(driven) = &mut motor.control {
                driven.next_frame = driven.next_frame.min(now + settings.rate.period());
            }
        }
    }

    pub(crate) fn check_not_halted(&self) -> Result<(), Refusal> {
        if let Some(found) = self.evidence.other {
            let expected = self.model;
            return Err(Refusal::OtherModel { expected, found });
        }
        if self.halted {
            Err(Refusal::Halted)
        } else {
            self.check_not_stopping_first()
        }
    }
}

/// Whether a setpoint asks for rest. It does not wait for the next period.
#[must_use]
pub fn is_rest(setpoint: Setpoint) -> bool {
    match setpoint {
        Setpoint::Velocity { speed, .. } => speed.rpm() == 0,
        Setpoint::Current(current) => current.raw() == 0,
        Setpoint::OpenLoop(target) => target.raw() == 0,
        Setpoint::Brake => true,
        Setpoint::Position(_) => false,
    }
}
