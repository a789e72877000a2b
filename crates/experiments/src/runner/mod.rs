//! A run: armed, running, paused, ended.
//!
//! The owner of the bus calls [`Runner::telemetry`] for each reply, [`Runner::sent`] for each sent frame,
//! [`Runner::tick`] at the time that the last tick returned, and [`Runner::abort`] for each event that ends a run,
//! with a tick at once after it. The runner returns only setpoints: the bus chooses the frames, checks its own
//! limits, and stops the motors at [`Tick::Stop`].
//!
//! An ended run never continues. There is no command for it; another run needs another [`Runner::arm`].

mod cause;
mod cursor;
mod mirror;
mod record;
mod silent_steps;
mod watch;

use std::time::Duration;

use motorlink_protocol::{Instant, MotorId, Setpoint};

pub use cause::{Cause, End, ExceededLimit, StartRefusal};
pub use record::{Mark, Record, RecordPart, Sample, SentSetpoint};
pub use silent_steps::{SilentStep, SilentSteps, Withheld};
pub use watch::Telemetry;

use crate::plan::{Plan, PlanMotor};
use cursor::{Cursor, Progress};
use watch::Watch;

/// Maximal time between arming and the start, so that the user has just read what will move.
pub const ARMED_FOR: Duration = Duration::from_secs(60);
/// Longest gap between two ticks, as on the bus: after a longer one the setpoint is out of date.
pub const GAP_MAX: Duration = Duration::from_millis(500);
/// Maximal age of telemetry (rule 5 of the bus).
pub const FRESH_FOR: Duration = Duration::from_millis(500);
/// Longest pause. After that, the user has probably forgotten the run.
pub const PAUSE_MAX: Duration = Duration::from_secs(600);
/// Shortest period between setpoints: 500 a second, the maximum of a motor.
pub const PERIOD_MIN: Duration = Duration::from_millis(2);

/// The user's settings of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Options {
    /// Time between two setpoints of a motor.
    pub period: Duration,
    /// Whether the run ends when the page loses the focus or is hidden.
    pub stop_on_lost_focus: bool,
    /// The steps without drive frames.
    pub silent_steps: SilentSteps,
}

impl Default for Options {
    /// 200 setpoints a second; a lost focus does not end the run.
    fn default() -> Self {
        Self {
            period: Duration::from_millis(5),
            stop_on_lost_focus: false,
            silent_steps: SilentSteps::NONE,
        }
    }
}

/// The state of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Phase {
    /// A person has read what will move, and may start it until then.
    Armed {
        /// The end of that time.
        until: Instant,
    },
    /// Setpoints are sent.
    Running,
    /// Speeds and currents are zero, angles are held.
    Paused,
    /// Nothing is sent any more.
    Ended(End),
}

/// What to do now.
#[derive(Clone, Debug, PartialEq)]
pub enum Tick {
    /// Nothing: the run has not begun, or its stop was given before.
    Idle,
    /// Drive these motors, all as one group, and tick again at `next`.
    Drive {
        /// Every motor of the run.
        setpoints: Vec<(MotorId, Setpoint)>,
        /// The next tick.
        next: Instant,
    },
    /// Withhold frames of these motors, which keep their setpoints, until a step ends; tick again at `next`.
    Withhold {
        /// Which frames.
        withheld: Withheld,
        /// The end of the step.
        until: Instant,
        /// The next tick.
        next: Instant,
    },
    /// Stop every motor of the run. Given once.
    Stop(End),
}

/// One run of a plan.
#[derive(Clone, Debug)]
pub struct Runner {
    plan: Plan,
    options: Options,
    state: State,
    watch: Watch,
    record: Record,
}

#[derive(Clone, Debug)]
enum State {
    Armed { since: Instant },
    Running(Run),
    Paused { run: Run, since: Instant },
    Ended { end: End, reported: bool },
}

#[derive(Clone, Debug)]
struct Run {
    /// When the plan's time was zero; pauses move it.
    base: Instant,
    last_tick: Instant,
    /// The end of the last step without requests, so far: nothing was to be heard until then.
    unasked_until: Instant,
    cursor: Cursor,
}

impl Runner {
    /// Arms a run. Nothing moves.
    #[must_use]
    pub fn arm(plan: Plan, options: Options, now: Instant) -> Self {
        let period = options.period.max(PERIOD_MIN);
        let ids = plan.motors().iter().map(|motor| motor.id);
        Self {
            watch: Watch::of(ids),
            record: Record::default(),
            state: State::Armed { since: now },
            options: Options { period, ..options },
            plan,
        }
    }

    /// The plan: what will move, how far, and for how long. The user reads it before the start.
    #[must_use]
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The state of the run.
    #[must_use]
    pub fn phase(&self) -> Phase {
        match &self.state {
            State::Armed { since } => Phase::Armed {
                until: *since + ARMED_FOR,
            },
            State::Running(_) => Phase::Running,
            State::Paused { .. } => Phase::Paused,
            State::Ended { end, .. } => Phase::Ended(*end),
        }
    }

    /// The time of the plan, without pauses; `None` before the start and after the end.
    #[must_use]
    pub fn passed(&self, now: Instant) -> Option<Duration> {
        match &self.state {
            State::Running(run) => Some(now.since(run.base)),
            State::Paused { run, since } => Some(since.since(run.base)),
            State::Armed { .. } | State::Ended { .. } => None,
        }
    }

    /// The sent setpoints and the telemetry, kept after every end of the run.
    #[must_use]
    pub const fn record(&self) -> &Record {
        &self.record
    }

    /// Takes the new entries out of the record.
    pub fn take_part(&mut self) -> RecordPart {
        self.record.take_part()
    }

    /// Starts an armed run. Only the user may start it.
    ///
    /// # Errors
    /// [`StartRefusal`] tells what is missing; the run is unchanged then.
    pub fn start(&mut self, now: Instant) -> Result<(), StartRefusal> {
        let State::Armed { since } = self.state else {
            return Err(StartRefusal::NotArmed);
        };
        if now.since(since) > ARMED_FOR {
            return Err(StartRefusal::ArmedTooLongAgo);
        }
        let mut held = Vec::new();
        for motor in &self.plan.motors {
            held.push(self.watch.ready(motor, now)?);
        }
        self.record.began(now);
        self.state = State::Running(Run {
            base: now,
            last_tick: now,
            unasked_until: Instant::ZERO,
            cursor: Cursor::new(held),
        });
        Ok(())
    }

    /// Pauses a running run.
    pub fn pause(&mut self, now: Instant) {
        if let State::Running(run) = &self.state {
            let run = run.clone();
            self.state = State::Paused { run, since: now };
        }
    }

    /// Resumes a paused run at the setpoint where it was paused. Only the user may resume it.
    pub fn resume(&mut self, now: Instant) {
        if let State::Paused { run, since } = &self.state {
            let mut run = run.clone();
            run.base = run.base + now.since(*since);
            self.state = State::Running(run);
        }
    }

    /// Aborts the run for this cause, unless it has ended. The data is kept.
    pub fn abort(&mut self, now: Instant, cause: Cause) {
        self.end(End::Aborted { cause, at: now });
    }

    /// The page has lost the focus or is hidden.
    pub fn focus_lost(&mut self, now: Instant) {
        if self.options.stop_on_lost_focus {
            self.abort(now, Cause::FocusLost);
        }
    }

    /// A motor has replied. A fault, another loop or an exceeded limit ends the run.
    pub fn telemetry(&mut self, reply: Telemetry) {
        let Some(place) = self
            .plan
            .motors
            .iter()
            .position(|motor| motor.id == reply.id)
        else {
            return;
        };
        let mirrored = self.is_mirrored(reply.id);
        let reply = if mirrored { reply.reversed() } else { reply };
        let cause = self
            .plan
            .motors
            .get(place)
            .and_then(|motor| self.watch.receive(place, reply, motor, self.plan.limits));
        if matches!(self.state, State::Running(_) | State::Paused { .. }) {
            // Conditions are about the angle that the motor itself reports, the record has one sign for all.
            self.record.sample(if mirrored {
                reply.with_turned_angle()
            } else {
                reply
            });
            if let Some(cause) = cause {
                self.abort(reply.at, cause);
            }
        }
    }

    /// The port has taken the drive frame of a setpoint of the last tick, at this time.
    pub fn sent(&mut self, at: Instant, id: MotorId, setpoint: Setpoint) {
        if matches!(self.state, State::Running(_) | State::Paused { .. }) {
            let setpoint = if self.is_mirrored(id) {
                setpoint.reversed()
            } else {
                setpoint
            };
            self.record.sent(at, id, setpoint);
        }
    }

    fn is_mirrored(&self, id: MotorId) -> bool {
        let mut motors = self.plan.motors.iter();
        motors.any(|motor| motor.id == id && motor.mirrored)
    }

    /// Returns what to do now. An early or late call does not shift the plan.
    pub fn tick(&mut self, now: Instant) -> Tick {
        if let Some(cause) = self.overdue(now) {
            self.abort(now, cause);
        }
        let period = self.options.period;
        match &mut self.state {
            State::Armed { .. } | State::Ended { reported: true, .. } => Tick::Idle,
            State::Ended { end, reported } => {
                *reported = true;
                Tick::Stop(*end)
            }
            State::Paused { run, since } => {
                run.last_tick = now;
                let at_rest = run.cursor.paused(&self.plan, since.since(run.base));
                let setpoints = pairs(&self.plan.motors, &at_rest);
                let next = now + period;
                Tick::Drive { setpoints, next }
            }
            State::Running(run) => {
                run.last_tick = now;
                let passed = now.since(run.base);
                let watch = &self.watch;
                let began = |mark| self.record.mark(mark);
                match run
                    .cursor
                    .advance(&self.plan, run.base, passed, watch, began)
                {
                    Progress::Finished => {
                        self.end(End::Finished { at: now });
                        self.tick(now)
                    }
                    Progress::TimedOut { step } => {
                        self.abort(now, Cause::WaitTimedOut { step });
                        self.tick(now)
                    }
                    Progress::In { ends } => {
                        let step_ends = run.base + ends;
                        let silent = self.options.silent_steps.get(run.cursor.step());
                        if silent == Some(Withheld::Requests) {
                            run.unasked_until = step_ends;
                        }
                        if let Some(withheld) = silent.filter(|_| step_ends > now) {
                            return Tick::Withhold {
                                withheld,
                                until: step_ends,
                                next: next_on_grid(run.base, passed, period).min(step_ends),
                            };
                        }
                        let values = run.cursor.setpoints(&self.plan, passed);
                        let setpoints = pairs(&self.plan.motors, &values);
                        let grid = next_on_grid(run.base, passed, period);
                        let next = if step_ends > now {
                            grid.min(step_ends)
                        } else {
                            grid
                        };
                        Tick::Drive { setpoints, next }
                    }
                }
            }
        }
    }

    /// The cause that ends a run by time alone, if there is one.
    fn overdue(&self, now: Instant) -> Option<Cause> {
        let run = match &self.state {
            State::Armed { .. } | State::Ended { .. } => return None,
            State::Paused { since, .. } if now.since(*since) > PAUSE_MAX => {
                return Some(Cause::PausedTooLong);
            }
            State::Running(run) | State::Paused { run, .. } => run,
        };
        if now.since(run.last_tick) > GAP_MAX {
            return Some(Cause::Late);
        }
        let is_heard = now.since(run.unasked_until) > FRESH_FOR;
        let silent = self.watch.silent(now).filter(|_| is_heard);
        silent.map(Cause::Silent)
    }

    fn end(&mut self, end: End) {
        if !matches!(self.state, State::Ended { .. }) {
            // An armed run drives nothing, so there is nothing to stop.
            let reported = matches!(self.state, State::Armed { .. });
            self.record.ended(end);
            self.state = State::Ended { end, reported };
        }
    }
}

/// The setpoints with the signs of the wire.
fn pairs(motors: &[PlanMotor], setpoints: &[Setpoint]) -> Vec<(MotorId, Setpoint)> {
    let of_motor = |(motor, setpoint): (&PlanMotor, &Setpoint)| {
        let sent = if motor.mirrored {
            setpoint.reversed()
        } else {
            *setpoint
        };
        (motor.id, sent)
    };
    motors.iter().zip(setpoints).map(of_motor).collect()
}

/// The next of the times `base + n * period`. A late tick does not delay the later ones.
fn next_on_grid(base: Instant, passed: Duration, period: Duration) -> Instant {
    let micros = |time: Duration| u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
    let period = micros(period).max(1);
    let number = micros(passed) / period + 1;
    base + Duration::from_micros(number.saturating_mul(period))
}
