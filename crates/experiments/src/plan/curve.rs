//! The setpoints of a plan as curves to draw.

use super::{Op, Plan, PlanMotor, PlannedMove};
use crate::sequence::{Action, End, Shape};

/// Maximal number of points of all curves together. A screen is at most 4,000 columns wide; more than five points per
/// column are not visible.
pub const POINTS_MAX: usize = 20_000;
/// Points per period of a sine.
const POINTS_A_PERIOD: f64 = 24.0;
/// Maximal number of points of one step.
const POINTS_A_STEP_MAX: f64 = 2_000.0;

/// The setpoints of one motor.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The motor, with its unit and range.
    pub motor: PlanMotor,
    /// In order of time.
    pub points: Vec<CurvePoint>,
    /// Whether the plan continues after the last point, because the maximum was reached.
    pub cut: bool,
}

/// A point of a curve. Lines between them are straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Seconds from the start. A step that waits has its maximal duration.
    pub t_s: f64,
    /// The setpoint. A brake is 0.
    pub value: f64,
    /// Whether the step waits for a condition, which makes this time an upper bound.
    pub waits: bool,
}

impl Plan {
    /// A curve for each motor.
    #[must_use]
    pub fn curves(&self) -> Vec<Curve> {
        self.curves_of_run(&[])
    }

    /// The curves of a run that has begun these steps: the seconds since its start, and the instruction. A step ends
    /// where the next one begins, and the steps that are left follow behind them.
    #[must_use]
    pub fn curves_of_run(&self, begun: &[(f64, usize)]) -> Vec<Curve> {
        let mut drawing = Drawing {
            curves: self.motors.iter().copied().map(begin).collect(),
            room: POINTS_MAX,
            t_s: 0.0,
        };
        let mut passes: Vec<u32> = Vec::new();
        let mut begun = begun.iter().peekable();
        let mut at = 0;
        while let Some(op) = self.program.get(at) {
            let place = at;
            at += 1;
            match op {
                Op::Move(step) => {
                    let start = begun.next_if(|(_, step)| *step == place);
                    let next_s = start.and_then(|_| Some(begun.peek()?.0));
                    drawing.t_s = start.map_or(drawing.t_s, |(start_s, _)| *start_s);
                    drawing.draw(step, next_s);
                }
                Op::Loop { passes: all } => passes.push(*all),
                Op::Again { first, .. } => {
                    let left = passes.pop().unwrap_or(1).saturating_sub(1);
                    // A condition may have ended the loop before its last pass.
                    let next = begun.peek();
                    let is_over = next.is_some_and(|(_, step)| !(*first..place).contains(step));
                    if left > 0 && !is_over {
                        passes.push(left);
                        at = first + 1;
                    }
                }
            }
            if drawing.room == 0 {
                break;
            }
        }
        let cut = drawing.room == 0;
        for curve in &mut drawing.curves {
            curve.cut = cut;
            let value = curve.points.last().map_or(0.0, |point| point.value);
            curve.points.push(CurvePoint {
                t_s: drawing.t_s,
                value,
                waits: false,
            });
        }
        drawing.curves
    }
}

fn begin(motor: PlanMotor) -> Curve {
    Curve {
        motor,
        points: Vec::new(),
        cut: false,
    }
}

struct Drawing {
    curves: Vec<Curve>,
    room: usize,
    t_s: f64,
}

impl Drawing {
    fn draw(&mut self, step: &PlannedMove, next_s: Option<f64>) {
        let planned_s = step.seconds();
        let seconds = next_s.map_or(planned_s, |next_s| planned_s.min(next_s - self.t_s));
        let waits = matches!(step.end, End::Until { .. });
        for motor in &step.motors {
            let Some(curve) = self.curves.get_mut(*motor) else {
                continue;
            };
            let from = curve.points.last().map_or(0.0, |point| point.value);
            // The motor keeps the previous setpoint until here.
            let mut points = vec![(0.0, from)];
            match step.action {
                Action::Brake => points.extend([(0.0, 0.0), (seconds, 0.0)]),
                Action::Follow { shape, .. } => {
                    let count = points_of(shape, seconds);
                    let fraction = |point: u32| seconds * f64::from(point) / f64::from(count);
                    let value = |t_s: f64| (t_s, shape.value(from, t_s, planned_s));
                    points.extend((0..=count).map(|point| value(fraction(point))));
                }
            }
            let points = points.into_iter().take(self.room);
            self.room = self.room.saturating_sub(points.len());
            curve.points.extend(points.map(|(t_s, value)| CurvePoint {
                t_s: self.t_s + t_s,
                value,
                waits,
            }));
        }
        self.t_s += seconds;
    }
}

/// Number of straight lines for this shape.
fn points_of(shape: Shape, seconds: f64) -> u32 {
    let periods = match shape {
        Shape::Step { .. } | Shape::Ramp { .. } => return 1,
        Shape::Sine(wave) | Shape::Triangle(wave) => wave.hz * seconds,
        Shape::Chirp { wave, to_hz } => wave.hz.max(to_hz) * seconds,
    };
    crate::number::whole((periods * POINTS_A_PERIOD).clamp(1.0, POINTS_A_STEP_MAX))
}
