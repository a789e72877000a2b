//! Starts a group whose motors may be in other loops: they stop first, and a stop leaves each in the velocity loop.

use motorlink_protocol::{Instant, Mode, MotorId, Setpoint};

use crate::{
    bus::Bus,
    command::Consent,
    driving::is_rest,
    event::{Event, StopOutcome, StopReason},
    group::{setpoints::GroupSetpoints, waiting::WaitingGroup},
    motor::{Control, Motor},
    refusal::Refusal,
    safety::Known,
};

impl Bus {
    /// Drives all motors, or refuses and drives none. If one is in another loop, or is being stopped, all stop first.
    pub(crate) fn start_group(
        &mut self,
        now: Instant,
        setpoints: &GroupSetpoints,
        consent: Consent,
    ) -> Result<(), Refusal> {
        let in_velocity_loop = |(_, setpoint): (_, Setpoint)| setpoint.mode() == Mode::Velocity;
        let is_member = |motor: &Motor| setpoints.has(motor.id);
        let can_start = |motor: &Motor| match motor.control {
            Control::Idle => motor.obeys() && motor.fresh_mode(now) == Some(Mode::Velocity),
            Control::Driven(driven) => driven.goal.mode() == Mode::Velocity,
            Control::Switching(_) | Control::Stopping(_) => false,
        };
        let mut members = self.motors.iter().filter(|motor| is_member(motor));
        if members.all(can_start) || !setpoints.entries().all(in_velocity_loop) {
            return self.drive_group(now, setpoints, consent);
        }
        self.check_waiting(now, setpoints, consent)?;
        let must_stop =
            |motor: &Motor| is_member(motor) && !matches!(motor.control, Control::Stopping(_));
        if self.motors.iter().any(must_stop) {
            self.begin_stop(now, StopReason::OneMotor, &must_stop);
        }
        self.set_waiting(setpoints, consent);
        Ok(())
    }

    /// Changes the setpoints of the group that waits, or ends its start by zeros. Returns whether these motors wait.
    pub(crate) fn adjust_waiting(
        &mut self,
        now: Instant,
        setpoints: &GroupSetpoints,
        consent: Consent,
    ) -> Result<bool, Refusal> {
        let Some(waiting) = self.waiting_group() else {
            return Ok(false);
        };
        if !waiting.setpoints.has_the_motors_of(setpoints) {
            return Ok(false);
        }
        if setpoints.entries().all(|(_, setpoint)| is_rest(setpoint)) {
            if let Some(stop) = &mut self.stop {
                stop.then_group = None;
            }
            return Ok(true);
        }
        self.check_waiting(now, setpoints, consent)?;
        self.set_waiting(setpoints, consent);
        Ok(true)
    }

    /// Drives the group that waited for this stop, or says why not.
    pub(crate) fn start_stopped_group(
        &mut self,
        now: Instant,
        outcomes: &[StopOutcome],
        group: WaitingGroup,
    ) {
        let WaitingGroup { setpoints, consent } = group;
        let is_unconfirmed =
            |outcome: &&StopOutcome| setpoints.has(outcome.id) && !outcome.confirmed;
        let unconfirmed = outcomes.iter().find(is_unconfirmed);
        match unconfirmed {
            Some(&StopOutcome { id, .. }) => {
                let refusal = Refusal::NotStopped(id);
                self.events.push_back(Event::NotStarted { id, refusal });
            }
            None => {
                if let Err(refusal) = self.drive_group(now, &setpoints, consent) {
                    self.group_not_started(&setpoints, refusal);
                }
            }
        }
    }

    /// Passes on whether these motors were started. If not, a group of one of them waits no longer: the page says that it
    /// is not started.
    pub(crate) fn or_end_wait(
        &mut self,
        started: Result<(), Refusal>,
        setpoints: &GroupSetpoints,
    ) -> Result<(), Refusal> {
        let Err(refusal) = started else {
            return Ok(());
        };
        let has_one = |group: &mut WaitingGroup| {
            let mut motors = setpoints.entries();
            motors.any(|(id, _)| group.setpoints.has(id))
        };
        let stop = self.stop.as_mut();
        if let Some(group) = stop.and_then(|stop| stop.then_group.take_if(has_one)) {
            self.group_not_started(&group.setpoints, refusal);
        }
        Err(refusal)
    }

    fn group_not_started(&mut self, setpoints: &GroupSetpoints, refusal: Refusal) {
        if let Some((id, _)) = setpoints.entries().next() {
            self.events.push_back(Event::NotStarted { id, refusal });
        }
    }

    /// A job takes the line: nothing that waits for a stop starts behind it.
    pub(crate) fn end_starts_for_job(&mut self) {
        for motor in &mut self.motors {
            if let Control::Stopping(stop) = &mut motor.control
                && stop.then.take().is_some()
            {
                let (id, refusal) = (motor.id, Refusal::JobRunning);
                self.events.push_back(Event::NotStarted { id, refusal });
            }
        }
        let group = self.stop.as_mut().and_then(|stop| stop.then_group.take());
        if let Some(group) = group {
            self.group_not_started(&group.setpoints, Refusal::JobRunning);
        }
    }

    /// The setpoint with which this motor waits for the other motors of its group.
    pub(crate) fn waiting_in_group(&self, id: MotorId) -> Option<Setpoint> {
        self.waiting_group()?.setpoints.of(id)
    }

    fn waiting_group(&self) -> Option<&WaitingGroup> {
        self.stop.as_ref()?.then_group.as_ref()
    }

    /// The newest start wins: it clears what its motors wait for alone.
    fn set_waiting(&mut self, setpoints: &GroupSetpoints, consent: Consent) {
        for motor in &mut self.motors {
            if let Control::Stopping(stop) = &mut motor.control
                && setpoints.has(motor.id)
            {
                stop.then = None;
            }
        }
        if let Some(stop) = &mut self.stop {
            stop.then_group = Some(WaitingGroup {
                setpoints: *setpoints,
                consent,
            });
        }
    }

    /// Refuses what would be refused after the stop too. In which loop a motor is then, its stop decides.
    fn check_waiting(
        &self,
        now: Instant,
        setpoints: &GroupSetpoints,
        consent: Consent,
    ) -> Result<(), Refusal> {
        self.check_group(setpoints, consent, &|motor| {
            let known = motor.known(now);
            let answers = known.reported.is_some() || motor.fresh_speed(now).is_some();
            Ok(Known {
                reported: answers.then_some(Mode::Velocity),
                ..known
            })
        })
    }
}
