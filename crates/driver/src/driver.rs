//! The driver, as the program that opened it has it.

use std::{
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel, sync_channel},
    thread::{self, JoinHandle},
    time::Duration,
};

use motorlink_bus::Command;
use motorlink_messages::runs::ToRun;
use motorlink_protocol::{Instant, family::Model};

use crate::{
    computer::Computer,
    entry::{Entry, Status},
    inputs::{Given, Input, Told},
    latency::run_on_time,
    open_failure::OpenFailure,
    options::{Ending, Options},
    owner::Owner,
    this_computer::ThisComputer,
};

/// Entries that wait for the program: more than a second of them at 500 exchanges a second. A program that takes none for
/// a second stops the motors.
const ENTRIES_MAX: usize = 8192;
/// How long the thread may take to answer: it sleeps at most for as long as the reader of a port needs to end.
const ANSWER_MAX: Duration = Duration::from_secs(1);

/// Runs a driver on this thread and on this computer until it ends. [`Driver::open`] does it for the computer that the
/// process runs on.
pub fn run_on(computer: impl Computer, options: &Options) -> Ending {
    Owner::new(computer, options).run(options)
}

/// What [`Driver::next`] returns.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// An entry, and when it happened by the clock of the driver.
    Entry(Instant, Entry),
    /// Nothing happened within the time.
    Nothing,
    /// The driver has ended.
    Ended,
}

/// An open line of motors. The thread behind it stops the motors when this value is dropped.
#[derive(Debug)]
pub struct Driver {
    inputs: Sender<Given>,
    told: Receiver<Told>,
    model: Model,
    thread: Option<JoinHandle<Ending>>,
}

impl Driver {
    /// Opens the line. What an earlier driver left driven is stopped first. Starts no motor.
    ///
    /// # Errors
    /// [`OpenFailure`] says what to do.
    pub fn open(options: Options) -> Result<Self, OpenFailure> {
        let (inputs, received) = channel();
        let (tell, told) = sync_channel(ENTRIES_MAX);
        let (answer, opened) = sync_channel(1);
        options.ender.connect(&inputs);
        let to_self = inputs.clone();
        let run = move || {
            run_on_time();
            let folder = options.state_folder.clone();
            let computer = ThisComputer::new((to_self, received), tell, answer, folder);
            run_on(computer, &options)
        };
        let thread = thread::Builder::new().name("motorlink driver".to_owned());
        let thread = thread.spawn(run);
        let thread = thread.map_err(|error| OpenFailure::Io("driver".to_owned(), error))?;
        // It answers, or it has failed.
        match opened.recv().unwrap_or(Err(OpenFailure::Lost)) {
            Ok(model) => Ok(Self {
                inputs,
                told,
                model,
                thread: Some(thread),
            }),
            Err(failure) => {
                // It closes the port. Motors that it has not stopped stay in their file.
                let _: thread::Result<Ending> = thread.join();
                Err(failure)
            }
        }
    }

    /// The model of the line.
    #[must_use]
    pub const fn model(&self) -> Model {
        self.model
    }

    /// Gives a command. A refusal comes as an entry.
    pub fn command(&self, command: Command) {
        // A driver that has ended says so by the next entry.
        let _ = self.inputs.send(Input::Command(command).into());
    }

    /// Gives a message to the run of an experiment. Its answers come as [`Entry::Run`].
    pub fn run(&self, message: ToRun) {
        let _ = self.inputs.send(Input::Run(Box::new(message)).into());
    }

    /// The next entry, within this time. A program that drives calls this at least every half second: it tells the driver
    /// that the program is alive.
    #[must_use]
    pub fn next(&self, within: Duration) -> Next {
        let until = std::time::Instant::now() + within;
        loop {
            let left = until.saturating_duration_since(std::time::Instant::now());
            match self.told.recv_timeout(left) {
                Ok(Told::Ping) => {
                    let _ = self.inputs.send(Input::Alive.into());
                }
                Ok(Told::Entry(at, entry)) => return Next::Entry(at, entry),
                Err(RecvTimeoutError::Timeout) => return Next::Nothing,
                Err(RecvTimeoutError::Disconnected) => return Next::Ended,
            }
        }
    }

    /// The state of this moment; `None` if the driver has ended.
    #[must_use]
    pub fn status(&self) -> Option<Status> {
        let (answer, status) = sync_channel(1);
        self.inputs.send(Input::Status(answer).into()).ok()?;
        status.recv_timeout(ANSWER_MAX).ok()
    }

    /// Asks for the end. The entries of the stop still come, and [`Next::Ended`] after them.
    pub fn begin_end(&self) {
        let _ = self.inputs.send(Input::End.into());
    }

    /// Stops the motors, waits until they stand or the stop window has ended, and closes the port.
    #[must_use]
    pub fn end(mut self) -> Ending {
        self.close()
    }

    fn close(&mut self) -> Ending {
        self.begin_end();
        let ending = self.thread.take().map(JoinHandle::join);
        let failed = Ending {
            has_failed: true,
            ..Ending::default()
        };
        ending.map_or_else(Ending::default, |ending| ending.unwrap_or(failed))
    }

    /// Gives commands from other threads.
    #[must_use]
    pub fn commander(&self) -> Commander {
        Commander(self.inputs.clone())
    }

    #[cfg(test)]
    pub(crate) fn fail(&self, how: Input) {
        let _ = self.inputs.send(how.into());
    }
}

/// Gives commands to a driver from any thread.
#[derive(Clone, Debug)]
pub struct Commander(Sender<Given>);

impl Commander {
    /// See [`Driver::command`].
    pub fn command(&self, command: Command) {
        let _ = self.0.send(Input::Command(command).into());
    }

    /// See [`Driver::run`].
    pub fn run(&self, message: ToRun) {
        let _ = self.0.send(Input::Run(Box::new(message)).into());
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        self.close();
    }
}

#[cfg(test)]
#[path = "driver_tests.rs"]
mod tests;
