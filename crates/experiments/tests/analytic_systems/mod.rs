//! Systems whose answers are known in closed form.
#![allow(dead_code, reason = "each user takes its own part")]

use std::f64::consts::TAU;

use motorlink_experiments::analysis::{Point, StepFigures};

/// The figures of a step from 0 to 1, by evaluating an exact answer every 20 us.
pub fn exact_figures(answer: impl Fn(f64) -> f64, until_s: f64) -> StepFigures {
    let mut times = (0_u32..).map(|tick| f64::from(tick) * 20e-6);
    let all: Vec<(f64, f64)> = times
        .by_ref()
        .take_while(|t_s| *t_s <= until_s)
        .map(|t_s| (t_s, answer(t_s)))
        .collect();
    let reaches = |level: f64| all.iter().find(|(_, y)| *y >= level).map(|(t_s, _)| *t_s);
    let outside = all.iter().rfind(|(_, y)| (y - 1.0).abs() > 0.02);
    let highest = all.iter().map(|(_, y)| *y).fold(0.0, f64::max);
    StepFigures {
        latency_s: reaches(0.01),
        rise_s: reaches(0.1).zip(reaches(0.9)).map(|(low, high)| high - low),
        overshoot: Some((highest - 1.0).max(0.0)),
        settling_s: outside.map(|(t_s, _)| *t_s),
        steady_error: Some(0.0),
        ..StepFigures::default()
    }
}

pub fn first_order(t_s: f64, constant_s: f64) -> f64 {
    1.0 - (-t_s / constant_s).exp()
}

/// A second-order system of this natural frequency and damping below 1.
#[derive(Clone, Copy)]
pub struct SecondOrder {
    pub hz: f64,
    pub damping: f64,
}

impl SecondOrder {
    pub fn step(self, t_s: f64) -> f64 {
        let omega = TAU * self.hz;
        let root = (1.0 - self.damping * self.damping).sqrt();
        let angle = omega * root * t_s;
        let decay = (-self.damping * omega * t_s).exp();
        1.0 - decay * (angle.cos() + self.damping / root * angle.sin())
    }

    /// Gain in dB and phase in degrees.
    pub fn response(self, hz: f64) -> (f64, f64) {
        let x = hz / self.hz;
        let (re, im) = (1.0 - x * x, 2.0 * self.damping * x);
        (-20.0 * re.hypot(im).log10(), -im.atan2(re).to_degrees())
    }
}

/// The virtual motor's velocity loop: a ramp, a lag, and a speed controller on the wheel
/// (`crates/simulator/src/firmware/{speed_profile,speed_loop}.rs`). In closed form, by partial fractions.
pub struct VelocityLoop {
    pub ramp_s: f64,
}

type Complex = (f64, f64);

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn over(a: Complex, b: Complex) -> Complex {
    let size = b.0 * b.0 + b.1 * b.1;
    let (re, im) = times(a, (b.0, -b.1));
    (re / size, im / size)
}

fn less(a: Complex, b: Complex) -> Complex {
    (a.0 - b.0, a.1 - b.1)
}

impl VelocityLoop {
    const LAG_S: f64 = 0.058;
    /// `(b + Kt Kp) / J` and `Kt Ki / J`, and the controller's zero `Kt Kp / J`.
    const DAMPING: f64 = (1.0e-4 + 0.75 * 0.133) / 1.0e-3;
    const STIFFNESS: f64 = 0.75 * 4.0 / 1.0e-3;
    const ZERO: f64 = 0.75 * 0.133 / 1.0e-3;

    /// 100 rpm at 3.6 ms per rpm for each unit of acceleration.
    pub fn of_100_rpm(acceleration: u8) -> Self {
        Self {
            ramp_s: 0.36 * f64::from(acceleration),
        }
    }

    /// The answer to a step, as a part of it.
    pub fn step(&self, t_s: f64) -> f64 {
        (Self::ramp(t_s) - Self::ramp(t_s - self.ramp_s)) / self.ramp_s
    }

    /// The answer to a ramp of 1 a second: `sum of R (exp(p t) - 1 - p t) / p^2` over the poles.
    fn ramp(t_s: f64) -> f64 {
        if t_s <= 0.0 {
            return 0.0;
        }
        let half = Self::DAMPING / 2.0;
        let swing = (Self::STIFFNESS - half * half).sqrt();
        let poles: [Complex; 3] = [(-1.0 / Self::LAG_S, 0.0), (-half, swing), (-half, -swing)];
        let mut sum = 0.0;
        for (place, pole) in poles.into_iter().enumerate() {
            let mut below = (Self::LAG_S, 0.0);
            for (other, next) in poles.into_iter().enumerate() {
                if other != place {
                    below = times(below, less(pole, next));
                }
            }
            let above = (Self::ZERO * pole.0 + Self::STIFFNESS, Self::ZERO * pole.1);
            let residue = over(above, below);
            let size = (pole.0 * t_s).exp();
            let (sin, cos) = (pole.1 * t_s).sin_cos();
            let grown = (size * cos - 1.0 - pole.0 * t_s, size * sin - pole.1 * t_s);
            sum += over(times(residue, grown), times(pole, pole)).0;
        }
        sum
    }
}

/// Replies of a signal: 200 a second, up to a millisecond late, rounded, some lost, with noise.
pub fn replies(
    signal: impl Fn(f64) -> f64,
    until_s: f64,
    noise: f64,
    random: &mut fastrand::Rng,
) -> Vec<Point> {
    let mut points = Vec::new();
    let mut at_s = 0.0;
    while at_s < until_s {
        let t_s = at_s + 1e-3 * random.f64();
        at_s += 5e-3;
        let bell: f64 = (0..6).map(|_| random.f64() - 0.5).sum();
        // Six uniform numbers have a deviation of 0.71.
        let value = (signal(t_s) + noise * bell / 0.71).round();
        if random.f64() > 0.03 {
            points.push(Point::new(t_s, value));
        }
    }
    points
}
