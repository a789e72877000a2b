//! Heating at a constant current.

use super::{
    Point,
    batch_means::{Reply, estimates, solve},
    statistics::Estimate,
};

/// Range of the time constants: a winding of half a kilogram has minutes.
const TIME_CONSTANT_S: (f64, f64) = (5.0, 20_000.0);
/// Steps of the search. Each one shrinks the interval to 0.62 of it: from 4000:1 to one part in a million.
const SEARCH_STEPS: u32 = 45;
/// The temperature is reported in whole degrees: fewer do not show a curve.
const RISE_MIN_K: f64 = 6.0;
/// Ratio of the golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// How a winding warms up: `final - rise * exp(-t / time constant)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heating {
    /// Final temperature, in deg C.
    pub final_c: Estimate,
    /// Rise from the start to the final temperature, in K.
    pub rise_k: Estimate,
    /// The time to 63 % of the rise.
    pub time_constant_s: Estimate,
}

/// Fits an exponential to reported temperatures in deg C.
///
/// For a given time constant the rest is linear, so that only one value is searched for, by golden section. The
/// intervals come from the linear equations at the minimum, with all three unknowns. `None` if the temperature rises by
/// less than six degrees.
#[must_use]
pub fn heating(temperature: &[Point]) -> Option<Heating> {
    let begins_s = temperature.first()?.t_s;
    let values = || temperature.iter().map(|point| point.value);
    let coldest = values().fold(f64::INFINITY, f64::min);
    if values().fold(coldest, f64::max) - coldest < RISE_MIN_K {
        return None;
    }
    let decay = |point: &Point, constant_s: f64| (-(point.t_s - begins_s) / constant_s).exp();
    let linear = |constant_s: f64| solve(&rows(temperature, |it| [1.0, -decay(it, constant_s)]));
    let off = |log_s: f64| linear(log_s.exp()).map_or(f64::INFINITY, |fit| fit.squares);
    let (mut low, mut high) = (TIME_CONSTANT_S.0.ln(), TIME_CONSTANT_S.1.ln());
    for _ in 0..SEARCH_STEPS {
        let (one, two) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if off(one) < off(two) {
            high = two;
        } else {
            low = one;
        }
    }
    let constant_s = f64::midpoint(low, high).exp();
    let [_, rise_k] = linear(constant_s)?.unknowns;
    // The third column is the derivative of the model by the time constant.
    let rows = rows(temperature, |point| {
        let decay = decay(point, constant_s);
        let turns = -rise_k * decay * (point.t_s - begins_s) / (constant_s * constant_s);
        [1.0, -decay, turns]
    });
    let [final_c, rise_k, more_s] = estimates(&rows, &solve(&rows)?, |_| 1.0)?;
    Some(Heating {
        final_c,
        rise_k,
        time_constant_s: Estimate {
            value: constant_s,
            plus_minus: more_s.plus_minus,
        },
    })
}

fn rows<const N: usize>(temperature: &[Point], row: impl Fn(&Point) -> [f64; N]) -> Vec<Reply<N>> {
    temperature
        .iter()
        .map(|point| Reply {
            row: row(point),
            y: point.value,
            report: point.value,
        })
        .collect()
}
