//! The study of the step response.

use motorlink_protocol::{Acceleration, MotorId, family::Model};

use super::{
    Measured, Parameter,
    spans::{Span, accelerated, hold_rpm, ramp_rpm, spans},
};
use crate::{
    analysis::{
        FittedModel, Point, RPM_RESOLUTION, StepFigures, StepRun, StepSummary, Trace, step_figures,
        step_model, step_summary,
    },
    runner::Record,
    sequence::{End, Problem, Quantity, RunLimits, Sequence, SequenceError, Shape},
};

/// Maximal number of accelerations side by side: more curves are not told apart.
const ACCELERATIONS_MAX: usize = 6;
/// A motor gets slower by this much in a second: 120 rpm in 250 to 370 ms.
const FALL_RPM_PER_S: f64 = 300.0;
/// Behind the ramp the speed lags by 60 ms (measured on real units). It takes ten times that to end.
const LAG_S: f64 = 0.6;
/// A step is judged by the last quarter of its hold.
const BEFORE_TAIL: f64 = 0.75;
/// The last step goes to 0 rpm in this time.
const RUN_OUT_S: f64 = 1.0;

/// From one speed to another, several times, for one or more accelerations.
#[derive(Clone, Debug, PartialEq)]
pub struct StepStudy {
    /// The motor.
    pub motor: MotorId,
    /// The speed before the step, in rpm.
    pub from_rpm: f64,
    /// The speed of the step, in rpm.
    pub to_rpm: f64,
    /// Steps for each acceleration.
    pub repeats: u32,
    /// How long the speed of the step is kept.
    pub hold_s: f64,
    /// How long the speed before it is kept.
    pub rest_s: f64,
    /// The accelerations to compare.
    pub accelerations: Vec<Acceleration>,
}

/// The figures of a step response.
#[derive(Clone, Debug, PartialEq)]
pub struct StepFindings {
    /// The speed before the step, in rpm.
    pub from_rpm: f64,
    /// The speed of the step, in rpm.
    pub to_rpm: f64,
    /// One for each acceleration with a measured step.
    pub groups: Vec<StepGroup>,
    /// Steps that were paused or aborted. They have no figures.
    pub left_out: usize,
}

/// The steps of one acceleration.
#[derive(Clone, Debug, PartialEq)]
pub struct StepGroup {
    /// The acceleration.
    pub acceleration: Acceleration,
    /// Its steps in order of time.
    pub repeats: Vec<StepRepeat>,
    /// Median and spread of their figures.
    pub summary: StepSummary,
    /// A model of those that have settled; `None` if none has.
    pub model: Option<FittedModel>,
}

/// One step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepRepeat {
    /// When the motor received the step, in seconds since the start of the run.
    pub at_s: f64,
    /// The end of the hold.
    pub to_s: f64,
    /// Its figures.
    pub figures: StepFigures,
    /// Speed in rpm, in seconds since the motor received the step.
    pub rpm: Vec<Point>,
}

impl StepStudy {
    /// Five steps from 0 to 100 rpm at the motor's own acceleration.
    #[must_use]
    pub fn of(motor: MotorId) -> Self {
        Self {
            motor,
            from_rpm: 0.0,
            to_rpm: 100.0,
            repeats: 5,
            hold_s: 3.0,
            rest_s: 1.2,
            accelerations: vec![Acceleration::FASTEST],
        }
    }

    pub(super) fn parameters(&mut self) -> Vec<Parameter<'_>> {
        vec![
            Parameter::real("from_rpm", &mut self.from_rpm, -330.0, 330.0),
            Parameter::real("to_rpm", &mut self.to_rpm, -330.0, 330.0),
            Parameter::whole("repeats", &mut self.repeats, 1, 50),
            Parameter::real("hold_s", &mut self.hold_s, 0.5, 30.0),
            Parameter::real("rest_s", &mut self.rest_s, 0.5, 30.0),
        ]
    }

    pub(super) fn check(&self) -> Result<(), SequenceError> {
        // Less than this is less than ten steps of the report.
        const STEP_MIN_RPM: f64 = 10.0;
        let step = (self.to_rpm - self.from_rpm).abs();
        if step < STEP_MIN_RPM {
            let problem = Problem::Expected("a speed that differs by 10 rpm or more");
            return Err(SequenceError::at("to_rpm", problem));
        }
        let count = self.accelerations.len();
        if count == 0 || count > ACCELERATIONS_MAX {
            let problem = Problem::Expected("one to six accelerations");
            return Err(SequenceError::at("accelerations", problem));
        }
        Ok(())
    }

    /// How long the slowest acceleration takes to reach the speed of the step, in seconds.
    ///
    /// A motor of this model takes a time per rpm for each unit of acceleration, on the way to a higher speed. On the
    /// way down it takes none into account.
    #[must_use]
    pub fn ramp_s(&self, model: Model) -> f64 {
        let units = self.accelerations.iter().map(|it| it.byte().max(1));
        let units = f64::from(units.max().unwrap_or(1));
        let same_side = self.from_rpm * self.to_rpm > 0.0;
        let begins = if same_side { self.from_rpm.abs() } else { 0.0 };
        let faster = (self.to_rpm.abs() - begins).max(0.0);
        let us_per_rpm = f64::from(model.spec().acceleration_us_per_rpm);
        faster * units * us_per_rpm / 1e6
    }

    /// A hold that is long enough for the step to settle before its last quarter, to 0.1 s.
    #[must_use]
    pub fn hold_offered_s(&self, model: Model) -> f64 {
        let slower = (self.from_rpm - self.to_rpm).abs();
        let whole_s = self.ramp_s(model) + slower / FALL_RPM_PER_S + LAG_S;
        (whole_s / BEFORE_TAIL * 10.0).ceil() / 10.0
    }

    pub(super) fn sequence(&self) -> Sequence {
        let mut steps = Vec::new();
        for acceleration in &self.accelerations {
            for _ in 0..self.repeats {
                steps.push(hold_rpm(self.motor, self.from_rpm, self.rest_s));
                steps.push(accelerated(
                    self.motor,
                    Quantity::Rpm,
                    Shape::Step { to: self.to_rpm },
                    End::After(self.hold_s),
                    *acceleration,
                ));
            }
        }
        steps.push(ramp_rpm(self.motor, 0.0, RUN_OUT_S));
        Sequence {
            name: "Step response".to_owned(),
            limits: RunLimits::default(),
            steps,
        }
    }

    pub(super) fn evaluate(&self, record: &Record, measured: &Measured) -> StepFindings {
        let trace = Trace::with_airtime(record, self.motor, measured.airtime);
        let passes = usize::try_from(self.repeats).unwrap_or(usize::MAX);
        let mut groups: Vec<StepGroup> = Vec::new();
        let mut left_out = 0;
        // The steps are the odd rows of the sequence.
        let is_measured = |span: &&Span| span.step % 2 == 1 && !span.is_running;
        for span in spans(record).iter().filter(is_measured) {
            let Some(acceleration) = self.accelerations.get(span.step / 2 / passes.max(1)) else {
                continue;
            };
            let mut command = trace.command.iter();
            let received = command.find(|point| point.t_s >= span.from_s && point.t_s < span.to_s);
            let received = received.filter(|_| span.lasted(self.hold_s));
            let Some(received) = received else {
                left_out += 1;
                continue;
            };
            let repeat = self.repeat(&trace, received.t_s, span.to_s);
            match groups.last_mut() {
                Some(group) if group.acceleration == *acceleration => group.repeats.push(repeat),
                _ => groups.push(StepGroup {
                    acceleration: *acceleration,
                    repeats: vec![repeat],
                    summary: step_summary(&[]),
                    model: None,
                }),
            }
        }
        for group in &mut groups {
            let figures: Vec<StepFigures> =
                group.repeats.iter().map(|repeat| repeat.figures).collect();
            group.summary = step_summary(&figures);
            group.model = step_model(&self.parts(group));
        }
        StepFindings {
            from_rpm: self.from_rpm,
            to_rpm: self.to_rpm,
            groups,
            left_out,
        }
    }

    /// The settled repeats, as parts of the step.
    fn parts(&self, group: &StepGroup) -> Vec<Vec<Point>> {
        let part = |point: &Point| {
            let way = self.to_rpm - self.from_rpm;
            Point::new(point.t_s, (point.value - self.from_rpm) / way)
        };
        let repeats = group.repeats.iter();
        repeats
            .filter(|repeat| repeat.figures.settled)
            .map(|repeat| repeat.rpm.iter().map(part).collect())
            .collect()
    }

    fn repeat(&self, trace: &Trace, at_s: f64, to_s: f64) -> StepRepeat {
        let response = Trace::between(&trace.rpm, at_s, to_s);
        let figures = step_figures(&StepRun {
            at_s,
            from: self.from_rpm,
            to: self.to_rpm,
            response,
            amps: Trace::between(&trace.amps, at_s, to_s),
            resolution: RPM_RESOLUTION,
        });
        let since = |point: &Point| Point::new(point.t_s - at_s, point.value);
        StepRepeat {
            at_s,
            to_s,
            figures,
            rpm: response.iter().map(since).collect(),
        }
    }
}
