//! What the actions of a scenario do to the world, the page and the bus.

use std::time::Duration;

use motorlink_bus::{Command, StopReason};
use motorlink_protocol::Instant;
use motorlink_simulator::WireFaults;

use crate::action::{Action, LineFault, PendingInput};
use crate::rule::{Rule, Violation};
use crate::sequence_run::{Answers, SequenceRun};

use super::Player;

/// Shortest time between unplug and replug: a hand and the system need it. The adapter's buffer is
/// lost then.
const PULLED_OUT_FOR: Duration = Duration::from_millis(300);
/// After a call this late every setpoint is withdrawn.
const LATE_MAX: Duration = Duration::from_millis(500);

impl Player {
    pub(super) fn apply(&mut self, action: &Action) -> Result<(), Violation> {
        match action {
            Action::Command(command) if self.page_answers => self.command(self.now, *command)?,
            // It is delivered when the page resumes.
            Action::Command(command) => self.clicked.push((self.now, *command)),
            Action::Pause(duration) => self.run(*duration)?,
            Action::Line(line) => self.set_line(*line),
            Action::Power { id, on } => {
                if let Some(motor) = self.world.motor_mut(*id) {
                    motor.power(*on);
                }
            }
            Action::Load { id, tenths_nm } => {
                self.rules.loaded(*id);
                if let Some(motor) = self.world.motor_mut(*id) {
                    motor.set_load_nm(f32::from(*tenths_nm) / 10.0);
                }
            }
            Action::Heat { id, celsius } => {
                self.rules.heated(self.now);
                if let Some(motor) = self.world.motor_mut(*id) {
                    motor.set_temperature_c((*celsius).into());
                }
            }
            Action::PageHangs(true) => {
                self.page_answers = false;
                self.rules.page(self.now, false);
            }
            Action::PageHangs(false) => self.page_goes_on()?,
            Action::PageClosed => self.command(self.now, Command::StopAll(StopReason::PageGone))?,
            Action::Unplug => {
                if let Some(mut bus) = self.bus.take() {
                    if let Some(run) = &mut self.sequence {
                        run.unplugged(self.now, self.settings);
                    }
                    self.halted = bus.is_halted();
                    self.left_driven = bus.left_driven().collect();
                    for event in bus.close(self.now) {
                        self.rules.on_event(self.now, &event, &self.world)?;
                    }
                    self.rules.port_lost(self.now, &self.world);
                    self.run(PULLED_OUT_FOR)?;
                }
            }
            Action::Replug => {
                if self.bus.is_none() {
                    self.plug();
                }
            }
            Action::PageCrashes { back_after } => {
                self.lose_bus(*back_after)?;
                self.new_page();
            }
            Action::WorkerDies { back_after } => {
                self.lose_bus(*back_after)?;
                self.plug();
            }
            Action::AnotherComputer { back_after } => {
                self.lose_bus(*back_after)?;
                self.left_driven.clear();
                self.new_page();
                self.rules.knows_nothing(self.now);
            }
            Action::LineDies { lasts } => {
                self.world.set_faults(WireFaults {
                    lose_request: 1.0,
                    ..self.line.faults()
                });
                self.rules.line(self.now, None);
                self.run(*lasts)?;
                self.set_line(self.line);
                if let Some(bus) = &self.bus {
                    self.rules.line_back(self.now, bus, &self.world);
                }
            }
            Action::WorkerAbsent {
                duration, pending, ..
            } => self.away(*duration, pending)?,
            Action::PortRefuses { frames } => self.refuses = *frames,
            Action::PortTruncates {
                frames,
                bytes,
                reported,
            } => self.cuts = Some((*frames, usize::from(*bytes), *reported)),
            Action::RunSequence { seed } => {
                if self.sequence.as_ref().is_none_or(SequenceRun::is_over) {
                    self.sequence = SequenceRun::random(*seed, &self.motors, self.now);
                    self.runs.started += u64::from(self.sequence.is_some());
                }
            }
        }
        self.run(Duration::ZERO)
    }

    pub(super) fn set_line(&mut self, line: LineFault) {
        self.line = line;
        self.world.set_faults(line.faults());
        self.rules.line(self.now, Some(line));
    }

    /// The bus is gone at any moment and without a stop. What was remembered stays.
    pub(super) fn lose_bus(&mut self, back_after: Duration) -> Result<(), Violation> {
        self.sequence = None;
        if let Some(bus) = self.bus.take() {
            self.halted = bus.is_halted();
            self.rules.port_lost(self.now, &self.world);
        }
        self.run(back_after)
    }

    pub(super) fn new_page(&mut self) {
        self.clicked.clear();
        self.page_answers = true;
        self.rules.page(self.now, true);
        self.halted = false;
        self.plug();
    }

    /// No call reaches the bus for a while; then it gets the pending inputs in this order.
    pub(super) fn away(
        &mut self,
        duration: Duration,
        pending: &[PendingInput],
    ) -> Result<(), Violation> {
        self.now = self.now + duration;
        self.advance()?;
        let late = self
            .promised
            .map_or(Duration::ZERO, |promised| self.now.since(promised));
        let is_driven_late = self.bus.is_some() && late > LATE_MAX;
        self.rules.on_absence(self.now, is_driven_late, &self.world);
        self.rules.passed(self.now, &self.world)?;
        for turn in pending {
            self.note(|| format!("{turn:?}"));
            match turn {
                PendingInput::Pong => {
                    if let Some(bus) = self.bus.as_mut().filter(|_| self.page_answers) {
                        bus.page_answered(self.now);
                    }
                }
                PendingInput::Bytes => {
                    let chunks = std::iter::from_fn(|| self.world.receive(self.now));
                    let bytes: Vec<u8> = chunks.flat_map(|chunk| chunk.bytes).collect();
                    if !bytes.is_empty() {
                        self.hand_over(&bytes);
                    }
                }
                PendingInput::Poll => {
                    self.settle()?;
                }
                PendingInput::Command { command, age } if self.page_answers => {
                    self.issue(self.now - *age, *command)?;
                }
                PendingInput::Command { command, age } => {
                    self.clicked.push((self.now - *age, *command));
                }
            }
        }
        Ok(())
    }

    /// Delivers the clicks of the meantime, before or after the answer to the ping.
    pub(super) fn page_goes_on(&mut self) -> Result<(), Violation> {
        self.page_answers = true;
        self.rules.page(self.now, true);
        let clicked = std::mem::take(&mut self.clicked);
        let clicks_first = clicked.len().is_multiple_of(2);
        if !clicks_first && let Some(bus) = &mut self.bus {
            bus.page_answered(self.now);
        }
        for (given, command) in clicked {
            self.command(given, command)?;
        }
        if let Some(bus) = &mut self.bus {
            bus.page_answered(self.now);
        }
        Ok(())
    }

    /// A command of the operator, given at `given`. As in the worker, a command that is too old is
    /// dropped.
    pub(super) fn command(&mut self, given: Instant, command: Command) -> Result<(), Violation> {
        self.issue(given, command)?;
        self.run(Duration::ZERO)
    }

    pub(super) fn issue(&mut self, given: Instant, mut command: Command) -> Result<(), Violation> {
        if let Command::Configure(settings) = command {
            self.settings = settings;
            let run = self.sequence.as_ref();
            command = Command::Configure(run.map_or(settings, |run| run.settings(settings)));
        }
        if command.is_too_old(self.now.since(given)) {
            self.rules.judge(Rule::NoOldActs);
            return Ok(());
        }
        if self.bus.is_none() {
            return Ok(());
        }
        let mut ends_run = None;
        self.with_sequence(|run, now, bus, settings, _| match bus {
            Some(bus) => {
                let (input, answers) = run.before_command(now, command, bus, settings);
                ends_run = input;
                answers
            }
            None => Answers::new(),
        })?;
        if let Some(bus) = &mut self.bus {
            let answer = bus.command(self.now, command);
            self.rules
                .on_command(self.now, given, command, answer, bus, &self.world)?;
        }
        if let Some(input) = ends_run {
            self.with_sequence(|run, now, bus, settings, _| match bus {
                Some(bus) => run.after_command(now, input, bus, settings),
                None => Answers::new(),
            })?;
        }
        Ok(())
    }
}
