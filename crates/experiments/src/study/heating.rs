//! The study of heating: a constant current into a wheel that a load holds back.

use motorlink_protocol::MotorId;

use super::{
    Parameter,
    spans::{follow, spans},
};
use crate::{
    analysis::{Heating, Point, Trace, heating},
    runner::Record,
    sequence::{CELSIUS_MAX, Condition, End, Quantity, Repeat, RunLimits, Sequence, Shape, Step},
};

/// The temperature is compared once in this time.
const PASS_S: f64 = 1.0;
/// The run is aborted this much above the temperature at which it ends.
const BEYOND_C: f64 = 3.0;

/// A constant current in the current loop. The wheel must be loaded: a free wheel gains speed until it reaches the
/// speed limit, and one that is blocked for five seconds trips the stall protection.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatingStudy {
    /// The motor.
    pub motor: MotorId,
    /// The current, in A.
    pub amps: f64,
    /// Maximal duration, in seconds.
    pub for_s: f64,
    /// It ends at this temperature, in deg C.
    pub celsius_max: f64,
    /// A faster wheel is not loaded: the run is aborted, in rpm.
    pub loaded_max_rpm: f64,
}

/// The figures of a winding that warms up.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatingFindings {
    /// The fit; `None` for fewer than six changes of the reported temperature.
    pub heating: Option<Heating>,
    /// The temperature in deg C, in seconds since the start of the run.
    pub celsius: Vec<Point>,
    /// Mean magnitude of the reported current, in A.
    pub amps: Option<f64>,
}

impl HeatingStudy {
    /// 1 A for ten minutes, up to 65 deg C, at less than 60 rpm.
    #[must_use]
    pub const fn of(motor: MotorId) -> Self {
        Self {
            motor,
            amps: 1.0,
            for_s: 600.0,
            celsius_max: 65.0,
            loaded_max_rpm: 60.0,
        }
    }

    pub(super) fn parameters(&mut self) -> Vec<Parameter<'_>> {
        let hottest = CELSIUS_MAX - BEYOND_C;
        vec![
            Parameter::real("amps", &mut self.amps, -2.7, 2.7),
            Parameter::real("for_s", &mut self.for_s, 60.0, 7200.0),
            Parameter::real("celsius_max", &mut self.celsius_max, 35.0, hottest),
            Parameter::real("loaded_max_rpm", &mut self.loaded_max_rpm, 10.0, 330.0),
        ]
    }

    pub(super) fn sequence(&self) -> Sequence {
        let shape = Shape::Step { to: self.amps };
        let pass = follow(self.motor, Quantity::Amps, shape, End::After(PASS_S));
        Sequence {
            name: "Heating".to_owned(),
            limits: RunLimits {
                rpm: Some(self.loaded_max_rpm),
                amps: None,
                celsius: Some(self.celsius_max + BEYOND_C),
            },
            steps: vec![Step::Repeat(Repeat {
                passes: crate::number::whole(self.for_s / PASS_S).max(1),
                until: Some(Condition::CelsiusAbove(self.celsius_max)),
                steps: vec![pass],
            })],
        }
    }

    pub(super) fn evaluate(&self, record: &Record) -> HeatingFindings {
        let trace = Trace::of(record, self.motor);
        let count = f64::from(u32::try_from(trace.amps.len()).unwrap_or(u32::MAX));
        let sum: f64 = trace.amps.iter().map(|point| point.value.abs()).sum();
        // A pause cools the winding, and no later value belongs to the same curve.
        let was_paused = spans(record).iter().any(|span| span.was_paused(PASS_S));
        HeatingFindings {
            heating: heating(&trace.celsius).filter(|_| !was_paused),
            celsius: trace.celsius,
            amps: (count > 0.0).then(|| sum / count),
        }
    }
}
