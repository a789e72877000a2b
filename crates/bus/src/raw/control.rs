//! Frames that a person wrote. What they may set in motion is under the same rules as any driving.

use motorlink_protocol::{CurrentTarget, Faults, Frame, Instant, Mode, MotorId, Rpm, Setpoint};

use crate::{
    bus::Bus,
    command::{Consent, Refusal},
    event::{Event, IdQueryOutcome, StopReason},
    exchange::Expects,
    limits::Limits,
    motor::{Control, Motor},
    raw::frame::{Deed, Raw},
    raw::hazard::unassignable_id,
    raw::status::{RawAnswer, RawStatus, Repeat},
    safety::{Known, check_driven, check_position_switch, needs_consent},
};

impl Bus {
    /// The last frame that a person wrote, since the bus began.
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
            self.check_deed(now, raw, consent)?;
        }
        if raw.deed == Deed::SetId {
            raw.to_check = Some(self.use_proof(now)?);
        }
        if let Some(id) = raw.addressee.filter(|_| raw.is_hazardous()) {
            self.watch(now, id);
        }
        raw.began_in = self.concerned(raw).find_map(|motor| motor.fresh_mode(now));
        self.raw = Some(raw);
        Ok(())
    }

    /// The motors that may obey it, as far as they are known.
    fn concerned(&self, raw: Raw) -> impl Iterator<Item = &Motor> {
        self.motors.iter().filter(move |it| raw.may_move(it.id))
    }

    /// What is asked before a setpoint or a loop is asked of the same deed by raw bytes, of each motor
    /// that may obey them.
    fn check_deed(&self, now: Instant, raw: Raw, consent: Consent) -> Result<(), Refusal> {
        let mut seen = None;
        for motor in self.concerned(raw) {
            let (known, speed) = (motor.known(now), motor.fresh_speed(now));
            check_raw(raw.deed, motor.id, known, speed, self.limits, consent)?;
            if let Some(current) = raw.current_in(known.reported)
                && motor.torque.is_reversed_by(current)
            {
                return Err(Refusal::ReversesTorque(motor.id));
            }
            // One number means something else in each loop.
            if let (Some(asked), Some(reported)) = (seen, known.reported)
                && asked != reported
                && !matches!(raw.deed, Deed::Switch(_))
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
        let drives_all = raw.addressee.is_none() && matches!(raw.deed, Deed::Drive { .. });
        if drives_all || self.concerned(raw).next().is_none() {
            // A motor of which nothing is known may obey it.
            let [first, ..] = *raw.frame.bytes();
            let id = MotorId::new(first).unwrap_or(MotorId::FIRST);
            check_raw(raw.deed, id, Known::NOTHING, None, self.limits, consent)?;
        }
        Ok(())
    }

    /// Sends no more of them, and stops what they may have moved.
    pub(crate) fn stop_raw(&mut self, now: Instant) {
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

    /// The frame goes out: what it may do is noted.
    pub(crate) fn raw_goes_out(&mut self, now: Instant) {
        let Some(raw) = &mut self.raw else {
            return;
        };
        raw.sent(now);
        let raw = *raw;
        let (deed, addressee) = (raw.deed, raw.addressee);
        for motor in self.motors.iter_mut().filter(|it| raw.may_move(it.id)) {
            if let Some(current) = raw.current_in(motor.fresh_mode(now)) {
                motor.torque.sent(current);
            }
        }
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

    pub(crate) fn raw_answered(&mut self, answer: RawAnswer) {
        if let Some(raw) = &mut self.raw {
            raw.answered(answer);
        }
    }

    /// What the ID query before a set-ID frame brought. Where the motor is not alone any more, none is
    /// sent.
    pub(crate) fn raw_checked(&mut self, outcome: IdQueryOutcome) {
        if let Some(raw) = &mut self.raw
            && let Some(alone) = raw.to_check.take()
            && outcome != IdQueryOutcome::One(alone)
        {
            raw.stop();
        }
    }

    /// Motors that a person drives by raw frames lose them for the same reasons as any other. Those that
    /// one frame may drive lose it together.
    pub(crate) fn look_after_raw(&mut self, now: Instant) {
        let Some(raw) = self.raw.as_mut().filter(|raw| raw.is_hazard_running()) else {
            return;
        };
        let mut ends = false;
        for motor in &self.motors {
            if !raw.may_move(motor.id) {
                continue;
            }
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
            if let Some(reason) = withdrawn {
                let id = motor.id;
                self.events.push_back(Event::Withdrawn { id, reason });
            }
            // A limit may be lowered meanwhile.
            let allowed = check_raw_speed(raw.deed, motor.known(now), self.limits).is_ok();
            ends |= withdrawn.is_some() || !allowed;
        }
        let raw = *raw;
        if ends {
            self.begin_stop(now, StopReason::OneMotor, |motor| raw.may_move(motor.id));
        }
    }

    /// Whether a set-ID frame is next, with nothing between it and the others.
    pub(crate) fn raw_has_line(&self) -> Option<Instant> {
        let raw = self.raw.filter(|raw| raw.deed == Deed::SetId)?;
        raw.next_frame()
    }

    /// Whether a person drives this motor by raw frames, alone or with others.
    pub(crate) fn is_driven_raw(&self, id: MotorId) -> bool {
        self.raw
            .is_some_and(|raw| raw.is_hazard_running() && raw.may_move(id))
    }
}

/// Whether raw bytes may do this to a motor now, by what is known of it.
fn check_raw(
    deed: Deed,
    id: MotorId,
    known: Known,
    speed: Option<Rpm>,
    limits: Limits,
    consent: Consent,
) -> Result<(), Refusal> {
    let value = match deed {
        Deed::Drive { value } => value,
        Deed::Switch(Mode::Position) => return check_position_switch(id, speed),
        Deed::Ask | Deed::Switch(_) | Deed::SetId | Deed::Unknown => return Ok(()),
    };
    if let Some(crossed) = limits.too_hot(known.temperature) {
        return Err(Refusal::TooHot { id, crossed });
    }
    check_raw_speed(deed, known, limits)?;
    if matches!(known.reported, None | Some(Mode::Current)) {
        // The lowest value of all has no positive twin.
        let value = i32::from(value).max(-i32::from(i16::MAX));
        let current = CurrentTarget::new(value).unwrap_or_default();
        let asks = needs_consent(Setpoint::Current(current)) != Consent::None;
        if asks && consent == Consent::None {
            return Err(Refusal::NeedsConsent(current));
        }
    }
    Ok(())
}

/// Whether a value that raw bytes drive to is within the speed limit. Where the motor's loop is unknown,
/// it may be meant as a speed, and a motor takes a value that is none as its highest.
fn check_raw_speed(deed: Deed, known: Known, limits: Limits) -> Result<(), Refusal> {
    let Deed::Drive { value } = deed else {
        return Ok(());
    };
    let may_be_speed = matches!(known.reported, None | Some(Mode::Velocity));
    if may_be_speed && value.unsigned_abs() > limits.speed_rpm() {
        return Err(Refusal::AboveSpeedLimit(limits.speed_rpm()));
    }
    Ok(())
}
