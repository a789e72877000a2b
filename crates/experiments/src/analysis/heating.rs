//! Heating at a constant current.

use super::{Point, crossing::changes, least_squares::LeastSquares, statistics::Estimate};

/// Range of the time constants: a winding of half a kilogram has minutes.
const TIME_CONSTANT_S: (f64, f64) = (5.0, 20_000.0);
/// Steps of the search. Each one shrinks the interval to 0.62 of it: from 4000:1 to one part in a million.
const SEARCH_STEPS: u32 = 45;
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
/// confidence comes from the linear equations at the minimum, with all three unknowns. `None` for fewer than six
/// changes of temperature.
#[must_use]
pub fn heating(temperature: &[Point]) -> Option<Heating> {
    let known = changes(temperature);
    // The first and the last report are only known to half a degree.
    let inner = known.len().checked_sub(2).filter(|inner| *inner >= 6)?;
    let known: Vec<Point> = known.into_iter().skip(1).take(inner).collect();
    let begins_s = temperature.first()?.t_s;
    let at = |t_s: f64, constant_s: f64| (-(t_s - begins_s) / constant_s).exp();
    let linear = |constant_s: f64| {
        let mut rows = LeastSquares::<2>::new();
        for point in &known {
            rows.add([1.0, -at(point.t_s, constant_s)], point.value);
        }
        rows.solve()
    };
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
    let mut rows = LeastSquares::<3>::new();
    for point in &known {
        let decay = at(point.t_s, constant_s);
        let turns = -rise_k * decay * (point.t_s - begins_s) / (constant_s * constant_s);
        rows.add([1.0, -decay, turns], point.value);
    }
    let [final_c, rise_k, more_s] = Estimate::of(&rows.solve()?);
    Some(Heating {
        final_c,
        rise_k,
        time_constant_s: Estimate {
            value: constant_s,
            plus_minus: more_s.plus_minus,
        },
    })
}
