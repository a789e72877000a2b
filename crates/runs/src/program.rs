//! The side that decides: the run with its plan and its record.

use std::time::Duration;

use motorlink_bus::{CommandRate, GroupSetpoints, SLEEP_MIN, Sample, Withheld};
use motorlink_experiments::{
    plan::{Fleet, Plan},
    runner::{self, Cause, Options, Phase, Runner, StartRefusal, Telemetry, Tick},
    sequence::Sequence,
};
use motorlink_messages::{
    decode,
    runs::{FromRun, NotArmed, ToRun},
};
use motorlink_protocol::{Detail, Instant, MotorId, Setpoint};

use crate::{
    cause::cause,
    exchange::{Act, Input, LineState, Output},
    report::Report,
};

/// Drive frames a second, at least: some motors end a command that is not repeated at this rate.
const RATE_MIN_HZ: u16 = 50;
/// A tick that is later than this ends a time without frames too late; then they go on by themselves.
const LATE_TICK: Duration = Duration::from_millis(100);

/// The runs: at most one is armed, running or paused.
#[derive(Debug, Default)]
pub struct Program {
    run: Option<Run>,
    messages: Vec<FromRun>,
}

#[derive(Debug)]
struct Run {
    number: u32,
    runner: Runner,
    rate: CommandRate,
    /// Whether the motors have been started.
    has_started: bool,
    /// What has been withheld since the last setpoints.
    withheld: Option<runner::Withheld>,
    wake: Option<Instant>,
    last_tick: Option<Instant>,
    report: Report,
}

impl Program {
    /// Handles an input.
    pub fn handle(&mut self, now: Instant, input: &Input) -> Output {
        let mut ticks = matches!(input, Input::Tick);
        if let Input::Message {
            bytes,
            is_old,
            line,
        } = input
        {
            // Page and worker are of one build, so a message can always be read.
            if let Ok(message) = decode(bytes) {
                self.message(now, message, *is_old, *line);
                ticks = true;
            }
        }
        let Some(run) = &mut self.run else {
            return Output {
                act: Act::Nothing,
                wake: None,
            };
        };
        match input {
            Input::Telemetry(sample) => run.runner.telemetry(run.telemetry(sample)),
            Input::Sent { at, id, setpoint } => run.sent(*at, *id, *setpoint),
            _ => {
                if let Some(cause) = cause(input, run.first()) {
                    run.runner.abort(now, cause);
                }
            }
        }
        let has_ended = matches!(run.runner.phase(), Phase::Ended(_));
        let act = if ticks || has_ended {
            run.tick(now)
        } else {
            Act::Nothing
        };
        run.report.update(now, &mut run.runner, &mut self.messages);
        Output {
            act,
            wake: run.wake,
        }
    }

    /// The messages for the page since the last call.
    pub fn take_messages(&mut self) -> Vec<FromRun> {
        std::mem::take(&mut self.messages)
    }

    fn message(&mut self, now: Instant, message: ToRun, is_old: bool, line: LineState) {
        match message {
            ToRun::Arm {
                run,
                sequence,
                fleet,
                options,
            } => match self.arm(now, run, &sequence, &fleet, options, line) {
                Ok(armed) => self.run = Some(armed),
                Err(reason) => self.messages.push(FromRun::NotArmed { run, reason }),
            },
            ToRun::Start { run } => {
                let armed = self.run.as_mut().filter(|armed| armed.number == run);
                let started = match armed {
                    // As a command: a page that hung delivers old clicks when it resumes.
                    Some(_) if is_old => Err(StartRefusal::TooLate),
                    Some(armed) => armed.runner.start(now),
                    None => Err(StartRefusal::NotArmed),
                };
                if let Err(refusal) = started {
                    self.messages.push(FromRun::NotStarted(refusal));
                }
            }
            message => {
                if let Some(run) = &mut self.run {
                    match message {
                        ToRun::Pause => run.runner.pause(now),
                        ToRun::Resume if !is_old => run.runner.resume(now),
                        ToRun::Abort => run.runner.abort(now, Cause::Stopped),
                        ToRun::FocusLost => run.runner.focus_lost(now),
                        _ => {}
                    }
                }
            }
        }
    }

    fn arm(
        &self,
        now: Instant,
        number: u32,
        sequence: &str,
        fleet: &Fleet,
        options: Options,
        line: LineState,
    ) -> Result<Run, NotArmed> {
        let phase = self.run.as_ref().map(|run| run.runner.phase());
        if matches!(phase, Some(Phase::Running | Phase::Paused)) {
            return Err(NotArmed::Running);
        }
        match line {
            LineState::NotConnected => return Err(NotArmed::NotConnected),
            LineState::Halted => return Err(NotArmed::Halted),
            LineState::Busy => return Err(NotArmed::Busy),
            LineState::Free => {}
        }
        let sequence =
            Sequence::from_json(sequence).map_err(|error| NotArmed::Sequence(error.to_string()))?;
        let plan =
            Plan::new(&sequence, fleet).map_err(|error| NotArmed::Sequence(error.to_string()))?;
        let runner = Runner::arm(plan, options, now);
        let wake = match runner.phase() {
            Phase::Armed { until } => Some(until),
            _ => None,
        };
        Ok(Run {
            number,
            runner,
            rate: rate(options.period),
            has_started: false,
            withheld: None,
            wake,
            last_tick: None,
            report: Report::new(number),
        })
    }
}

impl Run {
    fn tick(&mut self, now: Instant) -> Act {
        // The runner calls each gap late. A longer one was a sleep, as on the bus.
        let gap = self.last_tick.map(|last| now.since(last));
        if gap.is_some_and(|gap| gap > SLEEP_MIN) {
            self.runner.abort(now, Cause::Slept);
        }
        match self.runner.tick(now) {
            Tick::Idle => {
                let armed = matches!(self.runner.phase(), Phase::Armed { until } if now < until);
                self.wake = self.wake.filter(|_| armed);
                Act::Nothing
            }
            Tick::Stop(_) => {
                self.wake = None;
                Act::Stop
            }
            Tick::Drive { setpoints, next } => {
                self.ticked(now, next);
                self.withheld = None;
                self.drive(&setpoints)
            }
            Tick::Withhold {
                withheld,
                until,
                next,
            } => {
                self.ticked(now, next);
                self.withhold(now, withheld, until)
            }
        }
    }

    fn ticked(&mut self, now: Instant, next: Instant) {
        self.last_tick = Some(now);
        // A time that is not in the future would make a busy loop.
        self.wake = Some(next.max(now + Duration::from_micros(1)));
    }

    /// Once for each step: the bus withholds the frames until the next setpoints.
    fn withhold(&mut self, now: Instant, withheld: runner::Withheld, until: Instant) -> Act {
        if !self.has_started {
            return Act::Stop;
        }
        if self.withheld.replace(withheld) == Some(withheld) {
            return Act::Nothing;
        }
        Act::Withhold {
            // The end of the step comes with a tick, which may be late.
            time: until.since(now) + LATE_TICK,
            withheld: match withheld {
                runner::Withheld::DriveFrames => Withheld::DriveFrames,
                runner::Withheld::Requests => Withheld::Requests,
            },
        }
    }

    fn drive(&mut self, setpoints: &[(MotorId, Setpoint)]) -> Act {
        // A plan has 1 to 16 motors, each once: as many as a group.
        let Ok(setpoints) = GroupSetpoints::new(setpoints) else {
            return Act::Stop;
        };
        if std::mem::replace(&mut self.has_started, true) {
            // It never starts a motor: what was stopped stays so.
            return Act::Follow(setpoints);
        }
        let rate = self.rate;
        Act::Start { setpoints, rate }
    }

    fn telemetry(&self, sample: &Sample) -> Telemetry {
        let mut telemetry = Telemetry::of(sample.at, &sample.reply);
        // An idle motor reports its angle in steps of 1.4 degrees only. That is enough for the angle at which a run
        // begins; the record has the fine ones.
        if let (Phase::Armed { .. }, Detail::Query { position, .. }) =
            (self.runner.phase(), sample.reply.detail)
        {
            telemetry.degrees = Some(position.degrees());
        }
        telemetry
    }

    fn sent(&mut self, at: Instant, id: MotorId, setpoint: Setpoint) {
        let mut motors = self.runner.plan().motors().iter();
        if motors.any(|motor| motor.id == id) {
            self.runner.sent(at, id, setpoint);
        }
    }

    fn first(&self) -> MotorId {
        let first = self.runner.plan().motors().first();
        first.map_or(MotorId::FIRST, |motor| motor.id)
    }
}

/// The command rate of the bus during a run with this period.
fn rate(period: Duration) -> CommandRate {
    let micros = u64::try_from(period.as_micros()).unwrap_or(u64::MAX).max(1);
    let hertz = u16::try_from(1_000_000 / micros).unwrap_or(CommandRate::MAX);
    CommandRate::new(hertz.clamp(RATE_MIN_HZ, CommandRate::MAX)).unwrap_or_default()
}
