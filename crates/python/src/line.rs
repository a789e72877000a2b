//! An open line of motors.

use std::{
    path::PathBuf,
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use motorlink_bus::Command;
use motorlink_command::library::{Connection, Failure, Global, change_id, only_motor, scan};
use motorlink_driver::{Ender, Ending};
use motorlink_protocol::{AssignableId, MotorId, family::Model};
use pyo3::prelude::*;

use crate::{
    driving::{drive, stop},
    heard::News,
    reading::Reading,
    shared::{Interrupt, STEP, Shared, locked},
    study::{Asked, Outcome, begin},
    values::{Settings, bus_settings, id, invalid, setpoint, signed},
};

/// An open line. The motors are stopped when it is closed or dropped.
#[pyclass(frozen)]
pub struct Line(Shared);

#[pymethods]
#[expect(
    clippy::needless_pass_by_value,
    reason = "Python's values are converted into these"
)]
impl Line {
    /// Opens a serial port, or virtual motors. What an earlier program left running is stopped first.
    #[staticmethod]
    #[expect(clippy::too_many_arguments, reason = "the Python side names them")]
    fn open(
        py: Python<'_>,
        port: Option<String>,
        model: Option<String>,
        ids: Vec<(u8, bool)>,
        virtual_motors: Option<Vec<u8>>,
        keepalive: bool,
        settings: Settings,
        timeout_s: f64,
    ) -> PyResult<Self> {
        let model = model.map(|name| name.parse::<Model>()).transpose();
        let ids = ids.into_iter().map(signed).collect::<PyResult<Vec<_>>>()?;
        let settings = bus_settings(settings)?;
        let global = Global {
            port,
            id: ids,
            model: model.map_err(invalid)?,
            virtual_motors: None,
            timeout: Duration::try_from_secs_f64(timeout_s).map_err(invalid)?,
        };
        let virtual_ids = virtual_motors
            .map(|ids| ids.into_iter().map(id).collect::<PyResult<Vec<_>>>())
            .transpose()?;
        let interrupt = Interrupt::default();
        let raised = Arc::clone(&interrupt.0);
        let opened = interrupt.on_thread(py, move || {
            let mut connection = Connection::open_with(&global, &Ender::default(), |options| {
                options.settings = settings;
                options.tells_traffic = true;
                if let Some(ids) = virtual_ids {
                    let model = global.model.unwrap_or_default();
                    let line = motorlink_driver::VirtualLine::of(model, ids);
                    options.place = motorlink_driver::Place::Virtual(line);
                }
            })?;
            let (model, now) = (connection.driver.model(), connection.status()?.now);
            let news = Arc::new(Mutex::new(News::new(model, now)));
            let told = Arc::clone(&news);
            connection.interrupt_by(raised);
            connection.listen(Box::new(move |heard| locked(&told).take(heard)));
            if !connection.motors.is_empty() {
                connection.wait_for_motors()?;
            }
            Ok((connection, news))
        });
        let (connection, news) = opened?;
        let line = Shared {
            interrupt,
            commander: connection.driver.commander(),
            connection: Arc::new(Mutex::new(Some(connection))),
            news,
        };
        if !keepalive {
            line.keep_alive();
        }
        Ok(Self(line))
    }

    /// The model of the motors.
    fn model(&self, py: Python<'_>) -> PyResult<String> {
        self.0.on(py, |connection| {
            Ok(connection.driver.model().spec().key.to_owned())
        })
    }

    /// Watches a motor, and waits for its first reply.
    fn watch(&self, py: Python<'_>, motor: (u8, bool)) -> PyResult<()> {
        let motor = signed(motor)?;
        self.0.wait_on(py, |connection| {
            connection.driver.command(Command::Watch(motor.id));
            let others = std::mem::replace(&mut connection.motors, vec![motor]);
            let waited = connection.wait_for_motors();
            connection.motors = others;
            let is_known = connection.motors.iter().any(|other| other.id == motor.id);
            match &waited {
                Ok(()) if !is_known => connection.motors.push(motor),
                Err(_) if !is_known => connection.driver.command(Command::Forget(motor.id)),
                _ => {}
            }
            waited
        })
    }

    /// The only motor that answers.
    fn only_motor(&self, py: Python<'_>) -> PyResult<u8> {
        self.0.wait_on(py, |connection| {
            let others = std::mem::take(&mut connection.motors);
            let waited = connection.wait_for_motors();
            let only = std::mem::replace(&mut connection.motors, others);
            waited?;
            let only = only.first().map(|motor| motor.id.get());
            only.ok_or_else(|| Failure::NotDone("no motor answers".to_owned()))
        })
    }

    /// Drives motors, or changes what is driven. Returns when all of them are driven.
    fn drive(
        &self,
        py: Python<'_>,
        motors: Vec<(u8, bool)>,
        quantity: &str,
        value: f64,
        acceleration: u8,
        high_current: bool,
    ) -> PyResult<()> {
        let motors = motors.into_iter().map(signed);
        let motors = motors.collect::<PyResult<Vec<_>>>()?;
        let setpoint = setpoint(quantity, value, acceleration)?;
        drive(&self.0, py, &motors, setpoint, high_current)
    }

    /// Stops these motors, or all. Returns which of them confirmed their standstill.
    fn stop(&self, py: Python<'_>, motors: Option<Vec<u8>>) -> PyResult<Vec<(u8, bool)>> {
        let ids = motors.map(|ids| ids.into_iter().map(id).collect::<PyResult<Vec<_>>>());
        stop(&self.0, py, ids.transpose()?.as_deref())
    }

    /// Allows driving again after all motors were stopped.
    fn release(&self, py: Python<'_>) -> PyResult<()> {
        // A driver that has missed the program for a second refuses until it hears of it.
        self.0.pump(py, Duration::ZERO)?;
        while locked(&self.0.news).take_any_trouble().is_some() {}
        self.0.on(py, |connection| {
            connection.status()?;
            connection.driver.command(Command::Release);
            connection.status().map(drop)
        })?;
        self.0.pump(py, Duration::ZERO)?;
        self.0.check_all()
    }

    /// Other settings from now on.
    fn configure(&self, py: Python<'_>, settings: Settings) -> PyResult<()> {
        let settings = bus_settings(settings)?;
        self.0.on(py, |connection| {
            connection.driver.command(Command::Configure(settings));
            Ok(())
        })
    }

    /// Asks every ID. Returns those that answer.
    fn scan(&self, py: Python<'_>) -> PyResult<Vec<u16>> {
        self.0.wait_on(py, |connection| {
            let scanned = scan(connection);
            cancel_if_interrupted(connection, &scanned);
            let found = scanned?.found;
            // Bytes would be a bytes object in Python.
            Ok(found.into_iter().map(|id| id.get().into()).collect())
        })
    }

    /// Gives the only motor on the bus another ID, and verifies it. Returns the ID before.
    fn set_id(&self, py: Python<'_>, new: u8) -> PyResult<u8> {
        let new = AssignableId::new(id(new)?).map_err(invalid)?;
        self.0.wait_on(py, |connection| {
            let from = only_motor(connection)?;
            if from != new.id() {
                let changed = change_id(connection, from, new);
                cancel_if_interrupted(connection, &changed);
                changed?;
            }
            connection.motors.retain(|motor| motor.id != from);
            Ok(from.get())
        })
    }

    /// Records the line to this session file, or ends the recording.
    fn record(&self, py: Python<'_>, file: Option<PathBuf>) -> PyResult<()> {
        self.0
            .on(py, |connection| connection.record(file.as_deref()))
    }

    /// Takes what happens for this many seconds, and looks for Ctrl-C.
    fn wait(&self, py: Python<'_>, seconds: f64) -> PyResult<()> {
        let wait = Duration::try_from_secs_f64(seconds).map_err(invalid)?;
        let begun = Instant::now();
        loop {
            let left = wait.saturating_sub(begun.elapsed());
            self.0.pump(py, left.min(STEP))?;
            self.0.check_all()?;
            if begun.elapsed() >= wait {
                return Ok(());
            }
        }
    }

    /// From now on the readings of these motors are kept. Returns the number of the reader.
    fn begin_reading(&self, motors: Vec<(u8, bool)>) -> PyResult<u32> {
        let motors = motors.into_iter().map(signed);
        let motors = motors.collect::<PyResult<Vec<_>>>()?;
        Ok(locked(&self.0.news).add_reader(motors))
    }

    /// The readings since the last call; waits this many seconds for the first.
    fn take_readings(&self, py: Python<'_>, reader: u32, seconds: f64) -> PyResult<Vec<Reading>> {
        let wait = Duration::try_from_secs_f64(seconds).map_err(invalid)?;
        let begun = Instant::now();
        loop {
            let left = wait.saturating_sub(begun.elapsed());
            self.0.pump(py, left.min(STEP))?;
            let (motors, readings) = locked(&self.0.news).take_readings(reader);
            self.0.check(&motors)?;
            if !readings.is_empty() || begun.elapsed() >= wait {
                return Ok(readings);
            }
        }
    }

    fn end_reading(&self, reader: u32) {
        locked(&self.0.news).remove_reader(reader);
    }

    /// The last reading of a motor, if it is at most half a second old.
    fn latest(&self, py: Python<'_>, motor: (u8, bool)) -> PyResult<Option<Reading>> {
        let motor = signed(motor)?;
        self.0.pump(py, Duration::ZERO)?;
        let now = self.0.on(py, |connection| Ok(connection.status()?.now))?;
        Ok(locked(&self.0.news).latest(motor, now))
    }

    /// What a person should know, since the last call.
    fn take_notes(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.0.pump(py, Duration::ZERO)?;
        Ok(locked(&self.0.news).take_notes())
    }

    /// Runs a sequence or a study. Returns how it ended if it was aborted, the figures as JSON, the whole run as JSON, and
    /// its samples as CSV.
    fn run(
        &self,
        py: Python<'_>,
        asked: Asked,
        motors: Vec<(u8, bool)>,
        rate_hz: u16,
    ) -> PyResult<Outcome> {
        let motors = motors.into_iter().map(signed);
        let motors = motors.collect::<PyResult<Vec<_>>>()?;
        let ids: Vec<MotorId> = motors.iter().map(|motor| motor.id).collect();
        self.0.pump(py, Duration::ZERO)?;
        self.0.check(&ids)?;
        let mut running = self.0.on(py, |connection| {
            while locked(&self.0.news).take_run().is_some() {}
            begin(connection, &asked, &motors, rate_hz)
        })?;
        loop {
            let news = &self.0.news;
            let ended = self
                .0
                .on(py, |connection| running.step(connection, news, STEP));
            let ended = ended.and_then(|ended| py.check_signals().map(|()| ended));
            match ended {
                Ok(None) => {}
                Ok(Some(result)) => {
                    // The result says why it was aborted.
                    let _ = locked(&self.0.news).take_trouble(&ids);
                    return Ok(result);
                }
                Err(error) => {
                    self.0.on(py, |connection| {
                        running.abort(connection);
                        Ok(())
                    })?;
                    return Err(error);
                }
            }
        }
    }

    /// Leaves the line to the process that has opened it: this one is its child.
    fn forget(&self) {
        if let Ok(mut connection) = self.0.connection.try_lock() {
            std::mem::forget(connection.take());
        }
    }

    /// Stops the motors and closes the line. Returns the motors of the last stop and whether each one stands, the motors
    /// that may turn, and what else went wrong.
    fn close(&self, py: Python<'_>) -> (Vec<(u8, bool)>, Vec<u16>, Option<String>) {
        // A wait that has the line ends.
        self.0.interrupt.raise();
        let connection = py.detach(|| locked(&self.0.connection).take());
        self.0.interrupt.clear();
        let Some(connection) = connection else {
            return (Vec::new(), Vec::new(), None);
        };
        let (ending, recorded) = py.detach(|| connection.close(|_| ()));
        let Ending {
            last_stop,
            may_turn,
            has_failed,
        } = ending;
        let failed = has_failed.then(|| "motorlink itself has failed: please report it".to_owned());
        let wrong = failed.or_else(|| recorded.err().map(|failure| failure.to_string()));
        let motors = last_stop.map_or_else(Vec::new, |report| report.motors);
        let motors = motors.iter().map(|motor| (motor.id.get(), motor.confirmed));
        let may_turn = may_turn.into_iter().map(|id| id.get().into());
        (motors.collect(), may_turn.collect(), wrong)
    }
}

/// Nobody waits for the job any more.
fn cancel_if_interrupted<T>(connection: &Connection, done: &Result<T, Failure>) {
    if matches!(done, Err(Failure::Interrupted)) {
        connection.driver.command(Command::CancelJob);
    }
}
