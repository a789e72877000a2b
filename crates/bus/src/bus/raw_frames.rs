//! Frames that a person wrote. What they may set in motion is under the same rules as any driving.

use motorlink_protocol::{CurrentTarget, Faults, Frame, Instant, Mode, MotorId, Setpoint};

use super::Bus;
use crate::{
    Consent, Event, IdQueryOutcome, Limits, RawAnswer, RawStatus, Refusal, Repeat, StopReason,
    exchange::Expects,
    motor::{Control, Motor},
    raw::{Deed, Raw},
    safety::{check_driven, check_position_switch, needs_consent},
};

impl Bus {
    /// The last frame that a person wrote, since the bus began.
    #[must_use]
    pub fn raw(&self) -> Option<RawStatus> {
        self.raw.as_ref().map(Raw::status)
    }

    pub(super) fn send_raw(
        &mut self,
        now: Instant,
        frame: Frame,
        repeat: Repeat,
        consent: Consent,
    ) -> Result<(), Refusal> {
        self.check_no_survey()?;
        self.check_no_raw_hazard()?;
        let mut raw = Raw::begin(now, frame, repeat);
        // One that all may answer takes the line for as long as several drive frames would.
        let holds_line = matches!(Expects::of_raw(&frame), Expects::Everyone { .. });
        if raw.is_hazardous() || holds_line {
            self.check_nothing_driven()?;
        }
        if raw.is_hazardous() {
            self.check_not_halted()?;
            self.check_deed(now, &raw, consent)?;
        }
        if raw.deed == Deed::SetId {
            raw.to_check = Some(self.use_proof(now)?);
        }
        if let Some(id) = raw.addressee.filter(|_| raw.is_hazardous()) {
            raw.began_in = self.watch(now, id).fresh_mode(now);
        }
        self.raw = Some(raw);
        Ok(())
    }

    /// What is asked before a setpoint or a loop is asked of the same deed by raw bytes.
    fn check_deed(&self, now: Instant, raw: &Raw, consent: Consent) -> Result<(), Refusal> {
        let motor = self.motors.iter().find(|m| Some(m.id) == raw.addressee);
        let mode = motor.and_then(|motor| motor.fresh_mode(now));
        if let (Deed::Drive { value }, Some(id)) = (raw.deed, raw.addressee) {
            let temperature = motor.and_then(|motor| motor.known(now).temperature);
            if let Some(crossed) = self.limits.too_hot(temperature) {
                return Err(Refusal::TooHot { id, crossed });
            }
            // Where its loop is unknown, it may be meant as a speed.
            let may_be_speed = matches!(mode, None | Some(Mode::Velocity));
            let limit = self.limits.speed_rpm();
            // What no motor takes as a speed is none.
            let is_speed = value.unsigned_abs() <= Limits::SPEED_RPM.1;
            if may_be_speed && is_speed && value.unsigned_abs() > limit {
                return Err(Refusal::AboveSpeedLimit(limit));
            }
        }
        match (raw.deed, raw.addressee) {
            (Deed::Switch(Mode::Position), Some(id)) => {
                check_position_switch(id, motor.and_then(|motor| motor.fresh_speed(now)))
            }
            (Deed::Drive { value }, _) if matches!(mode, None | Some(Mode::Current)) => {
                // The lowest value of all has no positive twin.
                let value = i32::from(value).max(-i32::from(i16::MAX));
                let current = CurrentTarget::new(value).unwrap_or_default();
                let asks = needs_consent(Setpoint::Current(current)) != Consent::None;
                if asks && consent == Consent::None {
                    return Err(Refusal::NeedsConsent(current));
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Sends no more of them, and stops what they may have moved.
    pub(super) fn stop_raw(&mut self, now: Instant) {
        let Some(raw) = &mut self.raw else {
            return;
        };
        let (hazardous, addressee) = (raw.is_hazardous(), raw.addressee);
        raw.stop();
        // One without addressee may have moved anyone.
        let concerns = |motor: &Motor| {
            motor.may_turn && addressee.is_none_or(|addressee| addressee == motor.id)
        };
        if hazardous && self.motors.iter().any(concerns) {
            self.begin_stop(now, StopReason::OneMotor, concerns);
        }
    }

    /// While a frame that may move a wheel is being repeated, nothing else may.
    pub(super) fn check_no_raw_hazard(&self) -> Result<(), Refusal> {
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

    /// The frame goes out: what it may do is noted.
    pub(super) fn raw_goes_out(&mut self, now: Instant) {
        let Some(raw) = &mut self.raw else {
            return;
        };
        raw.sent(now);
        let (deed, addressee) = (raw.deed, raw.addressee);
        match (deed, addressee) {
            (Deed::Ask | Deed::SetId, _) => {}
            (Deed::Switch(mode), Some(id)) => self.watch(now, id).switch_sent(mode),
            (Deed::Drive { .. } | Deed::Unknown, Some(id)) => {
                self.watch(now, id).may_turn = true;
            }
            (deed, None) => {
                for motor in &mut self.motors {
                    motor.may_turn = true;
                    if let Deed::Switch(mode) = deed {
                        motor.switch_sent(mode);
                    }
                }
            }
        }
    }

    pub(super) fn raw_answered(&mut self, answer: RawAnswer) {
        if let Some(raw) = &mut self.raw {
            raw.answered(answer);
        }
    }

    /// What the ID query before a set-ID frame brought. Where the motor is not alone any more, none is
    /// sent.
    pub(super) fn raw_checked(&mut self, outcome: IdQueryOutcome) {
        if let Some(raw) = &mut self.raw
            && let Some(alone) = raw.to_check.take()
            && outcome != IdQueryOutcome::One(alone)
        {
            raw.stop();
        }
    }

    /// A motor that a person drives by raw frames loses them for the same reasons as any other.
    pub(super) fn look_after_raw(&mut self, now: Instant) {
        let Some(raw) = self.raw.as_mut().filter(|raw| raw.is_hazard_running()) else {
            return;
        };
        let Some(motor) = self.motors.iter().find(|m| Some(m.id) == raw.addressee) else {
            return;
        };
        if motor.quiet_since() > raw.since {
            // What the first reply reports is what the frames are meant for.
            raw.began_in = raw.began_in.or(motor.fresh_mode(now));
        }
        let reported = motor.last_mode();
        let asked = match raw.deed {
            Deed::Switch(_) => reported,
            _ => raw.began_in.or(reported),
        };
        let withdrawn = check_driven(
            asked,
            reported,
            motor.fresh_faults(now).unwrap_or(Faults::NONE),
            motor.crossed(now, self.limits, raw.since),
            now.since(motor.quiet_since().max(raw.since)),
            motor.unanswered_in_a_row,
        );
        let id = motor.id;
        if let Some(reason) = withdrawn {
            self.events.push_back(Event::Withdrawn { id, reason });
            self.begin_stop(now, StopReason::OneMotor, |motor| motor.id == id);
        }
    }

    /// Whether a set-ID frame is next, with nothing between it and the others.
    pub(super) fn raw_has_line(&self) -> Option<Instant> {
        let raw = self.raw.filter(|raw| raw.deed == Deed::SetId)?;
        raw.next_frame()
    }

    /// The motor that a person drives by raw frames, where it is one.
    pub(super) fn driven_raw(&self) -> Option<MotorId> {
        self.raw
            .filter(Raw::is_hazard_running)
            .and_then(|raw| raw.addressee)
    }
}
