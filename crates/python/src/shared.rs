//! The line as calls of several threads share it.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError, Weak},
    thread,
    time::Duration,
};

use motorlink_command::library::{Connection, Failure, Happened};
use motorlink_driver::Commander;
use motorlink_protocol::MotorId;
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
    /// `None` once it is closed.
    pub connection: Arc<Mutex<Option<Connection>>>,
    /// Stops motors while another call has the connection.
    pub commander: Commander,
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

    /// Takes the entries that are there, and waits this long for the first. The driver learns that the program is alive.
    pub fn pump(&self, py: Python<'_>, within: Duration) -> PyResult<()> {
        self.on(py, |connection| take_all(connection, within))?;
        // Another thread that waits for the line gets it.
        py.detach(thread::yield_now);
        py.check_signals()
    }

    /// What ended the drive of one of these motors without being asked to.
    pub fn check(&self, motors: &[MotorId]) -> PyResult<()> {
        raised(locked(&self.news).take_trouble(motors))
    }

    /// What ended any drive without being asked to.
    pub fn check_all(&self) -> PyResult<()> {
        raised(locked(&self.news).take_any_trouble())
    }

    /// Takes the entries on a thread of its own, so that motors are driven whatever the program does.
    pub fn keep_alive(&self) {
        // It must not be the last to have the line: then nobody would stop the motors.
        let connection = Arc::downgrade(&self.connection);
        let take = move || {
            let Some(connection) = Weak::upgrade(&connection) else {
                return false;
            };
            let guard = locked(&connection);
            match &*guard {
                Some(connection) => take_all(connection, Duration::ZERO).is_ok(),
                None => false,
            }
        };
        thread::spawn(move || {
            while take() {
                thread::sleep(PAUSE);
            }
        });
    }
}

/// A line that nobody closes is closed here, on the thread of the program: the motors are stopped first.
impl Drop for Shared {
    fn drop(&mut self) {
        let connection = locked(&self.connection).take();
        drop(connection);
    }
}

fn raised(trouble: Option<String>) -> PyResult<()> {
    trouble.map_or(Ok(()), |text| Err(NotDone::new_err(text)))
}

/// Takes the entries that are there, and waits this long for the first.
pub fn take_all(connection: &Connection, within: Duration) -> Result<(), Failure> {
    let mut wait = within;
    while let Happened::Entry(..) = connection.next_within(wait)? {
        wait = Duration::ZERO;
    }
    Ok(())
}
