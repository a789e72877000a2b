//! A run that is kept: what was asked of which motors, and the record.
//!
//! | module | idea |
//! |---|---|
//! | `csv` | the record as a table |
//! | `figures` | the figures of a run as a table |
//! | `json` | the whole run as a file, and back |
//! | `outcome_names` | the outcome of a run as a name in its file |
//! | `report` | several runs as one HTML file |

mod csv;
mod figures;
mod json;
mod outcome_names;
mod report;
mod setpoint;

use motorlink_protocol::{Instant, MotorId, family::Model};

use nojson::RawJson;

pub use figures::{Cell, Row, figures, figures_to_csv, figures_to_json};
pub use json::{JsonError, run_from_json, run_to_json};
pub use report::{ReportRun, ReportTexts, report};

use crate::{
    runner::{Cause, End, Record},
    sequence::RunLimits,
    study::{Measured, Study},
};

pub use csv::record_to_csv;

/// The description of a run.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RunHeader {
    /// The number of the run: seconds since 1970 when it was armed, so that no other run has it.
    pub number: u32,
    /// Name for the user.
    pub name: String,
    /// The study, as [`Study::to_json`] writes it.
    pub study: String,
    /// Its motors with their names.
    pub motors: Vec<(MotorId, String)>,
    /// The model of the motors.
    pub model: String,
    /// The setup of the page as JSON.
    pub setup: String,
    /// The version of the page.
    pub page_version: String,
    /// When it began, in milliseconds since 1970.
    pub began_unix_ms: f64,
    /// The same moment on the clock of the worker; `None` until it is started.
    pub began: Option<Instant>,
    /// Setpoints per second to each motor.
    pub request_hz: f64,
    /// How it ended.
    pub outcome: Outcome,
    /// Size of the record in bytes, with the parts that could not be stored.
    pub bytes: u32,
}

/// How a kept run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Outcome {
    /// It has not ended.
    Running,
    /// So.
    Ended(End),
    /// The page was closed before it could note the end.
    PageClosed,
}

impl RunHeader {
    /// The study; `None` if another version of the page wrote it.
    #[must_use]
    pub fn study(&self) -> Option<Study> {
        Study::from_json(&self.study).ok()
    }

    /// How it was measured.
    #[must_use]
    pub fn measured(&self) -> Measured {
        let model = self.model.parse().unwrap_or(Model::Ddsm115);
        Measured::of(model, self.request_hz)
    }

    /// The limits that were in force: the lower of those of the page and of the sequence.
    #[must_use]
    pub fn limits(&self) -> RunLimits {
        let own = self.study().map(|study| study.sequence().limits);
        let own = own.unwrap_or_default();
        let setup = RawJson::parse(&self.setup).ok();
        let of_page = |name: &str, scale: f64| {
            let member = setup.as_ref()?.value().to_member(name).ok()?.optional()?;
            let number = member.as_number_str().ok()?.parse::<f64>().ok()?;
            Some(number / scale)
        };
        let lower = |own: Option<f64>, of_page: Option<f64>| match (own, of_page) {
            (Some(own), Some(of_page)) => Some(own.min(of_page)),
            (own, of_page) => own.or(of_page),
        };
        RunLimits {
            rpm: lower(own.rpm, of_page("speed_limit_rpm", 1.0)),
            amps: lower(own.amps, of_page("current_limit_ma", 1_000.0)),
            celsius: lower(own.celsius, of_page("temperature_limit_c", 1.0)),
        }
    }

    /// Whether data is missing if the stored parts have this size: a full disk leaves parts out.
    #[must_use]
    pub fn lacks_data(&self, stored: u64) -> bool {
        u64::from(self.bytes) > stored
    }

    /// An empty record of this run, for its parts.
    #[must_use]
    pub fn record(&self) -> Record {
        let mut record = Record::default();
        if let Some(began) = self.began {
            record.began(began);
        }
        if let Outcome::Ended(end) = self.outcome {
            record.ended(end);
        }
        record
    }
}

impl Outcome {
    /// Why it was aborted; `None` while it runs or if it finished.
    #[must_use]
    pub const fn cause(self) -> Option<Cause> {
        match self {
            Self::Running | Self::Ended(End::Finished { .. }) => None,
            Self::Ended(End::Aborted { cause, .. }) => Some(cause),
            Self::PageClosed => Some(Cause::TabClosed),
        }
    }
}
