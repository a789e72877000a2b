//! The newest state that the worker has reported, as plain data.

use std::time::Duration;

use motorlink_messages::{
    Adapter, Connection, Notice, Update,
    bus::{
        Activity, FRESH_FOR, JobStatus, LineStatus, MotorStatus, RawStatus, StopOutcome,
        StopReason, is_hazardous,
    },
    protocol::{Angle, Celsius, Current, Faults, Instant, Mode, MotorId, Reply, Rpm},
};

use crate::model::{mirror::Mirror, names_and_sides::NamesAndSides};

/// Everything that the page shows, except for the entered targets.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Session {
    /// The time for which ages are computed, on the worker's clock.
    pub(crate) now: Instant,
    /// The state of the port.
    pub(crate) connection: Connection,
    /// Whether "Stop all motors" is in effect.
    pub(crate) halted: bool,
    /// Every queried motor.
    pub(crate) motors: Vec<MotorStatus>,
    /// The running scan or ID change.
    pub(crate) job: Option<JobStatus>,
    /// The last frame of the raw editor.
    pub(crate) raw: Option<RawStatus>,
    /// The status of the line; `None` while no port is open.
    pub(crate) line: Option<LineStatus>,
    /// The last "Stop all motors", while it is in effect.
    pub(crate) stop: Option<StopRecord>,
    /// The motors whose speed and current have the reversed sign here; none in the state of the worker.
    pub(crate) mirrored: Vec<MotorId>,
}

/// The progress of "Stop all motors".
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct StopRecord {
    /// Why.
    pub(crate) reason: StopReason,
    /// The last result of every motor that had to be stopped.
    pub(crate) outcomes: Vec<StopOutcome>,
    /// Whether it has a report. A stop whose port is closed gets none.
    pub(crate) ended: bool,
}

/// A value and its age.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reading<T> {
    /// The reported value.
    pub(crate) value: T,
    /// Its age.
    pub(crate) age: Duration,
}

impl<T> Reading<T> {
    /// Whether it is recent enough to be shown as current.
    pub(crate) fn is_fresh(&self) -> bool {
        self.age <= FRESH_FOR
    }

    fn map<U>(self, read: impl FnOnce(T) -> U) -> Reading<U> {
        Reading {
            value: read(self.value),
            age: self.age,
        }
    }
}

impl Default for Session {
    fn default() -> Self {
        Self {
            now: Instant::ZERO,
            connection: Connection::Disconnected,
            halted: false,
            motors: Vec::new(),
            job: None,
            raw: None,
            line: None,
            stop: None,
            mirrored: Vec::new(),
        }
    }
}

impl Session {
    /// Applies an update of the worker. The caller shows its notices; those about a stop are also stored here.
    pub(crate) fn apply(&mut self, update: &Update) {
        self.now = update.now;
        self.connection = update.connection;
        self.halted = update.halted;
        self.motors.clone_from(&update.motors);
        self.job.clone_from(&update.job);
        self.raw = update.raw;
        self.line = update.line;
        for notice in &update.notices {
            match notice {
                Notice::StopBegan(reason) if concerns_all(*reason) => {
                    self.record_stop(*reason, None);
                }
                // A disconnect gives its reason to the stop that it joins.
                Notice::StopEnded(report) if concerns_all(report.reason) || self.stop.is_some() => {
                    self.record_stop(report.reason, Some(&report.motors));
                }
                _ => {}
            }
        }
        if !self.halted {
            self.stop = None;
        }
    }

    /// The first stop is the cause of the standstill. Stops that follow it until Release only repeat it: they have no
    /// outcome for a motor that stands by then, and its first one stays.
    fn record_stop(&mut self, reason: StopReason, outcomes: Option<&[StopOutcome]>) {
        let stop = self.stop.get_or_insert(StopRecord {
            reason,
            outcomes: Vec::new(),
            ended: false,
        });
        stop.ended = outcomes.is_some();
        for outcome in outcomes.unwrap_or_default() {
            stop.outcomes.retain(|earlier| earlier.id != outcome.id);
            stop.outcomes.push(*outcome);
        }
    }

    /// Reverses the sign of speed, current and setpoint of mirrored motors.
    pub(crate) fn with_mirroring(mut self, names: &NamesAndSides) -> Self {
        for motor in &mut self.motors {
            let mirror = names.mirror(motor.id);
            if !mirror.is_mirrored() {
                continue;
            }
            self.mirrored.push(motor.id);
            motor.activity = mirror.activity(motor.activity);
            motor.waiting = motor.waiting.map(|setpoint| mirror.setpoint(setpoint));
            motor.speed = motor.speed.map(|(at, speed)| (at, mirror.speed(speed)));
            motor.current = motor
                .current
                .map(|(at, current)| (at, mirror.current(current)));
        }
        self
    }

    /// Whether the signs of this motor are reversed here.
    pub(crate) fn mirror(&self, id: MotorId) -> Mirror {
        if self.mirrored.contains(&id) {
            Mirror::Mirrored
        } else {
            Mirror::Straight
        }
    }

    /// Whether anything differs that has to be shown at once.
    pub(crate) fn differs_in_state(&self, other: &Self) -> bool {
        // Compared with the signs of the wire.
        let outline = |session: &Self, motor: &MotorStatus| {
            let reply = motor.last.map(|sample| sample.reply);
            (
                motor.id,
                session.mirror(motor.id).activity(motor.activity),
                motor
                    .waiting
                    .map(|setpoint| session.mirror(motor.id).setpoint(setpoint)),
                (motor.answer, motor.may_turn, motor.turns_unasked),
                reply.map(|reply| (reply.mode, reply.faults)),
            )
        };
        self.connection != other.connection
            || self.halted != other.halted
            || self.stop != other.stop
            || self.job != other.job
            || self.raw.map(|raw| raw.running) != other.raw.map(|raw| raw.running)
            || !self
                .motors
                .iter()
                .map(|motor| outline(self, motor))
                .eq(other.motors.iter().map(|motor| outline(other, motor)))
    }

    pub(crate) fn motor(&self, id: MotorId) -> Option<&MotorStatus> {
        self.motors.iter().find(|motor| motor.id == id)
    }

    /// Motors that have answered.
    pub(crate) fn found(&self) -> Vec<MotorId> {
        let answered = self.motors.iter().filter(|motor| motor.last.is_some());
        answered.map(|motor| motor.id).collect()
    }

    /// Whether it is that of a recording: nothing in it moves now.
    #[inline(never)]
    pub(crate) fn is_recording(&self) -> bool {
        matches!(self.connection, Connection::Connected(Adapter::Recording))
    }

    /// Whether Stop all motors is in effect. What a recording shows of it holds nothing here.
    pub(crate) fn is_halted(&self) -> bool {
        self.halted && !self.is_recording()
    }

    /// Motors that are driven, switched or being stopped; they have to be stopped when the page closes.
    pub(crate) fn active_motors(&self) -> impl Iterator<Item = &MotorStatus> {
        let live = !self.is_recording();
        self.motors
            .iter()
            .filter(move |motor| live && is_active(motor))
    }

    /// Motors that turn, or draw a current, though nothing here drives them.
    pub(crate) fn turning_unasked(&self) -> impl Iterator<Item = &MotorStatus> {
        let live = !self.is_recording();
        self.motors
            .iter()
            .filter(move |motor| live && motor.turns_unasked)
    }

    /// Motors that a raw frame, sent once, may have left running.
    pub(crate) fn left_by_raw_frame(&self) -> impl Iterator<Item = &MotorStatus> {
        let sent = |raw: RawStatus| !raw.running && raw.sent > 0 && is_hazardous(&raw.frame);
        let live = !self.is_recording() && self.raw.is_some_and(sent);
        let left = |motor: &&MotorStatus| motor.may_turn && motor.activity == Activity::Idle;
        self.motors.iter().filter(move |_| live).filter(left)
    }

    /// Whether anything is driven, or moves though nothing drives it.
    pub(crate) fn is_anything_driven(&self) -> bool {
        if self.is_recording() {
            return false;
        }
        let turns = |motor: &MotorStatus| {
            !motor.is_silent() && motor.speed.is_some_and(|(_, speed)| speed.rpm() != 0)
        };
        self.raw.is_some_and(|raw| raw.running)
            || self
                .motors
                .iter()
                .any(|motor| is_active(motor) || turns(motor) || motor.turns_unasked)
    }

    /// Whether no motor can move: none is driven, no job runs, and each motor on an open port answers and stands.
    pub(crate) fn is_known_to_rest(&self) -> bool {
        let port_is_closed = self.is_recording()
            || matches!(
                self.connection,
                Connection::Disconnected | Connection::Failed(_)
            );
        let is_lost =
            |motor: &MotorStatus| motor.may_turn || motor.last.is_some() && motor.is_silent();
        !self.is_anything_driven()
            && self.job.is_none()
            && (port_is_closed || !self.motors.iter().any(is_lost))
    }

    fn reading<T>(&self, (at, value): (Instant, T)) -> Reading<T> {
        let age = self.now.since(at);
        Reading { value, age }
    }

    fn last_reply(&self, id: MotorId) -> Option<Reading<Reply>> {
        let sample = self.motor(id)?.last?;
        Some(Reading {
            value: sample.reply,
            age: self.now.since(sample.at),
        })
    }

    pub(crate) fn speed(&self, id: MotorId) -> Option<Reading<Rpm>> {
        Some(self.reading(self.motor(id)?.speed?))
    }

    pub(crate) fn current(&self, id: MotorId) -> Option<Reading<Current>> {
        Some(self.reading(self.motor(id)?.current?))
    }

    /// Whether the unit of reported currents is certain. If not, the raw number is shown.
    pub(crate) fn is_current_certain(&self) -> bool {
        self.line
            .is_none_or(|line| line.model.spec().current.is_certain())
    }

    pub(crate) fn faults(&self, id: MotorId) -> Option<Reading<Faults>> {
        Some(self.last_reply(id)?.map(|reply| reply.faults))
    }

    pub(crate) fn mode(&self, id: MotorId) -> Option<Reading<Mode>> {
        Some(self.last_reply(id)?.map(|reply| reply.mode))
    }

    pub(crate) fn temperature(&self, id: MotorId) -> Option<Reading<Celsius>> {
        Some(self.reading(self.motor(id)?.temperature?))
    }

    /// The fine angle while it is recent, else the newer one.
    pub(crate) fn angle(&self, id: MotorId) -> Option<Reading<Angle>> {
        let fine = self.motor(id)?.position.map(|(at, position)| Reading {
            value: Angle::Fine(position),
            age: self.now.since(at),
        });
        let last = self.last_reply(id).and_then(|reading| {
            let angle = reading.value.detail.angle()?;
            Some(reading.map(|_| angle))
        });
        match (fine, last) {
            (Some(fine), _) if fine.is_fresh() => Some(fine),
            (Some(fine), Some(last)) if fine.age <= last.age => Some(fine),
            (fine, last) => last.or(fine),
        }
    }
}

pub(crate) fn is_active(motor: &MotorStatus) -> bool {
    !matches!(motor.activity, Activity::Idle)
}

/// Whether a stop for this reason stops all motors.
pub(crate) fn concerns_all(reason: StopReason) -> bool {
    !matches!(
        reason,
        StopReason::OneMotor | StopReason::Disconnect | StopReason::Job | StopReason::LeftDriven
    )
}

#[cfg(test)]
#[path = "snapshot_tests.rs"]
pub(crate) mod tests;
