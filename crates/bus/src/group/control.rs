//! Drives groups: all motors start or none, and all stop together.

use motorlink_protocol::{Instant, MotorId, Setpoint};

use crate::{
    bus::Bus,
    command::Consent,
    driving::is_rest,
    event::StopReason,
    group::setpoints::GroupSetpoints,
    motor::{Control, Motor},
    refusal::Refusal,
    safety::{Known, check_drive},
};

impl Bus {
    /// Drives all motors, or refuses and drives none.
    pub(crate) fn drive_group(
        &mut self,
        now: Instant,
        setpoints: &GroupSetpoints,
        consent: Consent,
    ) -> Result<(), Refusal> {
        self.check_group(setpoints, consent, &|motor| match motor.control {
            Control::Stopping(_) => Err(Refusal::Stopping(motor.id)),
            Control::Switching(_) => Err(Refusal::Switching(motor.id)),
            Control::Idle | Control::Driven(_) => Ok(motor.known(now)),
        })?;
        self.last_group += 1;
        // A single motor is not a group: it is driven as by its own command.
        let number = (setpoints.entries().count() > 1).then_some(self.last_group);
        for (id, setpoint) in setpoints.entries() {
            self.drive(now, id, setpoint, consent)?;
            if let Some(driven) = self.motor_mut(id).and_then(Motor::driven_mut) {
                driven.group = number;
            }
        }
        Ok(())
    }

    /// Changes the setpoints of a group that is driven.
    pub(crate) fn adjust_group(
        &mut self,
        now: Instant,
        setpoints: &GroupSetpoints,
        consent: Consent,
    ) -> Result<(), Refusal> {
        if self.adjust_waiting(now, setpoints, consent)? {
            return Ok(());
        }
        let mut group = None;
        for (id, setpoint) in setpoints.entries() {
            let driven = self.motor_mut(id).and_then(Motor::driven_mut);
            let driven = driven.ok_or(Refusal::NotDriven(id))?;
            let own = driven.group;
            if driven.goal.mode() != setpoint.mode() || *group.get_or_insert(own) != own {
                return Err(Refusal::NotDriven(id));
            }
            let motor = self.motor_mut(id).ok_or(Refusal::NotDriven(id))?;
            let known = motor.known(now);
            self.check_member(id, setpoint, consent, known, setpoints)?;
        }
        for (id, setpoint) in setpoints.entries() {
            self.adjust(now, id, setpoint, consent)?;
        }
        Ok(())
    }

    /// Changes the setpoints of a driven group at a time of its own plan; never starts a motor. Unlike
    /// [`Command::AdjustGroup`](crate::Command::AdjustGroup), each setpoint goes out at once, at any command rate, even
    /// if it is the same as before: the caller paces the frames.
    ///
    /// # Errors
    /// The [`Refusal`] says why; nothing has changed then.
    pub fn follow_plan(&mut self, now: Instant, setpoints: &GroupSetpoints) -> Result<(), Refusal> {
        self.begin_call(now);
        if self.watchdog.has_expired() {
            return Err(Refusal::PageSilent);
        }
        let mut waiting = Vec::new();
        let mut changed = false;
        for (id, setpoint) in setpoints.entries() {
            let driven = self.motor_mut(id).and_then(Motor::driven_mut);
            let driven = driven.ok_or(Refusal::NotDriven(id))?;
            waiting.push((id, driven.next_frame));
            changed |= driven.goal != setpoint;
        }
        // A zero that is only repeated must not cut the replies of the other motors short.
        if changed {
            self.adjust_group(now, setpoints, Consent::None)?;
        }
        for (id, next_frame) in waiting {
            if let Some(driven) = self.motor_mut(id).and_then(Motor::driven_mut) {
                // On a full line, a motor that has waited longer comes first.
                driven.next_frame = next_frame.min(now);
                driven.end_silence(now);
            }
        }
        Ok(())
    }

    /// Zero or brake for one motor of a group stops the group. Returns whether it did.
    pub(crate) fn stops_group(&mut self, now: Instant, id: MotorId, setpoint: Setpoint) -> bool {
        let is_stop = is_rest(setpoint) && self.check_not_in_group(id).is_err();
        if is_stop {
            self.begin_stop(now, StopReason::OneMotor, &|motor| motor.id == id);
        }
        is_stop
    }

    /// Refuses to drive one motor of a group apart from the others.
    pub(crate) fn check_not_in_group(&self, id: MotorId) -> Result<(), Refusal> {
        let motor = self.motors.iter().find(|motor| motor.id == id);
        let is_driven = motor.and_then(Motor::group).is_some();
        if is_driven || self.waiting_in_group(id).is_some() {
            return Err(Refusal::InGroup(id));
        }
        Ok(())
    }

    /// Refuses a group while nothing may be driven, or if one of its motors must not be, by what is `known` of it.
    pub(crate) fn check_group(
        &self,
        setpoints: &GroupSetpoints,
        consent: Consent,
        known: &dyn Fn(&Motor) -> Result<Known, Refusal>,
    ) -> Result<(), Refusal> {
        self.check_not_halted()?;
        self.check_no_job()?;
        self.check_no_raw_hazard()?;
        for (id, setpoint) in setpoints.entries() {
            let motor = self.motors.iter().find(|motor| motor.id == id);
            let known = known(motor.ok_or(Refusal::NotAnswering(id))?)?;
            self.check_member(id, setpoint, consent, known, setpoints)?;
        }
        Ok(())
    }

    /// Refuses a motor of a group that must not be driven, or whose group has others.
    fn check_member(
        &self,
        id: MotorId,
        setpoint: Setpoint,
        consent: Consent,
        known: Known,
        setpoints: &GroupSetpoints,
    ) -> Result<(), Refusal> {
        let limits = self.settings.limits;
        check_drive(self.model, id, setpoint, consent, limits, known)?;
        self.check_whole_group(id, setpoints)
    }

    fn check_whole_group(&self, id: MotorId, setpoints: &GroupSetpoints) -> Result<(), Refusal> {
        let group = self
            .motors
            .iter()
            .find(|motor| motor.id == id)
            .and_then(Motor::group);
        let left_out = |motor: &Motor| motor.group() == group && !setpoints.has(motor.id);
        if group.is_some() && self.motors.iter().any(left_out) {
            return Err(Refusal::InGroup(id));
        }
        Ok(())
    }

    /// Adds the other motors of their groups to the motors to stop.
    pub(crate) fn add_group_members(&self, ids: &mut Vec<MotorId>) {
        let group_of = |id: &MotorId| {
            let motor = self.motors.iter().find(|motor| motor.id == *id);
            motor.and_then(Motor::group)
        };
        let groups: Vec<u32> = ids.iter().filter_map(group_of).collect();
        for motor in &self.motors {
            if motor.group().is_some_and(|group| groups.contains(&group))
                && !ids.contains(&motor.id)
            {
                ids.push(motor.id);
            }
        }
    }
}
