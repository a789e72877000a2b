//! An open line of motors.

use std::{
    path::PathBuf,
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use motorlink_bus::Command;
use motorlink_command::library::{Connection, Failure, Global, change_id, only_motor, scan};
use motorlink_driver::{Ender, Ending};
use motorlink_protocol::{AssignableId, family::Model};
use pyo3::prelude::*;

use crate::{
    driving::{drive, stop},
    errors::{NotDone, exception},
    heard::News,
    reading::Reading,
    shared::{STEP, Shared, locked},
    study::{Asked, Outcome, begin},
    values::{Settings, bus_settings, id, invalid, setpoint, signed},
};

/// Motors with a fact about each, and motors.
type Stopped = (Vec<(u8, bool)>, Vec<u16>);

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
        let opened = py.detach(|| -> Result<(Connection, Arc<Mutex<News>>), Failure> {
            let mut connection = Connection::open_with(&global, &Ender::default(), |options| {
                options.settings = settings;
                options.tells_traffic = true;
                if let Some(ids) = virtual_ids {
                    let model = global.model.unwrap_or_default();
                    let line = motorlink_driver::VirtualLine::of(model, ids);
                    options.place = motorlink_driver::Place::Virtual(line);
                }
            })?;
            let news = Arc::new(Mutex::new(News::new(connection.driver.model())));
            let told = Arc::clone(&news);
            connection.listen(Box::new(move |heard| locked(&told).take(heard)));
            if !connection.motors.is_empty() {
                connection.wait_for_motors()?;
            }
            Ok((connection, news))
        });
        let (connection, news) = opened.map_err(|failure| exception(&failure))?;
        for motor in &connection.motors {
            locked(&news).mirrors.insert(motor.id, motor.mirror);
        }
        let line = Shared {
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
        locked(&self.0.news).mirrors.insert(motor.id, motor.mirror);
        self.0.on_mut(py, |connection| {
            connection.driver.command(Command::Watch(motor.id));
            let others = std::mem::replace(&mut connection.motors, vec![motor]);
            let waited = connection.wait_for_motors();
            connection.motors = others;
            connection.motors.retain(|other| other.id != motor.id);
            connection.motors.push(motor);
            waited
        })
    }

    /// The only motor that answers.
    fn only_motor(&self, py: Python<'_>) -> PyResult<u8> {
        self.0.on_mut(py, |connection| {
            if connection.motors.is_empty() {
                connection.wait_for_motors()?;
            }
            match connection.motors.as_slice() {
                [only] => Ok(only.id.get()),
                _ => Err(Failure::Usage(
                    "several motors are open: name one".to_owned(),
                )),
            }
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
        locked(&self.0.news).trouble = None;
        self.0.on(py, |connection| {
            connection.driver.command(Command::Release);
            Ok(())
        })
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
        self.0.on(py, |connection| {
            let found = scan(connection)?.found;
            // Bytes would be a bytes object in Python.
            Ok(found.into_iter().map(|id| id.get().into()).collect())
        })
    }

    /// Gives the only motor on the bus another ID, and verifies it. Returns the ID before.
    fn set_id(&self, py: Python<'_>, new: u8) -> PyResult<u8> {
        let new = AssignableId::new(id(new)?).map_err(invalid)?;
        self.0.on_mut(py, |connection| {
            let from = only_motor(connection)?;
            if from != new.id() {
                change_id(connection, from, new)?;
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

    /// Takes what has happened, for so long, and looks for Ctrl-C.
    fn wait(&self, py: Python<'_>, seconds: f64) -> PyResult<()> {
        let wait = Duration::try_from_secs_f64(seconds).map_err(invalid)?;
        let begun = Instant::now();
        loop {
            let left = wait.saturating_sub(begun.elapsed());
            self.0.pump(py, left.min(STEP))?;
            self.0.check()?;
            if begun.elapsed() >= wait {
                return Ok(());
            }
        }
    }

    /// From now on the readings of these motors are kept. Returns the number of the reader.
    fn begin_reading(&self, motors: Vec<u8>) -> PyResult<u32> {
        let ids = motors.into_iter().map(id).collect::<PyResult<Vec<_>>>()?;
        Ok(locked(&self.0.news).add_reader(ids))
    }

    /// The readings since the last call; waits so long for the first.
    fn take_readings(&self, py: Python<'_>, reader: u32, seconds: f64) -> PyResult<Vec<Reading>> {
        let wait = Duration::try_from_secs_f64(seconds).map_err(invalid)?;
        let begun = Instant::now();
        loop {
            let left = wait.saturating_sub(begun.elapsed());
            self.0.pump(py, left.min(STEP))?;
            self.0.check()?;
            let readings = locked(&self.0.news).take_readings(reader);
            if !readings.is_empty() || begun.elapsed() >= wait {
                return Ok(readings);
            }
        }
    }

    fn end_reading(&self, reader: u32) {
        locked(&self.0.news).remove_reader(reader);
    }

    /// The last reading of a motor.
    fn latest(&self, py: Python<'_>, motor: u8) -> PyResult<Option<Reading>> {
        let id = id(motor)?;
        self.0.pump(py, Duration::ZERO)?;
        Ok(locked(&self.0.news).latest(id))
    }

    /// What a person should know, since the last call.
    fn take_notes(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.0.pump(py, Duration::ZERO)?;
        Ok(locked(&self.0.news).notes.drain(..).collect())
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
        locked(&self.0.news).trouble = None;
        let mut running = self
            .0
            .on(py, |connection| begin(connection, &asked, &motors, rate_hz))?;
        loop {
            let ended = self.0.on(py, |connection| running.step(connection, STEP))?;
            py.check_signals()?;
            if let Some(result) = ended {
                return Ok(result);
            }
        }
    }

    /// Stops the motors and closes the line. Returns the motors of the last stop and whether each one stands, and the motors
    /// that may turn.
    fn close(&self, py: Python<'_>) -> PyResult<Stopped> {
        let connection = py.detach(|| locked(&self.0.connection).take());
        let Some(connection) = connection else {
            return Ok((Vec::new(), Vec::new()));
        };
        let (ending, recorded) = py.detach(|| connection.close(|_| ()));
        recorded.map_err(|failure| exception(&failure))?;
        let Ending {
            last_stop,
            may_turn,
            has_failed,
        } = ending;
        if has_failed {
            let text = "motorlink itself has failed: please report it";
            return Err(NotDone::new_err(text));
        }
        let motors = last_stop.map_or_else(Vec::new, |report| report.motors);
        let motors = motors.iter().map(|motor| (motor.id.get(), motor.confirmed));
        Ok((
            motors.collect(),
            may_turn.into_iter().map(|id| id.get().into()).collect(),
        ))
    }
}
