//! The study of inertia and friction: the current loop pushes the wheel and lets it coast.

use motorlink_protocol::MotorId;

use super::{
    Parameter,
    spans::{Span, follow, spans},
};
use crate::{
    analysis::{
        CoastDown, Estimate, Inertia, Point, Push, TORQUE_NM_PER_A, Trace, coast_down, inertia,
    },
    runner::Record,
    sequence::{Condition, End, Quantity, RunLimits, Sequence, Shape},
};

/// A wheel that does not reach its speed within this time does not turn freely.
const PUSH_MAX_S: f64 = 10.0;
/// Maximal time of a coast.
const COAST_MAX_S: f64 = 120.0;
/// A coast ends at this speed.
const ENDS_RPM: f64 = 2.0;
/// The speed limit of the run is this much above the speed: the wheel turns on until the reply has arrived.
const BEYOND_RPM: f64 = 60.0;
/// The current needs this time to reach its value: several electrical time constants of the winding.
const PUSH_SETTLE_S: f64 = 0.01;
/// The time until the current of a push has ended.
const COAST_SETTLE_S: f64 = 0.02;
/// Minimal number of coasts whose spread gives the confidence.
const COASTS_MIN: usize = 4;
/// Each pass has a push, a coast, and both in the other direction.
const STEPS_A_PASS: usize = 4;

/// Pushes by a known current, each followed by a coast at 0 A, in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct CoastDownStudy {
    /// The motor.
    pub motor: MotorId,
    /// The current of the pushes, in A.
    pub push_amps: f64,
    /// The speed at which a coast begins, in rpm.
    pub speed_rpm: f64,
    /// Pushes in each direction.
    pub repeats: u32,
}

/// The figures of coasts and pushes.
#[derive(Clone, Debug, PartialEq)]
pub struct CoastDownFindings {
    /// Friction over inertia; `None` without a coast.
    pub coast: Option<CoastDown>,
    /// Inertia and friction; `None` for fewer than four pushes.
    pub inertia: Option<Inertia>,
    /// The speed of each coast in rpm, in seconds since it began.
    pub coasts: Vec<Vec<Point>>,
}

impl CoastDownStudy {
    /// Three pushes of 0.1 A to 120 rpm in each direction.
    #[must_use]
    pub const fn of(motor: MotorId) -> Self {
        Self {
            motor,
            push_amps: 0.1,
            speed_rpm: 120.0,
            repeats: 3,
        }
    }

    pub(super) fn parameters(&mut self) -> Vec<Parameter<'_>> {
        vec![
            Parameter::real("push_amps", &mut self.push_amps, 0.05, 2.0),
            Parameter::real("speed_rpm", &mut self.speed_rpm, 30.0, 250.0),
            Parameter::whole("repeats", &mut self.repeats, 2, 20),
        ]
    }

    pub(super) fn sequence(&self) -> Sequence {
        let step = |amps: f64, condition: Condition, within_s: f64| {
            let end = End::Until {
                condition,
                within_s,
            };
            follow(self.motor, Quantity::Amps, Shape::Step { to: amps }, end)
        };
        let push = |amps: f64| step(amps, Condition::RpmAbove(self.speed_rpm), PUSH_MAX_S);
        let coast = || step(0.0, Condition::RpmBelow(ENDS_RPM), COAST_MAX_S);
        let steps = (0..self.repeats).flat_map(|_| {
            let back = push(-self.push_amps);
            [push(self.push_amps), coast(), back, coast()]
        });
        Sequence {
            name: "Coast-down".to_owned(),
            limits: RunLimits {
                rpm: Some(self.speed_rpm + BEYOND_RPM),
                ..RunLimits::default()
            },
            steps: steps.collect(),
        }
    }

    pub(super) fn evaluate(&self, record: &Record) -> CoastDownFindings {
        let trace = Trace::of(record, self.motor);
        let spans = spans(record);
        let is_push = |span: &&Span| (span.step % STEPS_A_PASS).is_multiple_of(2);
        let coasts: Vec<&[Point]> = spans
            .iter()
            .filter(|span| !is_push(span))
            .map(|span| settled(&trace, span, COAST_SETTLE_S))
            .collect();
        let coast = coast_down(&coasts).map(|coast| by_spread(coast, &coasts));
        let pushes: Vec<Push<'_>> = spans
            .iter()
            .filter(is_push)
            .filter_map(|span| push_of(&trace, *span))
            .collect();
        CoastDownFindings {
            coast,
            inertia: coast.and_then(|coast| inertia(&pushes, &coast)),
            coasts: coasts.into_iter().map(since_its_start).collect(),
        }
    }
}

/// The confidence by the spread of the coasts, for as many of them as pushes: each is left out once (jackknife).
/// Within a coast the angle adds up the errors of all times before, so the errors of the fit are too small.
fn by_spread(coast: CoastDown, coasts: &[&[Point]]) -> CoastDown {
    let without = |left_out: usize| {
        let others = coasts.iter().enumerate();
        let others = others.filter(|(number, _)| *number != left_out);
        coast_down(&others.map(|(_, coast)| *coast).collect::<Vec<_>>())
    };
    if coasts.len() < COASTS_MIN {
        return coast;
    }
    let fits: Vec<CoastDown> = (0..coasts.len()).filter_map(without).collect();
    let spread = |estimate: Estimate, of: fn(&CoastDown) -> f64| {
        Estimate::by_jackknife(estimate.value, &fits.iter().map(of).collect::<Vec<_>>())
    };
    CoastDown {
        dry_rad_s2: spread(coast.dry_rad_s2, |fit| fit.dry_rad_s2.value),
        viscous_per_s: spread(coast.viscous_per_s, |fit| fit.viscous_per_s.value),
    }
}

/// The torque is that of the current on the wire, which has steps of 0.24 mA.
fn push_of(trace: &Trace, span: Span) -> Option<Push<'_>> {
    let command = trace.command.iter();
    let mut sent = command.filter(|point| point.t_s >= span.from_s && point.t_s < span.to_s);
    let first = sent.next()?;
    // Paused, it coasts.
    if sent.any(|later| later.value.total_cmp(&first.value).is_ne()) {
        return None;
    }
    Some(Push {
        torque_nm: first.value * TORQUE_NM_PER_A,
        speed: settled(trace, &span, PUSH_SETTLE_S),
    })
}

/// The speed from this time after the first reply on.
fn settled<'a>(trace: &'a Trace, span: &Span, settle_s: f64) -> &'a [Point] {
    let speed = Trace::between(&trace.rpm, span.from_s, span.to_s);
    let from_s = speed.first().map_or(0.0, |first| first.t_s) + settle_s;
    Trace::between(speed, from_s, span.to_s)
}

fn since_its_start(coast: &[Point]) -> Vec<Point> {
    let from_s = coast.first().map_or(0.0, |first| first.t_s);
    coast
        .iter()
        .map(|point| Point::new(point.t_s - from_s, point.value))
        .collect()
}
