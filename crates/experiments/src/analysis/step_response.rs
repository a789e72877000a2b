//! The step response: how a motor goes from one setpoint to another.

use super::{
    Point,
    crossing::{changes, first_reaching, last_outside},
    peak::highest,
    statistics::{Spread, spread},
    steady::{SETTLED, TREND_MAX, steady_value},
};

/// Motion begins at this part of the step.
const BEGINS: f64 = 0.01;
/// The rise is from the first to the second of these parts of the way to the steady value.
const RISE: (f64, f64) = (0.1, 0.9);
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
    /// The smallest difference that a reply can show: 1 for rpm.
    pub resolution: f64,
}

/// The figures of one step. A figure is `None` if the replies do not show it. A step that has not settled has only
/// latency and peaks: the others are parts of the way to a steady value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepFigures {
    /// Whether it has settled within the hold.
    pub settled: bool,
    /// Seconds from the setpoint to 1 % of the step.
    pub latency_s: Option<f64>,
    /// Seconds from 10 to 90 % of the way to the steady value.
    pub rise_s: Option<f64>,
    /// Overshoot beyond the steady value, as a part of the way.
    pub overshoot: Option<f64>,
    /// The largest deviation away from the steady value at the beginning, as a part of the way.
    pub wrong_way: Option<f64>,
    /// Seconds from the setpoint until it stays within 2 % of the way, or within the resolution of the report.
    pub settling_s: Option<f64>,
    /// The setpoint minus the steady value, in the unit of the setpoint.
    pub steady_error: Option<f64>,
    /// The extreme value in the direction of the step, in the unit of the setpoint.
    pub peak: Option<f64>,
    /// Seconds from the setpoint to the peak; `None` if it does not go beyond the steady value.
    pub peak_s: Option<f64>,
    /// The largest current magnitude, in A.
    pub peak_amps: Option<f64>,
}

/// Median and spread of each figure over repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSummary {
    /// Repeats that have settled. Only they have all figures.
    pub settled: usize,
    /// See [`StepFigures::latency_s`].
    pub latency_s: Option<Spread>,
    /// See [`StepFigures::rise_s`].
    pub rise_s: Option<Spread>,
    /// See [`StepFigures::overshoot`].
    pub overshoot: Option<Spread>,
    /// See [`StepFigures::wrong_way`].
    pub wrong_way: Option<Spread>,
    /// See [`StepFigures::settling_s`].
    pub settling_s: Option<Spread>,
    /// See [`StepFigures::steady_error`].
    pub steady_error: Option<Spread>,
    /// See [`StepFigures::peak`].
    pub peak: Option<Spread>,
    /// See [`StepFigures::peak_s`].
    pub peak_s: Option<Spread>,
    /// See [`StepFigures::peak_amps`].
    pub peak_amps: Option<Spread>,
}

/// The figures of one step.
#[must_use]
pub fn step_figures(run: &StepRun<'_>) -> StepFigures {
    let none = StepFigures {
        peak_amps: run
            .amps
            .iter()
            .map(|point| point.value.abs())
            .reduce(f64::max),
        ..StepFigures::default()
    };
    let step = run.to - run.from;
    if run.response.len() < REPLIES_MIN || step == 0.0 {
        return none;
    }
    // It is known where it starts, even if the first reply is already beyond it.
    let start = Point::new(run.at_s, run.from);
    let response: Vec<Point> = [start].iter().chain(run.response).copied().collect();
    let known = changes(&response);
    let steady = steady_value(start, run.response, &known, run.resolution);
    let way = steady.map_or(step, |steady| steady - run.from);
    let parts = |points: &[Point], scale: f64| -> Vec<Point> {
        let part = |point: &Point| Point::new(point.t_s, (point.value - run.from) / scale);
        points.iter().map(part).collect()
    };
    let known_parts = parts(&known, way);
    // A ramp with a lag begins with the square of the time, so its root is linear between two changes.
    let roots: Vec<Point> = known_parts
        .iter()
        .map(|point| Point::new(point.t_s, point.value.abs().sqrt() * point.value.signum()))
        .collect();
    let begins = first_reaching(&roots, (BEGINS * (step / way).abs()).sqrt());
    let since = |at_s: f64| at_s - run.at_s;
    let top = highest(&parts(&response, way));
    let moving = StepFigures {
        latency_s: begins.map(since),
        peak: top.map(|top| run.from + way * top.value),
        peak_s: top.map(|top| since(top.t_s)),
        ..none
    };
    let Some(steady) = steady else {
        return moving;
    };
    // Less than half a step of the report is not shown by it, and the steady value is known to its trend.
    let shown = |part: f64| part > TREND_MAX.max(run.resolution / way.abs() / 2.0);
    let over = top.filter(|top| shown(top.value - 1.0));
    let wrong = highest(&parts(&response, -way)).filter(|wrong| shown(wrong.value));
    let rise_s = first_reaching(&known_parts, RISE.0)
        .zip(first_reaching(&known_parts, RISE.1))
        .map(|(low_s, high_s)| high_s - low_s);
    let band = (SETTLED * way.abs()).max(run.resolution);
    StepFigures {
        settled: true,
        rise_s,
        overshoot: Some(over.map_or(0.0, |over| over.value - 1.0)),
        wrong_way: Some(wrong.map_or(0.0, |wrong| wrong.value)),
        settling_s: last_outside(&known, steady, band).map(since),
        steady_error: Some(run.to - steady),
        peak: Some(over.map_or(steady, |over| run.from + way * over.value)),
        peak_s: over.map(|over| since(over.t_s)),
        ..moving
    }
}

/// Median and spread of the figures over repeats, for example of one acceleration.
#[must_use]
pub fn step_summary(repeats: &[StepFigures]) -> StepSummary {
    let over = |figure: fn(&StepFigures) -> Option<f64>| spread(repeats.iter().filter_map(figure));
    StepSummary {
        settled: repeats.iter().filter(|it| it.settled).count(),
        latency_s: over(|it| it.latency_s),
        rise_s: over(|it| it.rise_s),
        overshoot: over(|it| it.overshoot),
        wrong_way: over(|it| it.wrong_way),
        settling_s: over(|it| it.settling_s),
        steady_error: over(|it| it.steady_error),
        peak: over(|it| it.peak),
        peak_s: over(|it| it.peak_s),
        peak_amps: over(|it| it.peak_amps),
    }
}
