//! The study of what a motor does when drive frames cease.

use motorlink_protocol::{FRAME_AIRTIME, Instant, MotorId};

use super::spans::{Span, hold_rpm, spans};
use crate::{
    analysis::{Point, Silence, Trace, WhenSilent, keeps, median},
    runner::{Record, SilentStep, SilentSteps, Withheld},
    sequence::{RunLimits, Sequence},
};

/// Slow, so that a wheel that keeps turning is easy to catch, and ten times what a wheel at rest may report.
const RPM: f64 = 30.0;
/// The wheel reaches its speed and holds it.
const DRIVEN_S: f64 = 2.0;
/// The speed before a silence is that of this time.
const BEFORE_S: f64 = 0.5;
/// How long frames cease. Five missed frames at 50 Hz are 0.1 s; a firmware may wait longer than this.
pub const SILENT_S: f64 = 0.6;
/// After the silence without queries: the time to read the speed.
const READ_S: f64 = 0.2;
/// The speed without queries is the first that is read within this time: a coasting wheel loses nothing that matters.
const READ_WITHIN_S: f64 = 0.15;
/// How much of a curve is shown beyond the silence.
const AFTER_S: f64 = 0.3;
/// A speed from two angles needs them this far apart: an encoder count of 0.088 degrees in 40 ms is 0.4 rpm. Farther
/// apart than the other time, a reply is missing.
const ANGLES_S: (f64, f64) = (0.04, 0.1);

/// The points of it.
const READ_POINTS: usize = 3;
/// A rpm in degrees per second.
const DEG_S_PER_RPM: f64 = 6.0;

/// The steps of the sequence.
const ASKED: usize = 1;
const UNASKED: usize = 3;
const READ: usize = 4;
const STEPS: [usize; 3] = [ASKED, UNASKED, READ];

/// The wheel turns at 30 rpm. Drive frames cease for 0.6 s while queries go on, and then once more without queries.
#[derive(Clone, Debug, PartialEq)]
pub struct SilenceStudy {
    /// The motor.
    pub motor: MotorId,
}

/// What the motor did.
#[derive(Clone, Debug, PartialEq)]
pub struct SilenceFindings {
    /// What it does within [`SILENT_S`]; `None` if that was not measurable.
    pub result: Option<WhenSilent>,
    /// The speed before the silence with queries, and at its end, in rpm.
    pub asked_rpm: (Option<f64>, Option<f64>),
    /// The same without queries.
    pub unasked_rpm: (Option<f64>, Option<f64>),
    /// Speeds in rpm over seconds since the silence began, with queries and without.
    pub curves: [Vec<Point>; 2],
}

impl SilenceStudy {
    /// The study of this motor.
    #[must_use]
    pub const fn of(motor: MotorId) -> Self {
        Self { motor }
    }

    pub(super) fn sequence(&self) -> Sequence {
        let times = [DRIVEN_S, SILENT_S, DRIVEN_S, SILENT_S, READ_S];
        Sequence {
            name: "When frames cease".to_owned(),
            limits: RunLimits::default(),
            steps: times.map(|s| hold_rpm(self.motor, RPM, s)).to_vec(),
        }
    }

    /// The steps in which frames are withheld.
    pub(super) fn silent_steps() -> SilentSteps {
        let silent = |step, withheld| Some(SilentStep { step, withheld });
        SilentSteps([
            silent(ASKED, Withheld::DriveFrames),
            silent(UNASKED, Withheld::Requests),
            silent(READ, Withheld::DriveFrames),
        ])
    }

    pub(super) fn evaluate(&self, record: &Record) -> SilenceFindings {
        let spans = spans(record);
        let (speed, amps) = speeds_and_currents(record, self.motor, &spans);
        let silent = |step: usize| {
            let mut spans = spans.iter().copied();
            spans.find(|span| span.step == step && span.lasted(SILENT_S))
        };
        let (asked, unasked) = (silent(ASKED), silent(UNASKED));
        let of = |span: Span| Silence {
            before: Trace::between(&speed, span.from_s - BEFORE_S, span.from_s),
            speed: Trace::between(&speed, span.from_s, span.to_s),
            amps: Trace::between(&amps, span.from_s, span.to_s),
            to_s: span.to_s,
        };
        let curve = |span: Option<Span>| {
            let shown = span.map(|span| {
                let points = Trace::between(&speed, span.from_s, span.to_s + AFTER_S).iter();
                points.map(move |point| Point::new(point.t_s - span.from_s, point.value))
            });
            shown.into_iter().flatten().collect()
        };
        let curves = [curve(asked), curve(unasked)];
        let read = unasked.and_then(|span| {
            let read = Trace::between(&speed, span.to_s, span.to_s + READ_WITHIN_S);
            median(read.get(..READ_POINTS)?)
        });
        let (asked, unasked) = (asked.map(of), unasked.map(of));
        let asked_rpm = (
            asked.and_then(|silence| silence.speed_before()),
            asked.and_then(|silence| silence.speed_at_end()),
        );
        let unasked_rpm = (unasked.and_then(|silence| silence.speed_before()), read);
        let kept = unasked_rpm.0.zip(unasked_rpm.1);
        let kept = kept.map(|(before, after)| keeps(before, after));
        let asked = asked.and_then(|silence| silence.verdict());
        SilenceFindings {
            result: asked
                .zip(kept)
                .and_then(|(asked, kept)| result(asked, kept)),
            asked_rpm,
            unasked_rpm,
            curves,
        }
    }
}

/// The result of both silences. A motor that keeps its command while queries go on may still turn when a page fails, so
/// that is the result, whatever it does without them. The other way round is no behaviour of a firmware.
const fn result(asked: WhenSilent, kept_unasked: bool) -> Option<WhenSilent> {
    match (asked, kept_unasked) {
        (WhenSilent::Keeps, _) => Some(WhenSilent::Keeps),
        (_, true) => None,
        (falls, false) => Some(falls),
    }
}

/// Speeds and currents as reported, without direction. In a silence, a reply that has an angle and no temperature is an
/// odometry reply: it has neither, so the speed is that of the angles.
fn speeds_and_currents(
    record: &Record,
    motor: MotorId,
    spans: &[Span],
) -> (Vec<Point>, Vec<Point>) {
    let began = record.began_at().unwrap_or(Instant::ZERO);
    let time = |at: Instant| at.since(began).as_secs_f64() - FRAME_AIRTIME.as_secs_f64();
    let is_silent = |t_s: f64| {
        let mut spans = spans.iter();
        spans.any(|span| STEPS.contains(&span.step) && t_s >= span.from_s && t_s < span.to_s)
    };
    let (mut speeds, mut amps, mut angles) = (Vec::<Point>::new(), Vec::new(), Vec::<Point>::new());
    for sample in record.samples().iter().filter(|sample| sample.id == motor) {
        let t_s = time(sample.at);
        match sample.degrees {
            Some(degrees) if sample.celsius.is_none() && is_silent(t_s) => {
                angles.push(Point::new(t_s, degrees.into()));
            }
            _ => {
                speeds.extend(sample.rpm.map(|rpm| Point::new(t_s, f64::from(rpm).abs())));
                let told = sample
                    .current
                    .map(|current| f64::from(current.amps()).abs());
                amps.extend(told.map(|amps| Point::new(t_s, amps)));
            }
        }
    }
    let turned = angles.iter().filter_map(|point| {
        let apart = |before: &&Point| point.t_s - before.t_s >= ANGLES_S.0;
        let before = angles.iter().rev().find(apart)?;
        let seconds = point.t_s - before.t_s;
        let degrees = (point.value - before.value + 180.0).rem_euclid(360.0) - 180.0;
        let rpm = degrees.abs() / seconds / DEG_S_PER_RPM;
        let t_s = f64::midpoint(point.t_s, before.t_s);
        (seconds <= ANGLES_S.1).then_some(Point::new(t_s, rpm))
    });
    for point in turned {
        let place = speeds.partition_point(|speed| speed.t_s <= point.t_s);
        speeds.insert(place, point);
    }
    (speeds, amps)
}
