//! An open line, as every command uses it.

use std::time::{Duration, Instant};

use motorlink_bus::{Command, Event, IdQueryOutcome};
use motorlink_driver::{Driver, Ender, Ending, Entry, Next, Options, Place, Status, VirtualLine};
use motorlink_protocol::MotorId;

use crate::{arguments::Global, failure::Failure, output::say, signed_id::SignedId, words};

/// How long to wait for an entry before looking at the clock again.
const STEP: Duration = Duration::from_millis(20);
/// Time for three ID queries.
const ID_QUERY_MIN: Duration = Duration::from_millis(300);

/// What to do where no motor answers.
pub const WIRING: &str = "Is the supply on? Is the ground joined? Swap A and B";

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
    /// Opens the line of these arguments, with what `change` changes. The signals that end a program end the driver.
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
                    say(format_args!("{text}"));
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
        self.driver.status().ok_or_else(|| {
            if self.ender.is_asked() {
                Failure::Interrupted
            } else {
                Failure::NotDone("this computer is too busy: the driver does not answer".to_owned())
            }
        })
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

    /// Waits until the motors have answered. Without `--id`, the motor is the only one that answers the ID query.
    ///
    /// # Errors
    /// One does not answer in time, or none or several answer.
    pub fn wait_for_motors(&mut self) -> Result<(), Failure> {
        if self.motors.is_empty() {
            let id = self.only_motor()?;
            self.driver.command(Command::Watch(id));
            self.motors.push(SignedId::straight(id));
        }
        let asked: Vec<MotorId> = self.motors.iter().map(|motor| motor.id).collect();
        let silent = |status: &Status| -> Vec<MotorId> {
            let answers =
                |id: &MotorId| status.motor(*id).is_some_and(|motor| motor.last.is_some());
            asked.iter().filter(|id| !answers(id)).copied().collect()
        };
        let ready = |status: &Status| {
            let is_known = status.line.is_some_and(|line| line.model_known);
            (is_known && silent(status).is_empty()).then_some(())
        };
        if self.wait_for(self.timeout, ready)?.is_none() {
            let status = self.status()?;
            let missing = words::ids(silent(&status));
            let others = status.motors.iter().filter(|motor| motor.last.is_some());
            let others = others
                .map(|motor| motor.id)
                .filter(|id| !asked.contains(id));
            let others: Vec<MotorId> = others.collect();
            return Err(Failure::NotDone(if others.is_empty() {
                format!("no reply from {missing}. {WIRING}, or find its ID: motorlink scan")
            } else {
                format!(
                    "no reply from {missing}, but from {}: use --id",
                    words::ids(others)
                )
            }));
        }
        // What was said before is not about what is asked for next.
        while let Happened::Entry(..) = self.next_within(Duration::ZERO)? {}
        Ok(())
    }

    /// The only motor that answers the ID query: that of the opened port, or one that is asked now.
    fn only_motor(&self) -> Result<MotorId, Failure> {
        let mut outcome = None;
        while let Happened::Entry(_, entry) = self.next_within(Duration::ZERO)? {
            outcome = id_query_ended(&entry).or(outcome);
        }
        let until = Instant::now() + self.timeout.max(ID_QUERY_MIN);
        loop {
            match outcome {
                Some(IdQueryOutcome::One(id)) => return Ok(id),
                Some(IdQueryOutcome::Garbled) => {
                    let text =
                        "several motors answer, or there is noise: use --id, or see motorlink scan";
                    return Err(Failure::NotDone(text.to_owned()));
                }
                // A stop of motors that an earlier program left running cancels it, and one without power may get it.
                Some(IdQueryOutcome::NoReply | IdQueryOutcome::Cancelled) | None => {
                    self.driver.command(Command::IdQuery);
                }
            }
            outcome = None;
            while outcome.is_none() {
                if Instant::now() >= until {
                    let text = format!("no motor answers. {WIRING}, or see motorlink scan");
                    return Err(Failure::NotDone(text));
                }
                if let Happened::Entry(_, entry) = self.next()? {
                    outcome = id_query_ended(&entry);
                }
            }
        }
    }

    /// Stops the motors, closes the port, and prints what the stop has shown. Each entry of the stop goes to `take`.
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

/// Opens the line, does `work` on it, and ends it whatever comes: the motors are stopped, and what the stop has shown is
/// printed.
///
/// # Errors
/// A standstill is not confirmed, which matters most, or `work` has failed.
pub fn on_line(
    global: &Global,
    ender: &Ender,
    change: impl FnOnce(&mut Options),
    work: impl FnOnce(&mut Connection) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut connection = Connection::open_with(global, ender, change)?;
    let worked = work(&mut connection);
    let stopped = connection.end_with(|_, _| Ok(()));
    most_serious(worked, stopped)
}

fn id_query_ended(entry: &Entry) -> Option<IdQueryOutcome> {
    match entry {
        Entry::Event(Event::IdQueryEnded(outcome)) => Some(*outcome),
        _ => None,
    }
}

/// The failure of a stop, if it has failed: then the other one is only printed.
pub fn most_serious(
    worked: Result<(), Failure>,
    stopped: Result<(), Failure>,
) -> Result<(), Failure> {
    match (worked, stopped) {
        (Err(worked), Err(stopped)) => {
            say(worked);
            Err(stopped)
        }
        (worked, stopped) => stopped.and(worked),
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
        say(words::of_stop(stop));
    }
    let failed = "motorlink itself has failed: please report it";
    if !ending.may_turn.is_empty() {
        let ids = words::ids(ending.may_turn.iter().copied());
        let failed = if ending.has_failed {
            format!(" ({failed})")
        } else {
            String::new()
        };
        return Err(Failure::NotDone(format!(
            "motors {ids} may turn: cut their power{failed}"
        )));
    }
    if ending.has_failed {
        return Err(Failure::NotDone(failed.to_owned()));
    }
    Ok(())
}

/// The motors of `--id`, or else all virtual ones. Empty if they are to be found.
fn motors(global: &Global) -> Vec<SignedId> {
    match global.virtual_motors {
        Some(count) if global.id.is_empty() => {
            let ids = (1..=count).flat_map(MotorId::new);
            ids.map(SignedId::straight).collect()
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

/// Whether an entry says that what was asked for was not done.
pub fn is_not_done(entry: &Entry) -> bool {
    matches!(
        entry,
        Entry::Refused { .. } | Entry::TooLate(_) | Entry::NotConnected(_)
    )
}
