//! The step response: how a motor goes from one setpoint to another.

use super::{
    Point,
    crossing::{changes, first_reaching, last_outside},
    statistics::{Spread, mean, spread},
};

/// Motion begins at this part of the step.
const BEGINS: f64 = 0.01;
/// The rise is from the first to the second of these parts of the step.
const RISE: (f64, f64) = (0.1, 0.9);
/// Settled means within this band, as a part of the step.
const SETTLED: f64 = 0.02;
/// The steady value is the average over this last part of the time.
const STEADY: f64 = 0.25;
/// Minimal number of replies.
const REPLIES_MIN: usize = 8;

/// One step of a setpoint, and the reports after it.
#[derive(Clone, Copy, Debug)]
pub struct StepRun<'a> {
    /// When the motor received the setpoint.
    pub at_s: f64,
    /// The value before.
    pub from: f64,
    /// The setpoint.
    pub to: f64,
    /// The reported value from the step on.
    pub response: &'a [Point],
    /// The reported current in A from the step on.
    pub amps: &'a [Point],
}

/// The figures of one step. A figure is `None` if the replies do not show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepFigures {
    /// Seconds from the setpoint to 1 % of the step.
    pub latency_s: Option<f64>,
    /// Seconds from 10 to 90 % of the way to the steady value.
    pub rise_s: Option<f64>,
    /// Overshoot beyond the steady value, as a part of the step.
    pub overshoot: Option<f64>,
    /// Seconds from the setpoint until it stays within 2 % of the step.
    pub settling_s: Option<f64>,
    /// The setpoint minus the steady value, in the unit of the setpoint.
    pub steady_error: Option<f64>,
    /// The largest current magnitude, in A.
    pub peak_amps: Option<f64>,
}

/// Median and spread of each figure over repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSummary {
    /// See [`StepFigures::latency_s`].
    pub latency_s: Option<Spread>,
    /// See [`StepFigures::rise_s`].
    pub rise_s: Option<Spread>,
    /// See [`StepFigures::overshoot`].
    pub overshoot: Option<Spread>,
    /// See [`StepFigures::settling_s`].
    pub settling_s: Option<Spread>,
    /// See [`StepFigures::steady_error`].
    pub steady_error: Option<Spread>,
    /// See [`StepFigures::peak_amps`].
    pub peak_amps: Option<Spread>,
}

/// The figures of one step.
#[must_use]
pub fn step_figures(run: &StepRun<'_>) -> StepFigures {
    let none = StepFigures {
        latency_s: None,
        rise_s: None,
        overshoot: None,
        settling_s: None,
        steady_error: None,
        peak_amps: run
            .amps
            .iter()
            .map(|point| point.value.abs())
            .reduce(f64::max),
    };
    let step = run.to - run.from;
    let ends = run.response.last().map(|last| last.t_s);
    let (Some(ends_s), true) = (ends, run.response.len() >= REPLIES_MIN && step != 0.0) else {
        return none;
    };
    // The steady value, as a part of the step.
    let tail_s = ends_s - (ends_s - run.at_s) * STEADY;
    let tail = run.response.iter().filter(|point| point.t_s >= tail_s);
    let Some(steady) = mean(tail.map(|point| (point.value - run.from) / step)) else {
        return none;
    };
    let steady_error = Some(step * (1.0 - steady));
    if steady <= RISE.0 {
        // It hardly moved, so there is no rise to measure.
        return StepFigures {
            steady_error,
            ..none
        };
    }
    let parts: Vec<Point> = changes(run.response)
        .into_iter()
        .map(|point| Point::new(point.t_s, (point.value - run.from) / step))
        .collect();
    let reaches = |part: f64| first_reaching(&parts, part, run.at_s);
    let rise_s = reaches(RISE.0 * steady)
        .zip(reaches(RISE.1 * steady))
        .map(|(low_s, high_s)| high_s - low_s);
    // A ramp with a lag begins with the square of the time, so its root is linear between two changes.
    let roots: Vec<Point> = parts
        .iter()
        .map(|point| Point::new(point.t_s, point.value.abs().sqrt() * point.value.signum()))
        .collect();
    let begins = first_reaching(&roots, BEGINS.sqrt(), run.at_s);
    let highest = parts.iter().map(|point| point.value).reduce(f64::max);
    let settles = last_outside(&parts, steady, SETTLED);
    StepFigures {
        latency_s: begins.map(|at_s| at_s - run.at_s),
        rise_s,
        overshoot: highest.map(|highest| (highest - steady).max(0.0)),
        // A value that leaves the band near the end has not settled.
        settling_s: settles
            .filter(|at_s| *at_s < tail_s)
            .map(|at_s| at_s - run.at_s),
        steady_error,
        ..none
    }
}

/// Median and spread of the figures over repeats, for example of one acceleration.
#[must_use]
pub fn step_summary(repeats: &[StepFigures]) -> StepSummary {
    let over = |figure: fn(&StepFigures) -> Option<f64>| spread(repeats.iter().filter_map(figure));
    StepSummary {
        latency_s: over(|it| it.latency_s),
        rise_s: over(|it| it.rise_s),
        overshoot: over(|it| it.overshoot),
        settling_s: over(|it| it.settling_s),
        steady_error: over(|it| it.steady_error),
        peak_amps: over(|it| it.peak_amps),
    }
}
