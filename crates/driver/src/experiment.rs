//! The run of an experiment, as the program that opened the driver goes through it.

use std::{
    fmt,
    time::{Duration, Instant},
};

use motorlink_bus::{Activity, Command};
use motorlink_experiments::runner::{End, Phase, StartRefusal};
use motorlink_messages::runs::{FromRun, NotArmed, RunState, ToRun};
use motorlink_runs::RecordedRun;

use crate::{
    driver::Driver,
    entry::{Entry, Status},
};

/// Time for the first replies after arming, and for the switch to the loop of the run.
const READY_MAX: Duration = Duration::from_secs(2);
/// Pause before the start is asked for again.
const READY_PAUSE: Duration = Duration::from_millis(50);

/// Why a run did not begin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotRun {
    /// It was not armed.
    NotArmed(NotArmed),
    /// The armed run was not started.
    NotStarted(StartRefusal),
}

impl fmt::Display for NotRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotArmed(NotArmed::NotConnected) => f.write_str("no port is open"),
            Self::NotArmed(NotArmed::Halted) => {
                f.write_str("the motors were stopped; release them first")
            }
            Self::NotArmed(NotArmed::Running) => f.write_str("another run is running"),
            Self::NotArmed(NotArmed::Busy) => f.write_str("something else is running"),
            Self::NotArmed(NotArmed::Sequence(error)) => f.write_str(error),
            Self::NotStarted(refusal) => refusal.fmt(f),
        }
    }
}

impl std::error::Error for NotRun {}

/// How far a run is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// It waits for the motors.
    Waiting,
    /// It runs.
    Running(RunState),
    /// It has ended, and its record is complete.
    Ended(End),
}

/// A run that is armed, or runs, on a driver. Give it every entry of the driver.
#[derive(Debug)]
pub struct Experiment {
    run: RecordedRun,
    start: Start,
    progress: Progress,
}

/// Whether the start was asked for.
#[derive(Clone, Copy, Debug)]
enum Start {
    No,
    /// It is asked for at this time, until that one.
    At(Instant, Instant),
    Asked(Instant),
    Done,
}

impl Experiment {
    /// Arms a run. Nothing moves.
    #[must_use]
    pub fn arm(driver: &Driver, run: RecordedRun) -> Self {
        driver.run(run.arm());
        Self {
            run,
            start: Start::No,
            progress: Progress::Waiting,
        }
    }

    /// A person has read what moves, and starts the run: the motors are switched to its loop, and driven when they report
    /// it.
    pub fn start(&mut self, driver: &Driver, status: &Status) {
        for motor in self.run.plan().motors() {
            let is_idle = |id| {
                let motor = status.motor(id);
                motor.filter(|motor| motor.activity == Activity::Idle)
            };
            if let Some(now) = is_idle(motor.id).and_then(|motor| motor.last)
                && now.reply.mode != motor.mode()
            {
                driver.command(Command::SwitchMode {
                    id: motor.id,
                    mode: motor.mode(),
                });
            }
        }
        let now = Instant::now();
        self.start = Start::At(now, now + READY_MAX);
    }

    /// Takes an entry, or nothing after a while without one. Says how far the run is.
    ///
    /// # Errors
    /// [`NotRun`]: the run does not begin.
    pub fn take(&mut self, driver: &Driver, entry: Option<&Entry>) -> Result<Progress, NotRun> {
        let now = Instant::now();
        if let Some(Entry::Run(message)) = entry {
            self.run.take(message);
            let number = self.run.header().number;
            match &**message {
                FromRun::NotArmed { run, reason } if *run == number => {
                    return Err(NotRun::NotArmed(reason.clone()));
                }
                FromRun::NotStarted(refusal) => self.refused(now, *refusal)?,
                FromRun::State(state) if state.run == number => match state.phase {
                    Phase::Running | Phase::Paused => {
                        self.start = Start::Done;
                        self.progress = Progress::Running(*state);
                    }
                    Phase::Ended(end) => self.progress = Progress::Ended(end),
                    Phase::Armed { .. } => {}
                },
                // Of another run, or data.
                _ => {}
            }
        }
        if let Start::At(at, until) = self.start
            && now >= at
        {
            self.start = Start::Asked(until);
            driver.run(self.run.start());
        }
        Ok(self.progress)
    }

    /// A motor that has just been asked or switched is ready a moment later.
    fn refused(&mut self, now: Instant, refusal: StartRefusal) -> Result<(), NotRun> {
        let is_soon_ready = matches!(
            refusal,
            StartRefusal::NotAnswering(_)
                | StartRefusal::NoAngle(_)
                | StartRefusal::OtherLoop { .. }
        );
        match self.start {
            Start::Asked(until) if is_soon_ready && now < until => {
                self.start = Start::At(now + READY_PAUSE, until);
                Ok(())
            }
            _ => Err(NotRun::NotStarted(refusal)),
        }
    }

    /// Records what an entry says, without looking further: that of an end that is under way.
    pub fn record(&mut self, entry: &Entry) {
        if let Entry::Run(message) = entry {
            self.run.take(message);
        }
    }

    /// Ends the run, and stops its motors.
    pub fn abort(&self, driver: &Driver) {
        driver.run(ToRun::Abort);
    }

    /// What was asked, and what is recorded.
    #[must_use]
    pub const fn run(&self) -> &RecordedRun {
        &self.run
    }
}
