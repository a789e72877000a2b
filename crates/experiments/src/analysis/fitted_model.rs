//! A model of a step response or of a Bode plot: a gain, a dead time, and a lag of first or second order.
//!
//! Both orders are fitted by least squares (Levenberg-Marquardt). The second order is taken if its `AICc` is lower
//! (Hurvich and Tsai, Biometrika 76, 1989), with the number of residuals that are as good as independent. Intervals come
//! from leaving out each repeat, or each point, once (jackknife), so they hold for correlated noise.

use std::f64::consts::{LN_10, TAU};

use super::{BodePoint, Point, least_squares::LeastSquares, statistics::Estimate};

/// Replies of all repeats that are fitted. More take longer and tell little.
const ROWS_MAX: usize = 400;
/// Fewer rows do not tell the second order from noise.
const ROWS_MIN: usize = 12;
/// Parts that can be left out, at least, for an interval.
const PARTS_MIN: usize = 3;
/// Steps of the solver, and of one that begins at a solution.
const STEPS_MAX: u32 = 40;
const STEPS_AGAIN_MAX: u32 = 8;
/// A smaller relative gain ends the solver.
const GAIN_MIN: f64 = 1e-10;
/// The damping of the second order from which the solver starts.
const DAMPINGS: [f64; 3] = [0.3, 1.0, 2.0];

/// A fitted model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedModel {
    /// Final value by setpoint.
    pub gain: Estimate,
    /// Time until it begins to answer, in seconds.
    pub dead_time_s: Estimate,
    /// How it answers then.
    pub lag: Lag,
    /// Root of the mean square of the residuals: of a step in parts of it.
    pub rms: f64,
}

/// The lag of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lag {
    /// One time constant.
    First {
        /// In seconds.
        time_constant_s: Estimate,
    },
    /// An oscillator.
    Second {
        /// Its frequency without damping, in Hz.
        natural_hz: Estimate,
        /// 1 is critical.
        damping: Estimate,
    },
}

impl Lag {
    /// Time constant in seconds, natural frequency in Hz, damping: those that it has.
    #[must_use]
    pub const fn parts(self) -> (Option<Estimate>, Option<Estimate>, Option<Estimate>) {
        match self {
            Self::First { time_constant_s } => (Some(time_constant_s), None, None),
            Self::Second {
                natural_hz,
                damping,
            } => (None, Some(natural_hz), Some(damping)),
        }
    }
}

impl FittedModel {
    /// Its answer to a step of 1, this long after it.
    #[must_use]
    pub fn step(&self, t_s: f64) -> f64 {
        self.values().step(t_s)
    }

    /// Gain in dB and phase in degrees.
    #[must_use]
    pub fn response(&self, hz: f64) -> (f64, f64) {
        let (ln_gain, phase) = self.values().response(TAU * hz);
        (ln_gain * 20.0 / LN_10, phase.to_degrees())
    }

    fn values(&self) -> Values {
        Values {
            gain: self.gain.value,
            dead_s: self.dead_time_s.value,
            lag: match self.lag {
                Lag::First { time_constant_s } => LagValues::First {
                    time_s: time_constant_s.value,
                },
                Lag::Second {
                    natural_hz,
                    damping,
                } => LagValues::Second {
                    natural: TAU * natural_hz.value,
                    damping: damping.value,
                },
            },
        }
    }
}

/// A model without intervals.
#[derive(Clone, Copy, Debug)]
struct Values {
    gain: f64,
    dead_s: f64,
    lag: LagValues,
}

#[derive(Clone, Copy, Debug)]
enum LagValues {
    First { time_s: f64 },
    Second { natural: f64, damping: f64 },
}

impl Values {
    /// Of the unknowns of the solver: gain, dead time, and the logarithms of the rest, which are positive.
    fn of<const N: usize>(unknowns: &[f64; N]) -> Self {
        let mut unknowns = unknowns.iter().copied();
        let mut next = || unknowns.next();
        let (gain, dead_s) = (next().unwrap_or(0.0), next().unwrap_or(0.0));
        let (first, second) = (next().unwrap_or(0.0).exp(), next());
        let lag = match second {
            None => LagValues::First { time_s: first },
            Some(damping) => LagValues::Second {
                natural: first,
                damping: damping.exp(),
            },
        };
        Self { gain, dead_s, lag }
    }

    fn step(&self, t_s: f64) -> f64 {
        let t_s = t_s - self.dead_s;
        if t_s <= 0.0 {
            return 0.0;
        }
        let rest = match self.lag {
            LagValues::First { time_s } => (-t_s / time_s).exp(),
            LagValues::Second { natural, damping } => {
                let angle = natural * t_s;
                let bend = 1.0 - damping * damping;
                if bend.abs() < 1e-6 {
                    (-angle).exp() * (1.0 + angle)
                } else if bend > 0.0 {
                    let turn = bend.sqrt();
                    let (sin, cos) = (turn * angle).sin_cos();
                    (-damping * angle).exp() * (cos + damping / turn * sin)
                } else {
                    let apart = (-bend).sqrt();
                    let (slow, fast) = (damping - apart, damping + apart);
                    (fast * (-slow * angle).exp() - slow * (-fast * angle).exp()) / (2.0 * apart)
                }
            }
        };
        self.gain * (1.0 - rest)
    }

    /// Logarithm of the gain, and phase in rad.
    fn response(&self, omega: f64) -> (f64, f64) {
        let (re, im) = match self.lag {
            LagValues::First { time_s } => (1.0, omega * time_s),
            LagValues::Second { natural, damping } => {
                let part = omega / natural;
                (1.0 - part * part, 2.0 * damping * part)
            }
        };
        let ln_gain = self.gain.abs().ln() - re.hypot(im).ln();
        (ln_gain, -im.atan2(re) - omega * self.dead_s)
    }
}

/// What was measured, and the repeat or the point that it is part of.
#[derive(Clone, Copy, Debug)]
struct Row {
    part: usize,
    what: What,
}

#[derive(Clone, Copy, Debug)]
enum What {
    Step { t_s: f64, value: f64 },
    Gain { omega: f64, ln: f64 },
    Phase { omega: f64, rad: f64 },
}

impl Row {
    fn predicted(&self, model: &Values) -> f64 {
        match self.what {
            What::Step { t_s, .. } => model.step(t_s),
            What::Gain { omega, .. } => model.response(omega).0,
            What::Phase { omega, .. } => model.response(omega).1,
        }
    }

    const fn measured(&self) -> f64 {
        match self.what {
            What::Step { value, .. } => value,
            What::Gain { ln, .. } => ln,
            What::Phase { rad, .. } => rad,
        }
    }

    fn residual(&self, model: &Values) -> f64 {
        self.measured() - self.predicted(model)
    }
}

/// The model of repeated steps: each has the part of the step that is done, by the time since the motor received it.
#[must_use]
pub fn step_model(repeats: &[Vec<Point>]) -> Option<FittedModel> {
    let total: usize = repeats.iter().map(Vec::len).sum();
    let every = total.div_ceil(ROWS_MAX).max(1);
    let rows: Vec<Row> = (0..)
        .zip(repeats)
        .flat_map(|(part, repeat)| {
            let points = repeat.iter().step_by(every);
            points.map(move |point| Row {
                part,
                what: What::Step {
                    t_s: point.t_s,
                    value: point.value,
                },
            })
        })
        .collect();
    let points = || repeats.iter().flatten();
    let last_s = points().map(|point| point.t_s).max_by(f64::total_cmp)?;
    let tail = points().filter(|point| point.t_s >= 0.75 * last_s);
    let gain = super::statistics::mean(tail.map(|point| point.value))?;
    let reaches = |part: f64| {
        let reached = points().filter(|point| point.value >= part * gain);
        reached.map(|point| point.t_s).min_by(f64::total_cmp)
    };
    // Where a lag of first order has 28 % and 63 % (Smith, Digital Computer Process Control, 1972).
    let (early_s, late_s) = (reaches(0.283)?, reaches(0.632)?);
    let time_s = (1.5 * (late_s - early_s)).max(1e-3);
    best(&rows, [gain, (late_s - time_s).max(0.0), time_s])
}

/// The model of the valid points of a Bode plot. The phase of a point whose turn is unknown is left out.
#[must_use]
pub fn bode_model(points: &[BodePoint]) -> Option<FittedModel> {
    let valid = || points.iter().filter(|point| point.invalid.is_none());
    let mut rows = Vec::new();
    for (part, point) in valid().enumerate() {
        let omega = TAU * point.hz;
        let ln = point.gain_db * LN_10 / 20.0;
        let what = What::Gain { omega, ln };
        rows.push(Row { part, what });
        if point.turn_is_known {
            let rad = point.phase_deg.to_radians();
            let what = What::Phase { omega, rad };
            rows.push(Row { part, what });
        }
    }
    let first = valid().next()?;
    let last = valid().next_back()?;
    let falls = valid().find(|point| point.gain_db < first.gain_db - 3.0);
    let time_s = 1.0 / (TAU * falls.unwrap_or(last).hz);
    best(&rows, [10_f64.powf(first.gain_db / 20.0), 0.0, time_s])
}

/// The better of both orders. `start` has the gain, the dead time and the time constant.
fn best(rows: &[Row], start: [f64; 3]) -> Option<FittedModel> {
    if rows.len() < ROWS_MIN {
        return None;
    }
    let [gain, dead_s, time_s] = start;
    let first = solve([gain, dead_s, time_s.ln()], rows, STEPS_MAX);
    let seconds = DAMPINGS.map(|damping: f64| {
        let start = [
            gain,
            dead_s / 2.0,
            -time_s.ln() + damping.ln().max(0.0),
            damping.ln(),
        ];
        solve(start, rows, STEPS_MAX)
    });
    let second = seconds
        .into_iter()
        .min_by(|one, other| one.squares.total_cmp(&other.squares))?;
    let count = independent(rows, &Values::of(&second.unknowns));
    if aicc(&second, rows.len(), count) < aicc(&first, rows.len(), count) {
        model(&second, rows)
    } else {
        model(&first, rows)
    }
}

/// A solution with the sum of the squares of its residuals.
#[derive(Clone, Copy, Debug)]
struct Solution<const N: usize> {
    unknowns: [f64; N],
    squares: f64,
}

/// The solution with intervals; `None` if it is no model.
fn model<const N: usize>(found: &Solution<N>, rows: &[Row]) -> Option<FittedModel> {
    let parts = rows.iter().map(|row| row.part + 1).max()?;
    let without: Vec<Values> = (0..parts)
        .map(|part| {
            let others = rows.iter().filter(|row| row.part != part);
            let others: Vec<Row> = others.copied().collect();
            Values::of(&solve(found.unknowns, &others, STEPS_AGAIN_MAX).unknowns)
        })
        .collect();
    let values = Values::of(&found.unknowns);
    let estimate = |of: &dyn Fn(&Values) -> f64| {
        let value = of(&values);
        if parts < PARTS_MIN {
            let plus_minus = f64::INFINITY;
            return Estimate { value, plus_minus };
        }
        let others: Vec<f64> = without.iter().map(of).collect();
        Estimate::by_jackknife(value, &others)
    };
    let lag = match values.lag {
        LagValues::First { .. } => Lag::First {
            time_constant_s: estimate(&|it| match it.lag {
                LagValues::First { time_s } => time_s,
                LagValues::Second { natural, .. } => 1.0 / natural,
            }),
        },
        LagValues::Second { .. } => {
            let part = |of: fn(f64, f64) -> f64| {
                estimate(&|it| match it.lag {
                    LagValues::First { time_s } => of(1.0 / time_s, 1.0),
                    LagValues::Second { natural, damping } => of(natural, damping),
                })
            };
            Lag::Second {
                natural_hz: part(|natural, _| natural / TAU),
                damping: part(|_, damping| damping),
            }
        }
    };
    let count = f64::from(u32::try_from(rows.len()).ok()?);
    let found = FittedModel {
        gain: estimate(&|it| it.gain),
        dead_time_s: estimate(&|it| it.dead_s),
        lag,
        rms: (found.squares / count).sqrt(),
    };
    found.rms.is_finite().then_some(found)
}

/// Levenberg-Marquardt from these unknowns. The second unknown, a time, does not become negative.
fn solve<const N: usize>(start: [f64; N], rows: &[Row], steps_max: u32) -> Solution<N> {
    let squares = |unknowns: &[f64; N]| {
        let model = Values::of(unknowns);
        let residuals = rows.iter().map(|row| row.residual(&model));
        residuals.map(|residual| residual * residual).sum::<f64>()
    };
    let mut found = Solution {
        unknowns: start,
        squares: squares(&start),
    };
    let mut damping = 1e-3;
    for _ in 0..steps_max {
        let Some(change) = step(&found.unknowns, rows, damping) else {
            break;
        };
        let mut unknowns = found.unknowns;
        for (unknown, change) in unknowns.iter_mut().zip(change) {
            *unknown += change;
        }
        if let Some(dead_s) = unknowns.get_mut(1) {
            *dead_s = dead_s.max(0.0);
        }
        let new = squares(&unknowns);
        if new < found.squares {
            let gained = found.squares - new;
            let ends = gained < GAIN_MIN * found.squares;
            found = Solution {
                unknowns,
                squares: new,
            };
            damping /= 5.0;
            if ends {
                break;
            }
        } else {
            // NaN too.
            damping *= 8.0;
        }
    }
    found
}

/// One damped step of the solver.
fn step<const N: usize>(unknowns: &[f64; N], rows: &[Row], damping: f64) -> Option<[f64; N]> {
    let here = Values::of(unknowns);
    let moved: [(f64, Values); N] = std::array::from_fn(|at| {
        let mut moved = *unknowns;
        let by = unknowns.get(at).map_or(0.0, |it| 1e-6 * it.abs().max(1e-2));
        if let Some(unknown) = moved.get_mut(at) {
            *unknown += by;
        }
        (by, Values::of(&moved))
    });
    let mut equations = LeastSquares::<N>::new();
    let mut weights = [1e-12; N];
    for row in rows {
        let predicted = row.predicted(&here);
        let slopes = moved.map(|(by, values)| (row.predicted(&values) - predicted) / by);
        for (weight, slope) in weights.iter_mut().zip(slopes) {
            *weight += slope * slope;
        }
        equations.add(slopes, row.measured() - predicted);
    }
    for (at, weight) in weights.into_iter().enumerate() {
        let damped = std::array::from_fn(|of| {
            if of == at {
                (damping * weight).sqrt()
            } else {
                0.0
            }
        });
        equations.add(damped, 0.0);
    }
    Some(equations.solve()?.unknowns)
}

/// How many of the residuals are as good as independent: of a first-order autoregressive noise.
fn independent(rows: &[Row], model: &Values) -> f64 {
    let residuals: Vec<f64> = rows.iter().map(|row| row.residual(model)).collect();
    let power: f64 = residuals.iter().map(|it| it * it).sum();
    let pairs = residuals.iter().zip(residuals.iter().skip(1));
    let next: f64 = pairs.map(|(one, next)| one * next).sum();
    let similar = (next / power.max(f64::MIN_POSITIVE)).clamp(0.0, 0.99);
    let count = f64::from(u32::try_from(rows.len()).unwrap_or(u32::MAX));
    count * (1.0 - similar) / (1.0 + similar)
}

/// The corrected information criterion of Akaike; infinite for fewer residuals than it can judge.
fn aicc<const N: usize>(found: &Solution<N>, rows: usize, independent: f64) -> f64 {
    // The variance of the noise is unknown too.
    let unknowns = f64::from(u32::try_from(N + 1).unwrap_or(u32::MAX));
    let rows = f64::from(u32::try_from(rows).unwrap_or(u32::MAX));
    let freedom = independent - unknowns - 1.0;
    if freedom <= 0.0 {
        return f64::INFINITY;
    }
    let variance = (found.squares / rows).max(f64::MIN_POSITIVE);
    independent * variance.ln() + 2.0 * unknowns * (1.0 + (unknowns + 1.0) / freedom)
}
