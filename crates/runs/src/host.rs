//! The side of the port: applies what the program returns to the bus.

use std::time::Duration;

use motorlink_bus::{
    Activity, Bus, BusSettings, Command, CommandRate, Consent, Event, GroupSetpoints, LineEvent,
    LineEventKind, Refusal, StopReason, Withheld, commanded, commanded_setpoint,
};
use motorlink_protocol::{Instant, MotorId, family::Model};

use crate::exchange::{Act, Input, LineState, Output};

/// A tick this near is due, as a deadline of the bus. Otherwise the bus would send the setpoint before once more just
/// before the tick, and the new one would wait until the line is free.
const EARLY: Duration = Duration::from_micros(100);

/// What a run does on the line. The bus implements it; the fault simulation looks on.
pub trait Line {
    /// See [`Bus::command`].
    ///
    /// # Errors
    /// As there.
    fn command(&mut self, now: Instant, command: Command) -> Result<(), Refusal>;

    /// See [`Bus::follow_plan`].
    ///
    /// # Errors
    /// As there.
    fn follow_plan(&mut self, now: Instant, setpoints: &GroupSetpoints) -> Result<(), Refusal>;

    /// See [`Bus::withhold`].
    ///
    /// # Errors
    /// As there.
    fn withhold(
        &mut self,
        now: Instant,
        id: MotorId,
        time: Duration,
        withheld: Withheld,
    ) -> Result<(), Refusal>;

    /// Whether the motor is driven.
    fn drives(&self, now: Instant, id: MotorId) -> bool;
}

impl Line for Bus {
    fn command(&mut self, now: Instant, command: Command) -> Result<(), Refusal> {
        self.command(now, command)
    }

    fn follow_plan(&mut self, now: Instant, setpoints: &GroupSetpoints) -> Result<(), Refusal> {
        self.follow_plan(now, setpoints)
    }

    fn withhold(
        &mut self,
        now: Instant,
        id: MotorId,
        time: Duration,
        withheld: Withheld,
    ) -> Result<(), Refusal> {
        self.withhold(now, id, time, withheld)
    }

    fn drives(&self, now: Instant, id: MotorId) -> bool {
        let mut motors = self.motors(now);
        motors.any(|motor| {
            let stands = matches!(motor.activity, Activity::Idle | Activity::Stopping { .. });
            motor.id == id && !stands
        })
    }
}

/// The program has failed. Its motors have been stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failed;

/// What the owner of the port knows of the run.
#[derive(Debug, Default)]
pub struct Host {
    wake: Option<Instant>,
    driving: Option<Driving>,
}

/// The motors that the run drives.
#[derive(Debug)]
struct Driving {
    motors: GroupSetpoints,
    rate: CommandRate,
}

impl Host {
    /// When [`Input::Tick`] is due. `None` while no run is armed, running or paused.
    #[must_use]
    pub const fn wake(&self) -> Option<Instant> {
        self.wake
    }

    /// The time of [`Input::Tick`], if it is due. The tick is not given a time before its own: then it would be due again.
    #[must_use]
    pub fn tick_due(&self, now: Instant) -> Option<Instant> {
        let due = self.wake.filter(|wake| *wake <= now + EARLY);
        due.map(|wake| wake.max(now))
    }

    /// The settings of the bus: those of the person, but for the rate and the ramp while a run drives.
    ///
    /// The ramp would distort the plan, and the person has read in the arm step how fast its setpoints grow. The limits
    /// stay in force.
    #[must_use]
    pub fn settings(&self, of_person: BusSettings) -> BusSettings {
        match &self.driving {
            Some(driving) => BusSettings {
                rate: driving.rate,
                ramp: None,
                ..of_person
            },
            None => of_person,
        }
    }

    /// The state of the line, for a message of the page.
    #[must_use]
    pub fn line_state(now: Instant, bus: Option<&Bus>) -> LineState {
        let Some(bus) = bus else {
            return LineState::NotConnected;
        };
        if bus.is_halted() {
            LineState::Halted
        } else if bus.is_active(now) || bus.job().is_some() {
            LineState::Busy
        } else {
            LineState::Free
        }
    }

    /// Passes an input to the program by `call`, and does what it returns. `call` returns nothing if the program fails.
    ///
    /// # Errors
    /// [`Failed`]: the program failed, and the motors of the run are being stopped.
    pub fn pass(
        &mut self,
        now: Instant,
        mut input: Input,
        mut bus: Option<&mut impl Line>,
        of_person: BusSettings,
        mut call: impl FnMut(Instant, &Input) -> Option<Output>,
    ) -> Result<(), Failed> {
        // A refused setpoint ends the run, so the second answer is a stop.
        for _ in 0..2 {
            let at = match input {
                Input::Tick => self.tick_due(now).unwrap_or(now),
                _ => now,
            };
            let Some(output) = call(at, &input) else {
                break;
            };
            self.wake = output.wake;
            let driven = match (output.act, &mut bus) {
                (Act::Start { setpoints, rate }, Some(bus)) => {
                    self.start(now, &mut **bus, of_person, setpoints, rate)
                }
                (Act::Follow(setpoints), Some(bus)) if self.driving.is_some() => {
                    bus.follow_plan(now, &setpoints)
                }
                (Act::Withhold { time, withheld }, Some(bus)) => match &self.driving {
                    Some(driving) => {
                        let mut entries = driving.motors.entries();
                        entries.try_for_each(|(id, _)| bus.withhold(now, id, time, withheld))
                    }
                    None => Err(Refusal::Halted),
                },
                // Without a port, or after the motors were stopped, nothing is driven.
                (Act::Start { .. } | Act::Follow(_) | Act::Withhold { .. }, _) => {
                    Err(Refusal::Halted)
                }
                (Act::Nothing, _) => Ok(()),
                (Act::Stop, _) => {
                    self.stop(now, bus.as_deref_mut(), of_person);
                    Ok(())
                }
            };
            match driven {
                Ok(()) => return Ok(()),
                Err(refusal) => input = Input::Refused(refusal),
            }
        }
        self.wake = None;
        self.stop(now, bus, of_person);
        Err(Failed)
    }

    fn start(
        &mut self,
        now: Instant,
        bus: &mut impl Line,
        of_person: BusSettings,
        setpoints: GroupSetpoints,
        rate: CommandRate,
    ) -> Result<(), Refusal> {
        let consent = Consent::None;
        bus.command(now, Command::DriveGroup { setpoints, consent })?;
        let motors = setpoints;
        self.driving = Some(Driving { motors, rate });
        bus.command(now, Command::Configure(self.settings(of_person)))
    }

    /// Stops the motors of the run that are still driven, and restores the person's settings. Does not ask the program.
    pub fn stop(&mut self, now: Instant, bus: Option<&mut impl Line>, of_person: BusSettings) {
        let (Some(driving), Some(bus)) = (self.driving.take(), bus) else {
            return;
        };
        for (id, _) in driving.motors.entries() {
            if bus.drives(now, id) {
                // A stop is never refused.
                let _: Result<(), Refusal> = bus.command(now, Command::Stop(id));
            }
        }
        // Neither are settings.
        let _: Result<(), Refusal> = bus.command(now, Command::Configure(of_person));
    }

    /// The input that a person's command is for the run, if a run is there and the command ends it. If the command drives,
    /// call [`stop`](Self::stop) before the bus takes it; pass the input after the bus has taken it.
    #[must_use]
    pub fn ended_by(&self, command: Command) -> Option<Input> {
        self.wake?;
        match command {
            Command::StopAll(reason) => Some(Input::StopBegan(reason)),
            Command::Stop(_) | Command::Hold(_) => Some(Input::StopBegan(StopReason::OneMotor)),
            Command::IdQuery | Command::FullScan => Some(Input::StopBegan(StopReason::Job)),
            // Before the start, a person may still switch the loop: the start asks for the right one.
            Command::SwitchMode { .. } if self.driving.is_none() => None,
            Command::Start { id, .. }
            | Command::Drive { id, .. }
            | Command::Adjust { id, .. }
            | Command::SwitchMode { id, .. } => Some(Input::Driven(Some(id))),
            Command::StartGroup { .. }
            | Command::DriveGroup { .. }
            | Command::AdjustGroup { .. }
            | Command::SetId { .. }
            | Command::SendRaw { .. } => Some(Input::Driven(None)),
            Command::Watch(_)
            | Command::Forget(_)
            | Command::CancelJob
            | Command::StopRaw
            | Command::Configure(_)
            | Command::Release => None,
        }
    }

    /// The input that an event of the bus is for the run, if a run is there and the event concerns it.
    #[must_use]
    pub fn input_of(&self, event: &Event, model: Model) -> Option<Input> {
        self.wake?;
        match event {
            Event::Telemetry(sample) => Some(Input::Telemetry(*sample)),
            Event::Withdrawn { id, reason } => Some(Input::Withdrawn(*id, *reason)),
            Event::StopBegan(reason) => Some(Input::StopBegan(*reason)),
            Event::Line(LineEvent { at, kind }) if matches!(kind, LineEventKind::Sent { .. }) => {
                let (id, told) = commanded(model, kind)?;
                let (drive, mode) = told?;
                let (at, setpoint) = (*at, commanded_setpoint(model, drive, mode));
                Some(Input::Sent { at, id, setpoint })
            }
            _ => None,
        }
    }
}
