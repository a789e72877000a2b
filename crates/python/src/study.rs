//! An experiment on the line.

use std::time::Duration;

use motorlink_bus::{Activity, MotorStatus};
use motorlink_command::library::{
    Connection, Failure, Happened, SignedId, assign, file_study, unix_ms,
};
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

use crate::driving::STOP_MAX;

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
                let kind = StudyKind::ALL.into_iter().find(|kind| kind.field() == name);
                let Some(kind) = kind else {
                    return Err(Failure::Usage(format!("{name}: no such study")));
                };
                let mut study = Study::of(kind, motor);
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
    let run = RecordedRun::new(study, fleet, model, rate_hz, unix_ms())
        .map_err(|error| Failure::Usage(error.to_string()))?;
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
    /// Goes on for so long; returns the result at the end.
    pub fn step(
        &mut self,
        connection: &Connection,
        within: Duration,
    ) -> Result<Option<Outcome>, Failure> {
        let until = std::time::Instant::now() + within;
        while std::time::Instant::now() < until {
            let happened = connection.next()?;
            let entry = match &happened {
                Happened::Entry(_, entry) => Some(entry),
                Happened::Nothing => None,
            };
            let progress = self.0.take(&connection.driver, entry);
            let ended = match progress.map_err(|refusal| Failure::NotDone(refusal.to_string()))? {
                Progress::Ended(End::Finished { .. }) => None,
                Progress::Ended(End::Aborted { cause, .. }) => Some(cause.to_string()),
                Progress::Running(_) | Progress::Waiting => continue,
            };
            let run = self.0.run();
            let figures = figures_to_json(run.header(), run.study(), &run.findings());
            let whole = run_to_json(run.header(), run.record());
            return Ok(Some((ended, figures, whole, record_to_csv(run.record()))));
        }
        Ok(None)
    }
}
