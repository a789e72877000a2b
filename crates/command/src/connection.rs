//! An open line, as every command uses it.

use std::time::{Duration, Instant};

use motorlink_bus::{Event, JobStatus, Mirror, MotorStatus, StopReason};
use motorlink_driver::{Driver, Ender, Ending, Entry, Next, Options, Place, Status, VirtualLine};
use motorlink_protocol::MotorId;

use crate::{
    arguments::{Global, SignedId},
    failure::Failure,
    words,
};

/// How long to wait for an entry before looking at the clock again.
const STEP: Duration = Duration::from_millis(20);

/// An open line with its motors. The motors are stopped when it is dropped.
pub struct Connection {
    pub driver: Driver,
    pub motors: Vec<SignedId>,
    ender: Ender,
    timeout: Duration,
}

/// What happened, beyond what is printed for every command.
pub enum Happened {
    /// An entry.
    Entry(motorlink_protocol::Instant, Entry),
    /// Nothing for a moment.
    Nothing,
}

impl Connection {
    /// Opens the line of these arguments. The signals that end a program end the driver.
    pub fn open(global: &Global, ender: &Ender) -> Result<Self, Failure> {
        Self::open_with(global, ender, |_| ())
    }

    /// The same, with other options.
    pub fn open_with(
        global: &Global,
        ender: &Ender,
        change: impl FnOnce(&mut Options),
    ) -> Result<Self, Failure> {
        let mut options = Options::at(place(global)?);
        options.model = global.model;
        let motors = motors(global);
        options.watch = motors.iter().map(|motor| motor.id).collect();
        options.ender = ender.clone();
        change(&mut options);
        let driver = Driver::open(options)?;
        Ok(Self {
            driver,
            motors,
            ender: ender.clone(),
            timeout: global.timeout,
        })
    }

    /// The next entry, if one comes within a moment. Prints what a person should know.
    ///
    /// # Errors
    /// [`Failure::Interrupted`] once the driver has ended.
    pub fn next(&self) -> Result<Happened, Failure> {
        self.next_within(STEP)
    }

    /// The same, within this time.
    pub fn next_within(&self, within: Duration) -> Result<Happened, Failure> {
        match self.driver.next(within) {
            Next::Entry(at, entry) => {
                if let Some(text) = words::of_entry(&entry) {
                    eprintln!("{text}");
                }
                Ok(Happened::Entry(at, entry))
            }
            Next::Nothing if self.ender.is_asked() => Err(Failure::Interrupted),
            Next::Nothing => Ok(Happened::Nothing),
            Next::Ended => Err(Failure::Interrupted),
        }
    }

    /// The state of the line now.
    pub fn status(&self) -> Result<Status, Failure> {
        self.driver.status().ok_or(Failure::Interrupted)
    }

    /// Waits until `found` returns a result. Returns `None` after `limit`.
    pub fn wait_for<T>(
        &self,
        limit: Duration,
        mut found: impl FnMut(&Status) -> Option<T>,
    ) -> Result<Option<T>, Failure> {
        let until = Instant::now() + limit;
        loop {
            if let Some(result) = found(&self.status()?) {
                return Ok(Some(result));
            }
            if Instant::now() >= until {
                return Ok(None);
            }
            self.next()?;
        }
    }

    /// Waits until the motors have answered and no stop of an earlier program runs. Without `--id`, the motor is the one
    /// that answers the ID query.
    ///
    /// # Errors
    /// One does not answer in time, or none or several answer.
    pub fn wait_for_motors(&mut self) -> Result<(), Failure> {
        let asked: Vec<MotorId> = self.motors.iter().map(|motor| motor.id).collect();
        let has_answered = |motor: &&MotorStatus| motor.last.is_some();
        let ready = |status: &Status| {
            let answered: Vec<MotorId> = status
                .motors
                .iter()
                .filter(has_answered)
                .map(|motor| motor.id)
                .collect();
            let all = asked.iter().all(|id| answered.contains(id)) && !answered.is_empty();
            let known = status.line.is_some_and(|line| line.model_known);
            (all && known && !is_stopping_first(status)).then_some(answered)
        };
        // A stop of what an earlier program left running takes as long as its window.
        let answered = self.wait_for(self.timeout + Duration::from_secs(3), |status| {
            ready(status).map(Ok).or_else(|| {
                let is_late = status.now.since(motorlink_protocol::Instant::ZERO)
                    > self.timeout + Duration::from_secs(1);
                (is_late && !is_stopping_first(status)).then_some(Err(()))
            })
        })?;
        if let Some(Ok(answered)) = answered {
            if self.motors.is_empty() {
                let unsigned = |id| SignedId {
                    id,
                    mirror: Mirror::Straight,
                };
                self.motors = answered.into_iter().map(unsigned).collect();
            }
            return Ok(());
        }
        let status = self.status()?;
        let answered: Vec<MotorId> = status
            .motors
            .iter()
            .filter(has_answered)
            .map(|motor| motor.id)
            .collect();
        let silent = asked.iter().filter(|id| !answered.contains(id)).copied();
        let silent: Vec<MotorId> = silent.collect();
        let missing = if silent.is_empty() {
            "motor".to_owned()
        } else {
            words::ids(silent)
        };
        let others = answered.iter().filter(|id| !asked.contains(id)).copied();
        let others: Vec<MotorId> = others.collect();
        Err(Failure::NotDone(if others.is_empty() {
            format!(
                "no reply from {missing}. Check the supply, swap A and B, or find its ID: motorlink scan"
            )
        } else {
            format!(
                "no reply from {missing}, but from {}: use --id",
                words::ids(others)
            )
        }))
    }

    /// Stops the motors, closes the port, and prints what the stop has shown.
    ///
    /// # Errors
    /// A standstill is not confirmed.
    pub fn end(self) -> Result<(), Failure> {
        self.end_with(|_, _| Ok(()))
    }

    /// The same. Each entry of the stop goes to `take`.
    ///
    /// # Errors
    /// A standstill is not confirmed, or `take` fails.
    pub fn end_with(
        self,
        mut take: impl FnMut(motorlink_protocol::Instant, &Entry) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        self.driver.begin_end();
        let mut taken = Ok(());
        loop {
            match self.driver.next(STEP) {
                Next::Entry(at, entry) if taken.is_ok() => taken = take(at, &entry),
                Next::Entry(..) | Next::Nothing => {}
                Next::Ended => break,
            }
        }
        report(&self.driver.end()).and(taken)
    }
}

/// Prints what a stop has shown.
///
/// # Errors
/// A standstill is not confirmed, or the driver has failed.
fn report(ending: &Ending) -> Result<(), Failure> {
    if let Some(stop) = &ending.last_stop
        && !stop.motors.is_empty()
    {
        eprintln!("{}", words::of_stop(stop));
    }
    if ending.has_failed {
        let text = "the driver has failed, which is a fault of motorlink. Please report it";
        return Err(Failure::NotDone(text.to_owned()));
    }
    if ending.may_turn.is_empty() {
        return Ok(());
    }
    let ids = words::ids(ending.may_turn.iter().copied());
    Err(Failure::NotDone(format!(
        "motors {ids} may turn: cut their power, or run `motorlink stop`"
    )))
}

/// Whether motors are being stopped before anything else.
fn is_stopping_first(status: &Status) -> bool {
    let stops =
        |motor: &MotorStatus| matches!(motor.activity, motorlink_bus::Activity::Stopping { .. });
    matches!(status.job, Some(JobStatus::Stopping)) || status.motors.iter().any(stops)
}

/// The motors of `--id`, or else all virtual ones. Empty if they are to be found.
fn motors(global: &Global) -> Vec<SignedId> {
    let unsigned = |id| SignedId {
        id,
        mirror: Mirror::Straight,
    };
    match global.virtual_motors {
        Some(count) if global.id.is_empty() => {
            (1..=count).flat_map(MotorId::new).map(unsigned).collect()
        }
        _ => global.id.clone(),
    }
}

fn place(global: &Global) -> Result<Place, Failure> {
    match (global.virtual_motors, &global.port) {
        (Some(_), Some(_)) => {
            let text = "--virtual has no port: leave out one of them";
            Err(Failure::Usage(text.to_owned()))
        }
        (Some(count), None) => {
            let ids = (1..=count).flat_map(MotorId::new);
            let model = global.model.unwrap_or_default();
            Ok(Place::Virtual(VirtualLine::of(model, ids)))
        }
        (None, Some(port)) => Ok(Place::Port(port.clone())),
        (None, None) => Ok(Place::OnlyAdapter),
    }
}

/// Whether an entry says that what was asked for does not happen, or has ended.
pub fn ends_drive(entry: &Entry) -> bool {
    match entry {
        Entry::Refused { .. } | Entry::TooLate(_) | Entry::NotConnected(_) => true,
        Entry::Event(Event::StopEnded(report)) => report.reason == StopReason::LeftDriven,
        Entry::Event(Event::StopBegan(reason)) => matches!(
            reason,
            StopReason::PageSilent | StopReason::ComputerSlept | StopReason::LoopDelayed
        ),
        Entry::Event(event) => matches!(
            event,
            Event::NotStarted { .. } | Event::Withdrawn { .. } | Event::OtherModel { .. }
        ),
        // What was driven is stopped when the port is back.
        Entry::PortLost { .. } | Entry::PortBack | Entry::NotRemembered => false,
    }
}
