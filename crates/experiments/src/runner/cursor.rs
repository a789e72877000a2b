//! The position of a run in its plan, and the setpoints there.

use std::time::Duration;

use motorlink_protocol::{Instant, OpenLoopTarget, Setpoint};

use super::{
    FRESH_FOR,
    record::Mark,
    watch::{Watch, neutral, setpoint_of},
};
use crate::{
    plan::{Op, Plan, PlannedMove},
    sequence::{Action, End, Quantity},
};

/// Maximal instructions in one tick: a table of steps without duration, once through.
const OPS_AT_ONCE_MAX: usize = 2 * crate::sequence::STEPS_MAX;

/// What a motor does at present.
#[derive(Clone, Copy, Debug)]
enum Part {
    /// It keeps this setpoint.
    Keeps(Setpoint),
    /// It follows the shape of an instruction since this second of the plan, from this value.
    Follows { op: usize, since_s: f64, from: f64 },
}

/// The result of advancing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Progress {
    /// The cursor is in a step that ends at this time of the plan, at the latest.
    In {
        ends: Duration,
    },
    TimedOut {
        step: usize,
    },
    Finished,
}

#[derive(Clone, Debug)]
pub(super) struct Cursor {
    op: usize,
    /// When the present instruction began, in seconds of the plan.
    began_s: f64,
    /// Whether its motors follow it.
    entered: bool,
    /// Remaining passes of each loop that contains the cursor, including the current one.
    passes: Vec<u32>,
    parts: Vec<Part>,
}

impl Cursor {
    /// A cursor at the start. The motors keep these setpoints until their first step.
    pub(super) fn new(held: Vec<Setpoint>) -> Self {
        Self {
            op: 0,
            began_s: 0.0,
            entered: false,
            passes: Vec::new(),
            parts: held.into_iter().map(Part::Keeps).collect(),
        }
    }

    /// The present instruction.
    pub(super) const fn step(&self) -> usize {
        self.op
    }

    /// Advances to this time of the plan. A timed step ends at its own time, not at the time of this call.
    pub(super) fn advance(
        &mut self,
        plan: &Plan,
        base: Instant,
        passed: Duration,
        watch: &Watch,
        mut began: impl FnMut(Mark),
    ) -> Progress {
        let now_s = passed.as_secs_f64();
        for _ in 0..OPS_AT_ONCE_MAX {
            let Some(op) = plan.program.get(self.op) else {
                return Progress::Finished;
            };
            match op {
                Op::Loop { passes } => {
                    self.passes.push(*passes);
                    self.op += 1;
                }
                Op::Again { first, until } => {
                    // The last step of the pass has just ended, so no reply is newer than its end.
                    let since = base + passed - FRESH_FOR;
                    let mut motors = 0..plan.motors.len();
                    let is_over = until
                        .is_some_and(|until| motors.any(|motor| watch.holds(motor, until, since)));
                    let left = self.passes.pop().unwrap_or(1).saturating_sub(1);
                    if left > 0 && !is_over {
                        self.passes.push(left);
                        self.op = first + 1;
                    } else {
                        self.op += 1;
                    }
                }
                Op::Move(step) => {
                    let since = base + Duration::from_secs_f64(self.began_s);
                    if !self.entered {
                        began(Mark {
                            at: since,
                            step: self.op,
                        });
                        self.enter(plan, step);
                    }
                    let holds = |condition| {
                        let mut motors = step.motors.iter();
                        motors.all(|motor| watch.holds(*motor, condition, since))
                    };
                    let ends_s = self.began_s + step.seconds();
                    let over_s = match step.end {
                        End::After(_) if now_s >= ends_s => ends_s,
                        End::Until { condition, .. }
                            if now_s > self.began_s && holds(condition) =>
                        {
                            now_s
                        }
                        End::Until { .. } if now_s >= ends_s => {
                            return Progress::TimedOut { step: self.op };
                        }
                        _ => {
                            let ends = Duration::from_secs_f64(ends_s);
                            return Progress::In { ends };
                        }
                    };
                    self.leave(plan, step, over_s);
                    self.began_s = over_s;
                    self.op += 1;
                }
            }
        }
        // The maximum per tick is reached: the rest follows in the next one.
        Progress::In { ends: passed }
    }

    /// The setpoint of each motor at this time of the plan.
    pub(super) fn setpoints(&self, plan: &Plan, passed: Duration) -> Vec<Setpoint> {
        let now_s = passed.as_secs_f64();
        let parts = self.parts.iter();
        parts.map(|part| setpoint(plan, *part, now_s)).collect()
    }

    /// The setpoints while paused: no speed, no current, and the last sent angles.
    pub(super) fn paused(&self, plan: &Plan, passed: Duration) -> Vec<Setpoint> {
        let at_rest = |setpoint| match setpoint {
            Setpoint::Velocity { .. } | Setpoint::Brake => neutral(Quantity::Rpm),
            Setpoint::Current(_) => neutral(Quantity::Amps),
            Setpoint::OpenLoop(_) => Setpoint::OpenLoop(OpenLoopTarget::ZERO),
            Setpoint::Position(_) => setpoint,
        };
        let setpoints = self.setpoints(plan, passed).into_iter();
        setpoints.map(at_rest).collect()
    }

    fn enter(&mut self, plan: &Plan, step: &PlannedMove) {
        self.entered = true;
        for motor in &step.motors {
            if let Some(part) = self.parts.get_mut(*motor) {
                *part = Part::Follows {
                    op: self.op,
                    since_s: self.began_s,
                    from: value(plan, *part, self.began_s),
                };
            }
        }
    }

    /// The motors of a step keep its last setpoint.
    fn leave(&mut self, plan: &Plan, step: &PlannedMove, at_s: f64) {
        self.entered = false;
        for motor in &step.motors {
            if let Some(part) = self.parts.get_mut(*motor) {
                *part = Part::Keeps(setpoint(plan, *part, at_s));
            }
        }
    }
}

fn value(plan: &Plan, part: Part, at_s: f64) -> f64 {
    match setpoint(plan, part, at_s) {
        Setpoint::Velocity { speed, .. } => speed.rpm().into(),
        Setpoint::Brake => 0.0,
        Setpoint::Current(current) => current.amps().into(),
        Setpoint::Position(position) => position.degrees().into(),
        Setpoint::OpenLoop(target) => target.raw().into(),
    }
}

fn setpoint(plan: &Plan, part: Part, at_s: f64) -> Setpoint {
    let (op, since_s, from) = match part {
        Part::Keeps(setpoint) => return setpoint,
        Part::Follows { op, since_s, from } => (op, since_s, from),
    };
    let Some(Op::Move(step)) = plan.program.get(op) else {
        return Setpoint::Brake;
    };
    match step.action {
        Action::Brake => Setpoint::Brake,
        Action::Follow {
            quantity,
            shape,
            acceleration,
        } => {
            let value = shape.value(from, at_s - since_s, step.seconds());
            match setpoint_of(quantity, value) {
                Setpoint::Velocity { speed, .. } => Setpoint::Velocity {
                    speed,
                    acceleration,
                },
                other => other,
            }
        }
    }
}
