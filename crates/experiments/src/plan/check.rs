//! Checks the rules of a sequence. Each error names its place.

use motorlink_protocol::MotorId;

use super::{Fleet, MOTORS_MAX, Op, Plan, PlanMotor, PlannedMove};
use crate::sequence::{
    AMPS_MAX, Action, CELSIUS_MAX, Condition, DEGREES_MAX, DEPTH_MAX, End, HZ_MAX, HZ_MIN, Move,
    PASSES_MAX, Problem, Quantity, RUN_MAX, Repeat, RunLimits, STEPS_MAX, Selection, Sequence,
    SequenceError, Shape, Step, Wave,
};

/// Minimal time of a step with a condition: one tick at 500 Hz.
const WAIT_MIN_S: f64 = 0.002;
/// Minimal time of one pass of a loop, so that a run has at most as many passes as ticks.
const PASS_MIN_S: f64 = WAIT_MIN_S;
/// The smallest limits, as on the bus.
const LIMITS_MIN: [f64; 3] = [1.0, 0.1, 30.0];

type Result<T> = std::result::Result<T, SequenceError>;

impl Plan {
    /// Checks a sequence.
    ///
    /// # Errors
    /// [`SequenceError`] names the first place that breaks a rule.
    pub fn new(sequence: &Sequence, fleet: &Fleet) -> Result<Self> {
        if fleet.motors.is_empty() {
            return Err(SequenceError::at("", Problem::NoMotors));
        }
        check_limits(sequence.limits, fleet)?;
        let mut check = Check {
            fleet,
            motors: Vec::new(),
            program: Vec::new(),
            steps: 0,
            has_conditions: false,
        };
        let times = check.steps(&sequence.steps, "steps", 0)?;
        if times.longest_s > RUN_MAX.as_secs_f64() {
            let hours_max = RUN_MAX.as_secs() / 3600;
            return Err(SequenceError::at(
                "steps",
                Problem::RunTooLong { hours_max },
            ));
        }
        if check.motors.len() > MOTORS_MAX {
            let max = MOTORS_MAX;
            return Err(SequenceError::at("steps", Problem::TooManyMotors { max }));
        }
        Ok(Self {
            motors: check.motors,
            program: check.program,
            limits: sequence.limits,
            longest_s: times.longest_s,
            has_conditions: check.has_conditions,
        })
    }
}

fn check_limits(limits: RunLimits, fleet: &Fleet) -> Result<()> {
    let [rpm, amps, celsius] = LIMITS_MIN;
    let all = [
        ("limits.rpm", limits.rpm, rpm, fleet.rpm_max),
        ("limits.amps", limits.amps, amps, AMPS_MAX),
        ("limits.celsius", limits.celsius, celsius, CELSIUS_MAX),
    ];
    for (place, limit, min, max) in all {
        within(limit.unwrap_or(min), min, max, || place.to_owned())?;
    }
    Ok(())
}

/// Refuses a value outside its range. NaN is outside of every range.
fn within(value: f64, min: f64, max: f64, place: impl FnOnce() -> String) -> Result<()> {
    if value >= min && value <= max {
        return Ok(());
    }
    let problem = if value > max {
        Problem::Above { value, max }
    } else {
        Problem::Below { value, min }
    };
    Err(SequenceError::at(place(), problem))
}

/// Durations of steps.
#[derive(Clone, Copy, Default)]
struct Times {
    least_s: f64,
    longest_s: f64,
}

struct Check<'a> {
    fleet: &'a Fleet,
    motors: Vec<PlanMotor>,
    program: Vec<Op>,
    steps: usize,
    has_conditions: bool,
}

impl Check<'_> {
    fn steps(&mut self, steps: &[Step], list: &str, depth: usize) -> Result<Times> {
        if steps.is_empty() {
            return Err(SequenceError::at(list, Problem::NoSteps));
        }
        let mut all = Times::default();
        for (number, step) in steps.iter().enumerate() {
            self.steps += 1;
            if self.steps > STEPS_MAX {
                let max = STEPS_MAX;
                return Err(SequenceError::at(list, Problem::TooManySteps { max }));
            }
            let place = format!("{list}[{number}]");
            let one = match step {
                Step::Move(step) => self.one(step, place)?,
                Step::Repeat(repeat) => self.repeat(repeat, &place, depth)?,
            };
            all.least_s += one.least_s;
            all.longest_s += one.longest_s;
        }
        Ok(all)
    }

    fn repeat(&mut self, repeat: &Repeat, place: &str, depth: usize) -> Result<Times> {
        let passes = || format!("{place}.repeat");
        if repeat.passes == 0 {
            return Err(SequenceError::at(passes(), Problem::EndlessLoop));
        }
        within(repeat.passes.into(), 1.0, PASSES_MAX.into(), passes)?;
        let list = format!("{place}.steps");
        if depth >= DEPTH_MAX {
            let max = DEPTH_MAX;
            return Err(SequenceError::at(list, Problem::TooDeep { max }));
        }
        if let Some(until) = repeat.until {
            self.condition(until, &format!("{place}.until"))?;
        }
        let first = self.program.len();
        self.program.push(Op::Loop {
            passes: repeat.passes,
        });
        let pass = self.steps(&repeat.steps, &list, depth + 1)?;
        self.program.push(Op::Again {
            first,
            until: repeat.until,
        });
        if pass.least_s < PASS_MIN_S {
            return Err(SequenceError::at(list, Problem::TimelessLoop));
        }
        let once = repeat.until.is_some();
        let passes = f64::from(repeat.passes);
        Ok(Times {
            least_s: pass.least_s * if once { 1.0 } else { passes },
            longest_s: pass.longest_s * passes,
        })
    }

    fn one(&mut self, step: &Move, place: String) -> Result<Times> {
        self.check_action(step.action, step.end, &place)?;
        let longest = RUN_MAX.as_secs_f64();
        let times = match step.end {
            End::After(seconds) => {
                within(seconds, 0.0, longest, || format!("{place}.for_s"))?;
                Times {
                    least_s: seconds,
                    longest_s: seconds,
                }
            }
            End::Until {
                condition,
                within_s,
            } => {
                self.condition(condition, &format!("{place}.until"))?;
                within(within_s, 0.0, longest, || format!("{place}.within_s"))?;
                Times {
                    least_s: WAIT_MIN_S,
                    longest_s: within_s.max(WAIT_MIN_S),
                }
            }
        };
        let mut motors = Vec::new();
        for id in self.motors_of(&step.selection, &place)? {
            motors.push(self.motor(id, step.action, &place)?);
        }
        self.program.push(Op::Move(PlannedMove {
            motors,
            action: step.action,
            end: step.end,
            place,
        }));
        Ok(times)
    }

    fn motors_of(&self, selection: &Selection, place: &str) -> Result<Vec<MotorId>> {
        let known = &self.fleet.motors;
        match selection {
            Selection::All => Ok(known.clone()),
            Selection::Motor(id) if known.contains(id) => Ok(vec![*id]),
            Selection::Motor(id) => Err(SequenceError::at(
                format!("{place}.motor"),
                Problem::UnknownMotor(*id),
            )),
            Selection::Group(name) => {
                let mut groups = self.fleet.groups.iter();
                let group = groups.find(|(group, _)| group == name);
                let members = group.map(|(_, members)| members.iter().copied());
                let members: Vec<MotorId> = members
                    .into_iter()
                    .flatten()
                    .filter(|id| known.contains(id))
                    .collect();
                if members.is_empty() {
                    return Err(SequenceError::at(
                        format!("{place}.group"),
                        Problem::UnknownGroup,
                    ));
                }
                Ok(members)
            }
        }
    }

    /// The index of a motor. It keeps its loop for the whole run: a change of loop needs a standstill, which no row
    /// of the table shows.
    fn motor(&mut self, id: MotorId, action: Action, place: &str) -> Result<usize> {
        let quantity = match action {
            Action::Follow { quantity, .. } => quantity,
            Action::Brake => Quantity::Rpm,
        };
        let known = self.motors.iter().position(|motor| motor.id == id);
        let at = known.unwrap_or(self.motors.len());
        if known.is_none() {
            self.motors.push(PlanMotor {
                id,
                quantity,
                least: f64::INFINITY,
                greatest: f64::NEG_INFINITY,
                // Angles of setpoints are the motor's own, so a position run has its signs in everything.
                mirrored: quantity != Quantity::Degrees && self.fleet.mirrored.contains(&id),
            });
        }
        let Some(motor) = self.motors.get_mut(at) else {
            return Ok(at);
        };
        if motor.quantity != quantity {
            let before = motor.mode();
            return Err(SequenceError::at(place, Problem::OtherLoop { id, before }));
        }
        let (least, greatest) = match action {
            // The start of a ramp is a checked value already.
            Action::Follow { shape, .. } => match shape {
                Shape::Ramp { to } => (to, to),
                _ => shape.range(0.0),
            },
            Action::Brake => (0.0, 0.0),
        };
        // A run begins at a standstill, and at the present angle of the wheel.
        let start = if quantity == Quantity::Degrees {
            least
        } else {
            0.0
        };
        motor.least = motor.least.min(least).min(start);
        motor.greatest = motor.greatest.max(greatest).max(start);
        Ok(at)
    }

    fn check_action(&self, action: Action, end: End, place: &str) -> Result<()> {
        let Action::Follow {
            quantity, shape, ..
        } = action
        else {
            return Ok(());
        };
        let field = quantity.field();
        let (min, max) = match quantity {
            Quantity::Rpm => (-self.fleet.rpm_max, self.fleet.rpm_max),
            Quantity::Amps => (-AMPS_MAX, AMPS_MAX),
            Quantity::Degrees => (0.0, DEGREES_MAX),
        };
        let (wave, to_hz) = match shape {
            Shape::Step { to } | Shape::Ramp { to } => {
                within(to, min, max, || format!("{place}.{field}"))?;
                (None, None)
            }
            Shape::Sine(wave) | Shape::Triangle(wave) => (Some(wave), None),
            Shape::Chirp { wave, to_hz } => (Some(wave), Some(to_hz)),
        };
        let needs_time = matches!(shape, Shape::Ramp { .. } | Shape::Chirp { .. });
        if needs_time && matches!(end, End::Until { .. }) {
            let problem = Problem::NotWith("a ramp or chirp, which ends after its time");
            return Err(SequenceError::at(format!("{place}.until"), problem));
        }
        if let Some(Wave {
            centre,
            amplitude,
            hz,
        }) = wave
        {
            within(centre, min, max, || format!("{place}.{field}"))?;
            within(amplitude, 0.0, max - min, || format!("{place}.amplitude"))?;
            let reaches = |value| within(value, min, max, || format!("{place}.amplitude"));
            reaches(centre + amplitude)?;
            reaches(centre - amplitude)?;
            within(hz, HZ_MIN, HZ_MAX, || format!("{place}.hz"))?;
        }
        if let Some(to_hz) = to_hz {
            within(to_hz, HZ_MIN, HZ_MAX, || format!("{place}.to_hz"))?;
        }
        Ok(())
    }

    fn condition(&mut self, condition: Condition, place: &str) -> Result<()> {
        self.has_conditions = true;
        let rpm_max = self.fleet.rpm_max;
        let field = |name: &str| format!("{place}.{name}");
        match condition {
            Condition::RpmAbove(rpm) => within(rpm, 0.0, rpm_max, || field("rpm_above")),
            Condition::RpmBelow(rpm) => within(rpm, 0.0, rpm_max, || field("rpm_below")),
            Condition::CelsiusAbove(celsius) => {
                within(celsius, 0.0, CELSIUS_MAX, || field("celsius_above"))
            }
            Condition::CelsiusBelow(celsius) => {
                within(celsius, 0.0, CELSIUS_MAX, || field("celsius_below"))
            }
            Condition::DegreesNear { degrees, tolerance } => {
                within(degrees, 0.0, DEGREES_MAX, || field("degrees"))?;
                within(tolerance, 0.1, 180.0, || field("tolerance"))
            }
        }
    }
}
