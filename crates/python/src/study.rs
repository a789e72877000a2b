//! An experiment on the line.

use std::{sync::Mutex, time::Duration};

use motorlink_bus::{Activity, MotorStatus};
use motorlink_command::library::{Connection, Failure, SignedId, assign, file_study, unix_ms};
use motorlink_driver::{Experiment, Progress};
use motorlink_experiments::{
    kept::{figures_to_json, record_to_csv, run_to_json},
    plan::Fleet,
    runner::End,
    study::{Study, StudyKind},
};
use motorlink_protocol::MotorId;
use motorlink_runs::RecordedRun;
use pyo3::FromPyObject;

use crate::{
    driving::STOP_MAX,
    heard::News,
    shared::{locked, take_all},
};

/// What is asked: the text of a file, or a study with its parameters.
#[derive(Debug, FromPyObject)]
pub enum Asked {
    /// A sequence or a study as JSON.
    Text(String),
    /// The name of a study, and parameters with their values.
    Study(String, Vec<(String, Vec<f64>)>),
}

impl Asked {
    fn study(&self, motor: MotorId) -> Result<Study, Failure> {
        match self {
            Self::Text(text) => file_study(text).map_err(|error| Failure::Usage(error.to_string())),
            Self::Study(name, parameters) => {
                let kind = StudyKind::ALL.iter().find(|kind| kind.field() == name);
                let Some(kind) = kind else {
                    return Err(Failure::Usage(format!("{name}: no such study")));
                };
                let mut study = Study::of(*kind, motor);
                for (name, values) in parameters {
                    assign(&mut study, name, values).map_err(Failure::Usage)?;
                }
                Ok(study)
            }
        }
    }
}

/// A run that is under way.
pub struct Running(Experiment);

/// How it ended if it was aborted, the figures as JSON, the run as JSON, its samples as CSV.
pub type Outcome = (Option<String>, String, String, String);

/// Arms and starts a run on these motors.
pub fn begin(
    connection: &Connection,
    asked: &Asked,
    motors: &[SignedId],
    rate_hz: u16,
) -> Result<Running, Failure> {
    let model = connection.driver.model();
    let mut fleet = Fleet::of(motors.iter().map(|motor| motor.id));
    fleet.rpm_max = model.spec().speed_rpm_max.into();
    let mirrored = motors.iter().filter(|motor| motor.mirror.is_mirrored());
    fleet.mirrored = mirrored.map(|motor| motor.id).collect();
    let first = motors.first().map_or(MotorId::FIRST, |motor| motor.id);
    let study = asked.study(first)?;
    let run = RecordedRun::new(study, fleet, model, rate_hz, next_number_ms())
        .map_err(|error| Failure::Usage(error.to_string()))?;
    // What was said before is not of this run, and the driver learns that the program is alive.
    take_all(connection, Duration::ZERO)?;
    // The motors of the run before are still being stopped.
    let is_stopping = |motor: &MotorStatus| matches!(motor.activity, Activity::Stopping { .. });
    connection.wait_for(STOP_MAX, |status| {
        (!status.motors.iter().any(is_stopping)).then_some(())
    })?;
    let mut experiment = Experiment::arm(&connection.driver, run);
    experiment.start(&connection.driver, &connection.status()?);
    Ok(Running(experiment))
}

impl Running {
    /// Goes on with what the run has said; returns the result at the end. Any call on the line may have taken the entry.
    pub fn step(
        &mut self,
        connection: &Connection,
        news: &Mutex<News>,
        within: Duration,
    ) -> Result<Option<Outcome>, Failure> {
        take_all(connection, within)?;
        loop {
            let entry = locked(news).take_run();
            let is_last = entry.is_none();
            let progress = self.0.take(&connection.driver, entry.as_ref());
            match progress.map_err(|refusal| Failure::NotDone(refusal.to_string()))? {
                Progress::Ended(End::Finished { .. }) => return Ok(Some(self.outcome(None))),
                Progress::Ended(End::Aborted { cause, .. }) => {
                    return Ok(Some(self.outcome(Some(cause.to_string()))));
                }
                Progress::Running(_) | Progress::Waiting if is_last => return Ok(None),
                Progress::Running(_) | Progress::Waiting => {}
            }
        }
    }

    /// Ends the run and stops its motors.
    pub fn abort(&self, connection: &Connection) {
        self.0.abort(&connection.driver);
    }

    fn outcome(&self, aborted: Option<String>) -> Outcome {
        let run = self.0.run();
        let figures = figures_to_json(run.header(), run.study(), &run.findings());
        let whole = run_to_json(run.header(), run.record());
        (aborted, figures, whole, record_to_csv(run.record()))
    }
}

/// The time now, or a second after that of the run before: their numbers are seconds.
fn next_number_ms() -> u64 {
    static LAST: Mutex<u64> = Mutex::new(0);
    let mut last = locked(&LAST);
    *last = unix_ms().max(*last + 1_000);
    *last
}
