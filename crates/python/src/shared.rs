//! The line as calls of several threads share it.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError, Weak,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use motorlink_command::library::{Connection, Failure, Happened};
use motorlink_driver::Commander;
use motorlink_protocol::MotorId;
use pyo3::prelude::*;

use crate::{
    errors::{exception, not_done},
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
    pub interrupt: Interrupt,
}

/// Ends the waits for a line.
#[derive(Clone, Default)]
pub struct Interrupt(pub Arc<AtomicBool>);

impl Interrupt {
    /// Ends the work that has the line now.
    pub fn raise(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    pub fn clear(&self) {
        self.0.store(false, Ordering::Relaxed);
    }

    /// Does work that waits for the line, and ends it by Ctrl-C. It has a thread of its own: the handler of a signal may
    /// close the line, and waits there until the work has left it.
    pub fn on_thread<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce() -> Result<T, Failure> + Send,
    ) -> PyResult<T> {
        thread::scope(|scope| {
            let caller = thread::current();
            let working = scope.spawn(move || {
                let done = work();
                caller.unpark();
                done
            });
            let mut raised = None;
            while !working.is_finished() {
                py.detach(|| thread::park_timeout(STEP));
                if raised.is_none() {
                    raised = py.check_signals().err();
                    if raised.is_some() {
                        self.raise();
                    }
                }
            }
            if raised.is_some() {
                self.clear();
            }
            let done = working.join();
            let done = done.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            raised.map_or_else(|| done.map_err(|failure| exception(&failure)), Err)
        })
    }
}

impl Shared {
    /// Does something on the line that may take long. Ctrl-C ends it.
    pub fn wait_on<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Connection) -> Result<T, Failure> + Send,
    ) -> PyResult<T> {
        let connection = &self.connection;
        self.interrupt
            .on_thread(py, || on_connection(connection, work))
    }

    /// Does something on the line, without the lock of the interpreter.
    pub fn on<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&Connection) -> Result<T, Failure> + Send,
    ) -> PyResult<T> {
        let work = |connection: &mut Connection| work(connection);
        let done = py.detach(|| on_connection(&self.connection, work));
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

fn on_connection<T>(
    connection: &Mutex<Option<Connection>>,
    work: impl FnOnce(&mut Connection) -> Result<T, Failure>,
) -> Result<T, Failure> {
    match &mut *locked(connection) {
        Some(connection) => work(connection),
        None => Err(Failure::Interrupted),
    }
}

fn raised(trouble: Option<String>) -> PyResult<()> {
    trouble.map_or(Ok(()), |text| Err(not_done(&text)))
}

/// Takes the entries that are there, and waits this long for the first.
pub fn take_all(connection: &Connection, within: Duration) -> Result<(), Failure> {
    let mut wait = within;
    while let Happened::Entry(..) = connection.next_within(wait)? {
        wait = Duration::ZERO;
    }
    Ok(())
}
