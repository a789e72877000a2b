//! A run as the program that asks for it records it.

use motorlink_experiments::{
    kept::{Outcome, RunHeader},
    plan::{Fleet, Plan},
    runner::{Options, Phase, Record},
    sequence::SequenceError,
    study::{Findings, Study},
};
use motorlink_messages::runs::{FromRun, ToRun};
use motorlink_protocol::family::Model;

/// A run of a study on the motors of a fleet, from its check to its figures.
#[derive(Debug)]
pub struct RecordedRun {
    header: RunHeader,
    study: Study,
    fleet: Fleet,
    options: Options,
    plan: Plan,
    record: Record,
}

impl RecordedRun {
    /// Checks the study. Nothing moves. `unix_ms` is the time now, in milliseconds since 1970.
    ///
    /// # Errors
    /// [`SequenceError`] names the value that does not fit.
    pub fn new(
        study: Study,
        fleet: Fleet,
        model: Model,
        rate_hz: u16,
        unix_ms: u64,
    ) -> Result<Self, SequenceError> {
        study.check(&fleet)?;
        let sequence = study.sequence();
        let plan = Plan::new(&sequence, &fleet)?;
        let period = std::time::Duration::from_secs(1) / u32::from(rate_hz.max(1));
        let options = Options {
            period,
            stop_on_lost_focus: false,
            silent_steps: study.silent_steps(),
        };
        let motors = plan.motors().iter();
        let motors = motors.map(|motor| (motor.id, String::new()));
        let header = RunHeader {
            // A number until the year 2106.
            number: u32::try_from(unix_ms / 1_000).unwrap_or(u32::MAX),
            name: sequence.name,
            study: study.to_json(),
            motors: motors.collect(),
            model: model.to_string(),
            setup: "{}".to_owned(),
            page_version: env!("CARGO_PKG_VERSION").to_owned(),
            #[allow(
                clippy::cast_precision_loss,
                reason = "milliseconds fit for 285,000 years"
            )]
            began_unix_ms: unix_ms as f64,
            began: None,
            request_hz: f64::from(rate_hz),
            outcome: Outcome::Running,
            bytes: 0,
        };
        Ok(Self {
            header,
            study,
            fleet,
            options,
            plan,
            record: Record::default(),
        })
    }

    /// What will move, how far, and for how long.
    #[must_use]
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Arms the run. Nothing moves.
    #[must_use]
    pub fn arm(&self) -> ToRun {
        ToRun::Arm {
            run: self.header.number,
            sequence: self.study.sequence().to_json(),
            fleet: self.fleet.clone(),
            options: self.options,
        }
    }

    /// Starts the armed run: the wheels turn.
    #[must_use]
    pub const fn start(&self) -> ToRun {
        ToRun::Start {
            run: self.header.number,
        }
    }

    /// Records what the run says.
    pub fn take(&mut self, message: &FromRun) {
        match message {
            FromRun::State(state) if state.run == self.header.number => {
                if let (None, Some(began)) = (self.header.began, state.began) {
                    self.header.began = Some(began);
                    self.record.began(began);
                }
                if let Phase::Ended(end) = state.phase {
                    self.header.outcome = Outcome::Ended(end);
                    self.record.ended(end);
                }
            }
            FromRun::Part { run, part } if *run == self.header.number => {
                self.record.add_part(part.clone());
            }
            _ => {}
        }
    }

    /// What was asked of which motors, and how it ended.
    #[must_use]
    pub const fn header(&self) -> &RunHeader {
        &self.header
    }

    /// The study.
    #[must_use]
    pub const fn study(&self) -> &Study {
        &self.study
    }

    /// Setpoints and replies.
    #[must_use]
    pub const fn record(&self) -> &Record {
        &self.record
    }

    /// The figures; of an aborted run, those of what was measured.
    #[must_use]
    pub fn findings(&self) -> Findings {
        self.study.evaluate(&self.record, &self.header.measured())
    }
}
