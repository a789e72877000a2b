//! The line as calls of several threads share it.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::Duration,
};

use motorlink_command::library::{Connection, Failure, Happened};
use pyo3::prelude::*;

use crate::{
    errors::{NotDone, exception},
    heard::News,
};

/// How long a call waits for an entry before it looks for Ctrl-C.
pub const STEP: Duration = Duration::from_millis(20);
/// A thread that keeps the line going leaves the lock for so long, so that calls get it.
const PAUSE: Duration = Duration::from_millis(1);

/// The lock, also after a panic of another thread: the driver stops the motors by itself.
pub fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// An open line, and what the program has not taken yet.
pub struct Shared {
    pub connection: Arc<Mutex<Option<Connection>>>,
    pub news: Arc<Mutex<News>>,
}

impl Shared {
    /// Does something on the line, without the lock of the interpreter.
    pub fn on<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&Connection) -> Result<T, Failure> + Send,
    ) -> PyResult<T> {
        self.on_mut(py, |connection| work(connection))
    }

    pub fn on_mut<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Connection) -> Result<T, Failure> + Send,
    ) -> PyResult<T> {
        let done = py.detach(|| match &mut *locked(&self.connection) {
            Some(connection) => work(connection),
            None => Err(Failure::Interrupted),
        });
        done.map_err(|failure| exception(&failure))
    }

    /// Takes the entries that are there, and waits so long for the first. The driver learns that the program is alive.
    pub fn pump(&self, py: Python<'_>, within: Duration) -> PyResult<()> {
        self.on(py, |connection| take_all(connection, within))?;
        py.check_signals()
    }

    /// What ended a drive without being asked to.
    pub fn check(&self) -> PyResult<()> {
        match locked(&self.news).trouble.take() {
            Some(text) => Err(NotDone::new_err(text)),
            None => Ok(()),
        }
    }

    /// The motors of the stops that have ended, and whether each one stands.
    pub fn stopped(&self) -> Vec<(u8, bool)> {
        let news = locked(&self.news);
        let motors = news.stops.iter().flat_map(|report| &report.motors);
        motors
            .map(|motor| (motor.id.get(), motor.confirmed))
            .collect()
    }

    /// Takes the entries on a thread of its own, so that motors are driven whatever the program does.
    pub fn keep_alive(&self) {
        let connection = Arc::clone(&self.connection);
        let take = move || match &*locked(&connection) {
            Some(connection) => take_all(connection, Duration::ZERO).is_ok(),
            None => false,
        };
        thread::spawn(move || {
            while take() {
                thread::sleep(PAUSE);
            }
        });
    }
}

fn take_all(connection: &Connection, within: Duration) -> Result<(), Failure> {
    let mut wait = within;
    while let Happened::Entry(..) = connection.next_within(wait)? {
        wait = Duration::ZERO;
    }
    Ok(())
}
