//! The frequency response: gain and phase at each frequency.
//!
//! Each point is measured with its own sine. The command is known exactly, as a value that is held until the next
//! frame; its phasor is an integral. The response is only known at the replies; its phasor is fitted to them by least
//! squares, so that lost replies need no interpolation.

use std::f64::consts::{PI, TAU};

use strum::IntoStaticStr;

use super::{Point, least_squares::LeastSquares};

/// Minimal number of measured periods.
const PERIODS_MIN: f64 = 2.0;
/// Minimal replies per period; with two, a frequency and its mirror image are indistinguishable.
const REPLIES_A_PERIOD_MIN: f64 = 4.0;
/// Maximal part of lost replies.
const LOST_MAX: f64 = 0.2;
/// Minimal R squared: below it more than a fifth of the power is not the sine.
const R_SQUARED_MIN: f64 = 0.8;
/// Minimal amplitude of the response, in steps of the report. Below half a step, rounding can hide or create it.
const STEPS_MIN: f64 = 0.5;
/// A current above this part of its bound counts as saturated.
const AT_BOUND: f64 = 0.98;

/// No motor answers later than this: half a second of silence ends a run.
const DELAY_MAX_S: f64 = 0.25;
/// The phase of the first point is within half a turn of this: rather a lag than a lead.
const FIRST_DEG: f64 = -90.0;
/// How exactly the lag of a point is known.
const PHASE_ERROR_DEG: f64 = 2.0;
/// Maximal change of a lag to the next point by dead time.
const TURN_CHANGE_MAX_DEG: f64 = 90.0;

/// One sine of a setpoint, and the reports during it.
#[derive(Clone, Copy, Debug)]
pub struct SineRun<'a> {
    /// Its frequency.
    pub hz: f64,
    /// The deviation to each side that was asked for.
    pub amplitude: f64,
    /// Start of the measurement, when the motor follows steadily.
    pub from_s: f64,
    /// The end of the sine.
    pub to_s: f64,
    /// The setpoints, each from the time at which the motor received it until the next.
    pub command: &'a [Point],
    /// The reported values with the times of their measurement.
    pub response: &'a [Point],
    /// The reported current in A.
    pub amps: &'a [Point],
    /// The current bound of the motor, if known.
    pub amps_max: Option<f64>,
    /// Requests per second, including those without a reply. See [`Trace::request_hz`](super::Trace::request_hz).
    pub request_hz: f64,
    /// The smallest difference that a reply can show: 1 for rpm.
    pub resolution: f64,
}

/// Gain and phase at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodePoint {
    /// The frequency.
    pub hz: f64,
    /// Response over command, in dB.
    pub gain_db: f64,
    /// Phase of the response against the command, in degrees: negative is a lag.
    pub phase_deg: f64,
    /// Whether the phase is known with its whole turns. See [`unwrap_phases`].
    pub turn_is_known: bool,
    /// The part of the response's power that the sine explains, 0 to 1.
    pub r_squared: f64,
    /// Start of the measured time, whole periods before its end. Seconds since the start of the run.
    pub from_s: f64,
    /// End of the measured time.
    pub to_s: f64,
    /// Why the point is invalid. It is shown as invalid and not replaced.
    pub invalid: Option<Invalid>,
}

/// Why a point of a frequency response is invalid. As a text it is the name in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum Invalid {
    /// Fewer than two periods, or too few replies a period.
    TooShort,
    /// More than a fifth of the replies were lost.
    RepliesLost,
    /// The current reached its bound, so the motor could not follow.
    Saturated,
    /// The sine was clipped at the range of the setpoint.
    Clipped,
    /// The response is smaller than the resolution of the report.
    TooSmall,
    /// Too much of the response is not the sine.
    Noisy,
}

/// Measures one point.
#[must_use]
pub fn frequency_point(run: &SineRun<'_>) -> BodePoint {
    let invalid = |invalid| BodePoint {
        hz: run.hz,
        gain_db: f64::NAN,
        phase_deg: f64::NAN,
        turn_is_known: false,
        r_squared: f64::NAN,
        from_s: run.from_s,
        to_s: run.to_s,
        invalid: Some(invalid),
    };
    // Whole periods, so that the mean and other frequencies cancel. The last ones are the steadiest.
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
    let Some((input, half)) = input_phasor(run.command, omega, from_s, to_s) else {
        return invalid(Invalid::TooShort);
    };
    let Some((output, r_squared)) = output_phasor(&response, omega, from_s) else {
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
    } else if half < run.amplitude - run.resolution {
        // Rounding alone takes less than one step.
        Some(Invalid::Clipped)
    } else if output.0.hypot(output.1) < STEPS_MIN * run.resolution {
        Some(Invalid::TooSmall)
    } else if r_squared < R_SQUARED_MIN {
        Some(Invalid::Noisy)
    } else {
        None
    };
    BodePoint {
        hz: run.hz,
        gain_db: 20.0 * gain.log10(),
        phase_deg: phase.to_degrees(),
        turn_is_known: false,
        r_squared,
        from_s,
        to_s,
        invalid,
    }
}

/// Adds the whole turns of the phases that are known.
///
/// A phase is measured up to whole turns. The first point has no turn if its frequency is so low that another turn
/// would be a longer delay than `DELAY_MAX_S`. From point to point, a dead time that explains the whole lag adds the
/// lag times the ratio of the frequencies less one. If that is more than a quarter of a turn, so that a second turn is
/// as likely as the nearest one, this turn and the later ones are unknown.
pub fn unwrap_phases(points: &mut [BodePoint]) {
    let mut before: Option<(f64, f64)> = None;
    let mut is_known = true;
    for point in points.iter_mut().filter(|point| point.invalid.is_none()) {
        let near = match before {
            None => {
                is_known = point.hz * DELAY_MAX_S <= 0.5;
                FIRST_DEG
            }
            Some((hz, phase_deg)) => {
                let lag_deg = phase_deg.abs() + PHASE_ERROR_DEG;
                is_known = is_known && lag_deg * (point.hz / hz - 1.0) <= TURN_CHANGE_MAX_DEG;
                phase_deg
            }
        };
        if is_known {
            point.phase_deg += 360.0 * ((near - point.phase_deg) / 360.0).round();
            before = Some((point.hz, point.phase_deg));
        }
        point.turn_is_known = is_known;
    }
}

/// Cosine and sine part of a value that is held from point to point, and half of its height.
fn input_phasor(
    command: &[Point],
    omega: f64,
    from_s: f64,
    to_s: f64,
) -> Option<((f64, f64), f64)> {
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
    Some((phasor, (greatest - least) / 2.0))
}

/// Cosine and sine part of samples, and their part of the total power.
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
    let r_squared = if rest.squares > 0.0 {
        1.0 - fit.squares / rest.squares
    } else {
        0.0
    };
    let [cos, sin, ..] = fit.unknowns;
    Some(((cos, sin), r_squared.clamp(0.0, 1.0)))
}

/// Magnitude and angle of the ratio of two phasors; the angle is within half a turn of [`FIRST_DEG`].
fn ratio(output: (f64, f64), input: (f64, f64)) -> (f64, f64) {
    let size = output.0.hypot(output.1) / input.0.hypot(input.1);
    // a cos + b sin lags the cosine by atan2(b, a).
    let behind = |phasor: (f64, f64)| phasor.1.atan2(phasor.0);
    let least = FIRST_DEG.to_radians() - PI;
    let angle = behind(input) - behind(output);
    (size, (angle - least).rem_euclid(TAU) + least)
}

/// The frequency at which the gain is 3 dB below that of the first point: half of the power.
///
/// Between two neighbouring valid points it is interpolated over the logarithm of the frequency. `None` if no valid
/// point is that low, or if the points next to it are not valid.
#[must_use]
pub fn bandwidth_hz(points: &[BodePoint]) -> Option<f64> {
    let is_valid = |point: &&BodePoint| point.invalid.is_none();
    let edge_db = points.iter().find(is_valid)?.gain_db - 10.0 * 2.0_f64.log10();
    let is_below = |point: &BodePoint| point.invalid.is_none() && point.gain_db < edge_db;
    let place = points.iter().position(is_below)?;
    let below = points.get(place)?;
    let before = points.get(place.checked_sub(1)?).filter(is_valid)?;
    let part = (before.gain_db - edge_db) / (before.gain_db - below.gain_db);
    Some(before.hz * (below.hz / before.hz).powf(part))
}
