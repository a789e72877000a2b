//! Sends raw frames under the rules of drive commands.

use motorlink_protocol::{Faults, Frame, Instant, Mode, MotorId};

use crate::{
    bus::Bus,
    command::Consent,
    event::{Event, IdQueryOutcome, StopReason},
    exchange::Expects,
    motor::{Control, Motor},
    raw::checks::{check_model_known, check_raw, check_raw_speed},
    raw::frame::{Raw, RawEffect},
    raw::hazard::unassignable_id,
    raw::status::{RawAnswer, RawStatus, Repeat},
    refusal::Refusal,
    safety::{Known, check_driven},
    timing::LOOP_QUERY_PERIOD,
};

impl Bus {
    /// The last raw frame since the bus began.
    #[must_use]
    pub fn raw(&self) -> Option<RawStatus> {
        self.raw.as_ref().map(Raw::status)
    }

    pub(crate) fn send_raw(
        &mut self,
        now: Instant,
        frame: Frame,
        repeat: Repeat,
        consent: Consent,
    ) -> Result<(), Refusal> {
        if let Some(id) = unassignable_id(&frame) {
            return Err(Refusal::NotAssignable(id));
        }
        self.check_no_job()?;
        self.check_no_raw_hazard()?;
        let mut raw = Raw::begin(now, self.model, frame, repeat);
        // A frame that all may answer takes the line for several drive periods.
        let holds_line = matches!(
            Expects::of_raw(self.model, &frame),
            Expects::Everyone { .. }
        );
        if raw.is_hazardous() {
            self.check_not_stopping_first()?;
        }
        if raw.is_hazardous() || holds_line {
            self.check_nothing_driven()?;
        }
        if raw.is_hazardous() {
            self.check_not_halted()?;
            self.check_raw_effect(now, raw, consent)?;
        }
        if raw.effect == RawEffect::SetId {
            raw.to_check = Some(self.take_proof(now)?);
        }
        if let Some(id) = raw.addressee.filter(|_| raw.is_hazardous()) {
            self.watch(now, id);
        }
        raw.began_in = self.concerned(raw).find_map(|motor| motor.fresh_mode(now));
        self.raw = Some(raw);
        Ok(())
    }

    /// The known motors that may obey it.
    fn concerned(&self, raw: Raw) -> impl Iterator<Item = &Motor> {
        self.motors.iter().filter(move |it| raw.may_move(it.id))
    }

    /// The same checks as for a setpoint or a mode switch, for each motor that may obey the frame.
    fn check_raw_effect(&self, now: Instant, raw: Raw, consent: Consent) -> Result<(), Refusal> {
        let mut seen = None;
        for motor in self.concerned(raw) {
            let (known, speed) = (motor.known(now), motor.fresh_speed(now));
            let told_loop = motor.separate.loop_known.fresh(now, self.model);
            if speed.is_none() && told_loop.is_none() {
                check_model_known(self.model, raw.effect, motor.id)?;
            }
            check_raw(
                self.model,
                raw.effect,
                motor.id,
                known,
                speed,
                self.settings.limits,
                consent,
            )?;
            if let Some(current) = raw.current_in(known.reported)
                && motor.torque.is_reversed_by(current)
            {
                return Err(Refusal::ReversesTorque(motor.id));
            }
            // One value has another meaning in each loop.
            if let (Some(asked), Some(reported)) = (seen, known.reported)
                && asked != reported
                && !matches!(raw.effect, RawEffect::Switch(_) | RawEffect::MayBeSwitch(_))
            {
                let id = motor.id;
                return Err(Refusal::OtherLoop {
                    id,
                    asked,
                    reported,
                });
            }
            seen = seen.or(known.reported);
        }
        let drives_all = raw.addressee.is_none() && matches!(raw.effect, RawEffect::Drive { .. });
        if drives_all || self.concerned(raw).next().is_none() {
            // An unknown motor may obey it.
            let [first, ..] = *raw.frame.bytes();
            let id = MotorId::new(first).unwrap_or(MotorId::FIRST);
            check_model_known(self.model, raw.effect, id)?;
            check_raw(
                self.model,
                raw.effect,
                id,
                Known::NOTHING,
                None,
                self.settings.limits,
                consent,
            )?;
        }
        Ok(())
    }

    /// Ends the repetition and stops the motors that may turn because of it.
    pub(crate) fn stop_raw(&mut self, now: Instant) {
        let Some(raw) = &mut self.raw else {
            return;
        };
        let (hazardous, addressee) = (raw.is_hazardous(), raw.addressee);
        raw.stop();
        // A frame without addressee may have moved any motor.
        let concerns = |motor: &Motor| {
            motor.may_turn() && addressee.is_none_or(|addressee| addressee == motor.id)
        };
        if hazardous && self.motors.iter().any(concerns) {
            self.begin_stop(now, StopReason::OneMotor, &concerns);
        }
    }

    /// Refuses other motion while a raw frame that may move a wheel is repeated.
    pub(crate) fn check_no_raw_hazard(&self) -> Result<(), Refusal> {
        if self.raw.is_some_and(|raw| raw.is_hazard_running()) {
            Err(Refusal::RawRunning)
        } else {
            Ok(())
        }
    }

    fn check_nothing_driven(&self) -> Result<(), Refusal> {
        let mut busy = self
            .motors
            .iter()
            .filter(|motor| !matches!(motor.control, Control::Idle));
        match busy.next() {
            Some(motor) if matches!(motor.control, Control::Stopping(_)) => {
                Err(Refusal::Stopping(motor.id))
            }
            Some(motor) => Err(Refusal::Driven(motor.id)),
            None => Ok(()),
        }
    }

    /// The motor that has to name its loop before the next raw drive frame: outside the velocity loop it may have lost
    /// power, and would read the value as a speed. The frame waits.
    pub(crate) fn raw_waits_for_loop(&mut self, now: Instant) -> Option<MotorId> {
        let raw = self
            .raw
            .filter(|raw| matches!(raw.effect, RawEffect::Drive { .. }))?;
        let waits = |motor: &&Motor| {
            let drives_outside = motor.last_mode().is_some_and(|mode| mode != Mode::Velocity);
            drives_outside && motor.must_name_loop(now)
        };
        let id = self.concerned(raw).find(waits)?.id;
        if let Some(raw) = &mut self.raw {
            raw.wait_until(now + LOOP_QUERY_PERIOD);
        }
        Some(id)
    }

    /// Records the possible effect of the frame that goes out.
    pub(crate) fn raw_goes_out(&mut self, now: Instant) {
        let Some(raw) = &mut self.raw else {
            return;
        };
        raw.sent(now);
        let raw = *raw;
        let (effect, addressee) = (raw.effect, raw.addressee);
        for motor in self.motors.iter_mut().filter(|it| raw.may_move(it.id)) {
            if let Some(current) = raw.current_in(motor.fresh_mode(now)) {
                motor.torque.sent(current);
            }
        }
        match (effect, addressee) {
            (RawEffect::Probe | RawEffect::SetId, _) => {}
            (RawEffect::Switch(mode) | RawEffect::MayBeSwitch(mode), Some(id)) => {
                self.watch(now, id).switch_sent(now, mode);
            }
            (RawEffect::Drive { .. } | RawEffect::Unknown, Some(id)) => {
                let motor = self.watch(now, id);
                motor.rest.doubt();
                motor.moved_raw = true;
            }
            (effect, None) => {
                for motor in &mut self.motors {
                    motor.rest.doubt();
                    motor.moved_raw = true;
                    if let RawEffect::Switch(mode) | RawEffect::MayBeSwitch(mode) = effect {
                        motor.switch_sent(now, mode);
                    }
                }
            }
        }
    }

    pub(crate) fn raw_answered(&mut self, answer: RawAnswer) {
        if let Some(raw) = &mut self.raw {
            raw.answered(answer);
        }
    }

    /// Result of the ID query before a raw set-ID frame. If the motor is not alone any more, none
    /// is sent.
    pub(crate) fn raw_checked(&mut self, outcome: IdQueryOutcome) {
        if let Some(raw) = &mut self.raw
            && let Some(alone) = raw.to_check.take()
            && outcome != IdQueryOutcome::One(alone)
        {
            raw.stop();
        }
    }

    /// Withdraws a raw frame for the reasons of any setpoint. If one motor that may obey it fails a
    /// check, all of them are stopped.
    pub(crate) fn supervise_raw(&mut self, now: Instant) {
        let Some(raw) = self.raw.as_mut().filter(|raw| raw.is_hazard_running()) else {
            return;
        };
        let mut ends = false;
        for motor in &self.motors {
            if !raw.may_move(motor.id) {
                continue;
            }
            if motor.silent_since() > raw.since {
                // The frames are meant for the loop of the first reply.
                raw.began_in = raw.began_in.or(motor.fresh_mode(now));
            }
            let reported = motor.last_mode();
            let asked = match raw.effect {
                RawEffect::Switch(_) | RawEffect::MayBeSwitch(_) => reported,
                _ => raw.began_in.or(reported),
            };
            let withdrawn = check_driven(
                asked,
                reported,
                motor.fresh_faults(now).unwrap_or(Faults::NONE),
                motor.exceeded(now, self.settings.limits, raw.since),
                motor.silent_for(now, raw.since),
                motor.unanswered_in_a_row,
            );
            // A motor with separate frames tells its temperature only when it is driven.
            let drives = matches!(raw.effect, RawEffect::Drive { .. });
            let unknown = motor.temperature_unknown(now, raw.since);
            let withdrawn = withdrawn.or(unknown.filter(|_| drives && motor.has_answered()));
            if let Some(reason) = withdrawn {
                let id = motor.id;
                self.events.push_back(Event::Withdrawn { id, reason });
            }
            // The operator may lower a limit meanwhile.
            let allowed =
                check_raw_speed(raw.effect, motor.known(now), self.settings.limits).is_ok();
            ends |= withdrawn.is_some() || !allowed;
        }
        let raw = *raw;
        if ends {
            self.begin_stop(now, StopReason::OneMotor, &|motor| raw.may_move(motor.id));
        }
    }

    /// When the next raw set-ID frame is due. They are sent in a row.
    pub(crate) fn raw_has_line(&self) -> Option<Instant> {
        let raw = self.raw.filter(|raw| raw.effect == RawEffect::SetId)?;
        raw.next_frame()
    }

    /// Whether raw frames drive this motor, alone or with others.
    pub(crate) fn is_driven_raw(&self, id: MotorId) -> bool {
        self.raw
            .is_some_and(|raw| raw.is_hazard_running() && raw.may_move(id))
    }
}
