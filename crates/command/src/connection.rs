//! An open line, as every command uses it.

use std::{
    cell::{Cell, RefCell},
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use motorlink_bus::Event;
use motorlink_driver::{Driver, Ender, Ending, Entry, Next, Options, Status};

use crate::{
    arguments::Global,
    asked_line::{motors, place},
    failure::Failure,
    log::Log,
    output::say,
    recording::Recording,
    signed_id::SignedId,
    stop_report::{most_serious, report},
    words,
};

/// How long to wait for an entry before looking at the clock again.
const STEP: Duration = Duration::from_millis(20);

/// What to do where no motor answers.
pub const WIRING: &str = "Is the supply on? Is the ground joined? Swap A and B";

/// An open line with its motors. The motors are stopped when it is dropped.
pub struct Connection {
    /// The driver.
    pub driver: Driver,
    /// The motors of the command.
    pub motors: Vec<SignedId>,
    ender: Ender,
    pub(crate) timeout: Duration,
    recording: RefCell<Option<Recording>>,
    log: RefCell<Option<Log>>,
    listener: Option<RefCell<Listener>>,
    is_interrupted: Arc<AtomicBool>,
    /// Whether a scan runs, which says by its failure that another model answers.
    pub is_scanning: Cell<bool>,
}

/// Takes what happens on a line in place of the terminal.
pub type Listener = Box<dyn FnMut(Heard<'_>) + Send>;

/// What a listener takes.
pub enum Heard<'a> {
    /// An entry.
    Entry(motorlink_protocol::Instant, &'a Entry),
    /// What a person should know.
    Note(String),
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
    ///
    /// # Errors
    /// There is no such port, another program has it, or no motor answers as the model that is asked for.
    pub fn open_with(
        global: &Global,
        ender: &Ender,
        change: impl FnOnce(&mut Options),
    ) -> Result<Self, Failure> {
        let mut options = Options::at(place(global)?);
        options.model = global.model;
        let motors = motors(global)?;
        options.watch = motors.iter().map(|motor| motor.id).collect();
        options.ender = ender.clone();
        change(&mut options);
        let driver = Driver::open(options)?;
        Ok(Self {
            driver,
            motors,
            ender: ender.clone(),
            timeout: global.timeout,
            recording: RefCell::new(None),
            log: RefCell::new(None),
            listener: None,
            is_interrupted: Arc::default(),
            is_scanning: Cell::default(),
        })
    }

    /// While this is true, what waits for the line ends with [`Failure::Interrupted`].
    pub fn interrupt_by(&mut self, is_interrupted: Arc<AtomicBool>) {
        self.is_interrupted = is_interrupted;
    }

    /// From now on this listener takes what happens, and nothing is printed.
    pub fn listen(&mut self, listener: Listener) {
        self.listener = Some(RefCell::new(listener));
    }

    /// Records the line to this file until the end, or to none.
    ///
    /// # Errors
    /// The file exists or cannot be written, or the one before cannot be finished.
    pub fn record(&self, file: Option<&Path>) -> Result<(), Failure> {
        let new = match file {
            Some(file) => Some(Recording::create(file, self.status()?.now)?),
            None => None,
        };
        self.recording
            .replace(new)
            .map_or(Ok(()), Recording::finish)
    }

    /// Writes everything to session files in this folder from now on.
    ///
    /// # Errors
    /// The folder cannot be written, or the driver has ended.
    pub fn log_to(&self, folder: &Path) -> Result<(), Failure> {
        let (now, model) = (self.status()?.now, self.driver.model());
        self.log.replace(Some(Log::begin(folder, now, model)?));
        Ok(())
    }

    /// Says something to the person.
    pub fn note(&self, text: String) {
        match &self.listener {
            Some(listener) => (listener.borrow_mut())(Heard::Note(text)),
            None => say(text),
        }
    }

    /// Whether the terminal shows what is under way.
    pub const fn shows_progress(&self) -> bool {
        self.listener.is_none()
    }

    /// Records an entry, and tells it.
    fn hear(&self, at: motorlink_protocol::Instant, entry: &Entry) -> Result<(), Failure> {
        if let Some(listener) = &self.listener {
            (listener.borrow_mut())(Heard::Entry(at, entry));
        }
        if let Some(log) = &mut *self.log.borrow_mut() {
            log.add(at, entry);
        }
        let mut recording = self.recording.borrow_mut();
        let recorded = recording
            .as_mut()
            .map_or(Ok(()), |recording| recording.add(at, entry));
        if recorded.is_err() {
            // It fails once.
            *recording = None;
        }
        match (&self.listener, recorded) {
            // A program learns it by its listener, and drives on.
            (Some(_), Err(failure)) => {
                self.note(format!("the recording has ended: {failure}"));
                Ok(())
            }
            (_, recorded) => recorded,
        }
    }

    /// The next entry, if one comes within a moment. Prints what a person should know.
    ///
    /// # Errors
    /// [`Failure::Interrupted`] once the driver has ended, or where another thread has interrupted the wait.
    pub fn next(&self) -> Result<Happened, Failure> {
        self.next_within(STEP)
    }

    /// The same, within this time.
    ///
    /// # Errors
    /// As [`Connection::next`].
    pub fn next_within(&self, within: Duration) -> Result<Happened, Failure> {
        if self.is_interrupted.load(Ordering::Relaxed) {
            return Err(Failure::Interrupted);
        }
        match self.driver.next(within) {
            Next::Entry(at, entry) => {
                let is_said_later = self.is_scanning.get()
                    && matches!(entry, Entry::Event(Event::OtherModel { .. }));
                if let Some(text) = words::of_entry(&entry).filter(|_| !is_said_later) {
                    self.note(text);
                }
                self.hear(at, &entry)?;
                Ok(Happened::Entry(at, entry))
            }
            Next::Nothing if self.ender.is_asked() => Err(Failure::Interrupted),
            Next::Nothing => Ok(Happened::Nothing),
            Next::Ended => Err(Failure::Interrupted),
        }
    }

    /// Whether Ctrl-C or a signal has ended the program.
    ///
    /// # Errors
    /// It has.
    pub fn check_not_ended(&self) -> Result<(), Failure> {
        if self.ender.is_asked() {
            return Err(Failure::Interrupted);
        }
        Ok(())
    }

    /// The state of the line now.
    ///
    /// # Errors
    /// The driver has ended, or does not answer.
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
    ///
    /// # Errors
    /// As [`Connection::next`].
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

    /// Stops the motors, closes the port, and prints what the stop has shown. Each entry of the stop goes to `take`.
    ///
    /// # Errors
    /// A standstill is not confirmed, or the recording cannot be finished.
    pub fn end_with(self, take: impl FnMut(&Entry)) -> Result<(), Failure> {
        let (ending, recorded) = self.close(take);
        most_serious(recorded, report(&ending))
    }

    /// Stops the motors, closes the port, and finishes the recording.
    pub fn close(self, mut take: impl FnMut(&Entry)) -> (Ending, Result<(), Failure>) {
        self.driver.begin_end();
        let mut recorded = Ok(());
        loop {
            match self.driver.next(STEP) {
                Next::Entry(at, entry) => {
                    take(&entry);
                    if recorded.is_ok() {
                        recorded = self.hear(at, &entry);
                    }
                }
                Next::Nothing => {}
                Next::Ended => break,
            }
        }
        if let Some(log) = self.log.take() {
            log.finish();
        }
        let finished = self.recording.take().map_or(Ok(()), Recording::finish);
        (self.driver.end(), recorded.and(finished))
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
    change: impl Fn(&mut Options),
    mut work: impl FnMut(&mut Connection) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut found = None;
    loop {
        let mut connection = Connection::open_with(global, ender, |options| {
            change(options);
            options.model = found.or(options.model);
        })?;
        let takes_other_model = global.model.is_none() && found.is_none();
        let worked = work(&mut connection);
        let stopped = connection.end_with(|_| ());
        match worked {
            // Several motors reply to the ID query at once, so that only a scan shows their model.
            Err(Failure::OtherModel(model)) if takes_other_model => {
                stopped?;
                found = Some(model);
            }
            worked => return most_serious(worked, stopped),
        }
    }
}

/// Whether an entry says that what was asked for was not done.
pub fn is_not_done(entry: &Entry) -> bool {
    matches!(
        entry,
        Entry::Refused { .. } | Entry::TooLate(_) | Entry::NotConnected(_)
    )
}
