//! The frequency response: gain and phase at one frequency after the other.
//!
//! Each point is measured with its own sine. What the motor was commanded is known exactly, as a value that is
//! held until the next frame; its part at the frequency is an integral. What it answered is known where a reply
//! came; its part is fitted to the replies by least squares, so that lost replies leave no gap to fill.

use std::f64::consts::TAU;

use super::{Point, least_squares::LeastSquares};

/// Fewest periods that are measured.
const PERIODS_MIN: f64 = 2.0;
/// Fewest replies a period; two would not tell the frequency from its mirror image.
const REPLIES_A_PERIOD_MIN: f64 = 4.0;
/// Largest part of replies that may be lost.
const LOST_MAX: f64 = 0.2;
/// Least coherence: below it more than a fifth of the power is something else than the sine.
const COHERENCE_MIN: f64 = 0.8;
/// Least amplitude of the answer, in steps of the report. Below half a step rounding hides or invents it.
const STEPS_MIN: f64 = 0.5;
/// A current this near its bound is at its bound.
const AT_BOUND: f64 = 0.98;

/// A wave whose sine is larger than half of its height by this has a flat top: one cut off at 0.9 has 1.07,
/// and one that is only rounded to a third of its amplitude 1.02.
const CUT_OFF: f64 = 1.06;

/// One sine of a setpoint and what was reported meanwhile.
#[derive(Clone, Copy, Debug)]
pub struct SineRun<'a> {
    /// Its frequency.
    pub hz: f64,
    /// From here on, when the motor follows evenly.
    pub from_s: f64,
    /// The end of the sine.
    pub to_s: f64,
    /// The setpoints, each from when the motor had heard it until the next.
    pub command: &'a [Point],
    /// The reported values with the times at which they were measured.
    pub response: &'a [Point],
    /// The reported current in A.
    pub amps: &'a [Point],
    /// The current at which the motor is at its bound, if that is known.
    pub amps_max: Option<f64>,
    /// Requests a second, of which some may have had no reply.
    pub request_hz: f64,
    /// The smallest difference that a reply can show: 1 for rpm.
    pub resolution: f64,
}

/// Gain and phase at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodePoint {
    /// The frequency.
    pub hz: f64,
    /// Answer to command, in dB.
    pub gain_db: f64,
    /// Of the answer against the command, in degrees: negative is behind. See [`unwrap_phases`].
    pub phase_deg: f64,
    /// The part of the answer's power that is this sine, 0 to 1.
    pub coherence: f64,
    /// Why the point does not count. It is shown as such, and nothing is put in its place.
    pub invalid: Option<Invalid>,
}

/// Why a point of a frequency response does not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Invalid {
    /// Fewer than two periods, or too few replies a period.
    TooShort,
    /// More than a fifth of the replies were lost.
    RepliesLost,
    /// The current was at its bound: the motor could not follow.
    Saturated,
    /// The sine was cut off at the range of the setpoint.
    Clipped,
    /// The answer is smaller than the steps of the report.
    TooSmall,
    /// Too much of the answer is something else than the sine.
    NotCoherent,
}

/// Measures one point.
#[must_use]
pub fn frequency_point(run: &SineRun<'_>) -> BodePoint {
    let invalid = |invalid| BodePoint {
        hz: run.hz,
        gain_db: f64::NAN,
        phase_deg: f64::NAN,
        coherence: f64::NAN,
        invalid: Some(invalid),
    };
    // Whole periods, so that the mean and other frequencies fall out; the last ones are the steadiest.
    let periods = ((run.to_s - run.from_s) * run.hz + 1e-6).floor();
    if periods < PERIODS_MIN {
        return invalid(Invalid::TooShort);
    }
    let to_s = run.to_s;
    let from_s = to_s - periods / run.hz;
    let within = |points: &[Point]| -> Vec<Point> {
        let inside = |point: &&Point| point.t_s >= from_s && point.t_s < to_s;
        points.iter().filter(inside).copied().collect()
    };
    let response = within(run.response);
    let replies = f64::from(u32::try_from(response.len()).unwrap_or(u32::MAX));
    if replies < periods * REPLIES_A_PERIOD_MIN {
        return invalid(Invalid::TooShort);
    }
    let omega = TAU * run.hz;
    let Some((input, is_clipped)) = input_phasor(run.command, omega, from_s, to_s) else {
        return invalid(Invalid::TooShort);
    };
    let Some((output, coherence)) = output_phasor(&response, omega, from_s) else {
        return invalid(Invalid::TooShort);
    };
    let (gain, phase) = ratio(output, input);
    let bound = run.amps_max.unwrap_or(f64::INFINITY) * AT_BOUND;
    let requests = run.request_hz * (to_s - from_s);
    let at_bound = within(run.amps)
        .iter()
        .any(|point| point.value.abs() >= bound);
    let invalid = if replies < requests * (1.0 - LOST_MAX) {
        Some(Invalid::RepliesLost)
    } else if at_bound {
        Some(Invalid::Saturated)
    } else if is_clipped {
        Some(Invalid::Clipped)
    } else if output.0.hypot(output.1) < STEPS_MIN * run.resolution {
        Some(Invalid::TooSmall)
    } else if coherence < COHERENCE_MIN {
        Some(Invalid::NotCoherent)
    } else {
        None
    };
    BodePoint {
        hz: run.hz,
        gain_db: 20.0 * gain.log10(),
        phase_deg: phase.to_degrees(),
        coherence,
        invalid,
    }
}

/// Adds whole turns so that no phase jumps by more than half a turn from the valid point before it.
pub fn unwrap_phases(points: &mut [BodePoint]) {
    let mut before = 0.0;
    for point in points.iter_mut().filter(|point| point.invalid.is_none()) {
        let turns = ((before - point.phase_deg) / 360.0).round();
        point.phase_deg += 360.0 * turns;
        before = point.phase_deg;
    }
}

/// Cosine and sine part of a value that is held from point to point, and whether the value is cut off.
fn input_phasor(
    command: &[Point],
    omega: f64,
    from_s: f64,
    to_s: f64,
) -> Option<((f64, f64), bool)> {
    let (mut cos_part, mut sin_part, mut covered_s) = (0.0, 0.0, 0.0);
    let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
    let ends = command.iter().skip(1).map(|next| next.t_s);
    let ends = ends.chain([f64::INFINITY]);
    for (point, end_s) in command.iter().zip(ends) {
        let (a, b) = (point.t_s.max(from_s), end_s.min(to_s));
        if b <= a {
            continue;
        }
        covered_s += b - a;
        let angle = |t_s: f64| omega * (t_s - from_s);
        cos_part += point.value * (angle(b).sin() - angle(a).sin()) / omega;
        sin_part += point.value * (angle(a).cos() - angle(b).cos()) / omega;
        least = least.min(point.value);
        greatest = greatest.max(point.value);
    }
    let long_s = to_s - from_s;
    if covered_s < 0.99 * long_s || greatest <= least {
        return None;
    }
    let phasor = (2.0 * cos_part / long_s, 2.0 * sin_part / long_s);
    let half = (greatest - least) / 2.0;
    Some((phasor, phasor.0.hypot(phasor.1) > CUT_OFF * half))
}

/// Cosine and sine part of samples, and the part of their power that these are.
fn output_phasor(response: &[Point], omega: f64, from_s: f64) -> Option<((f64, f64), f64)> {
    let mut whole = LeastSquares::<4>::new();
    let mut without = LeastSquares::<2>::new();
    for point in response {
        let t_s = point.t_s - from_s;
        let (sin, cos) = (omega * t_s).sin_cos();
        whole.add([cos, sin, 1.0, t_s], point.value);
        without.add([1.0, t_s], point.value);
    }
    let (fit, rest) = (whole.solve()?, without.solve()?);
    let coherence = if rest.squares > 0.0 {
        1.0 - fit.squares / rest.squares
    } else {
        0.0
    };
    let [cos, sin, ..] = fit.unknowns;
    Some(((cos, sin), coherence.clamp(0.0, 1.0)))
}

/// Size and angle of one phasor in another, the angle from minus a turn to 0.
fn ratio(output: (f64, f64), input: (f64, f64)) -> (f64, f64) {
    let size = output.0.hypot(output.1) / input.0.hypot(input.1);
    // a cos + b sin is behind the cosine by atan2(b, a).
    let behind = |phasor: (f64, f64)| phasor.1.atan2(phasor.0);
    let angle = behind(input) - behind(output);
    // Noise may put a phase of nothing a little in front.
    (size, (angle - 0.1).rem_euclid(TAU) - TAU + 0.1)
}
