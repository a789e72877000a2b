//! The run of an experiment beside the bus.

use motorlink_bus::{Bus, BusSettings, Command, Event};
use motorlink_messages::{
    encode,
    runs::{FromRun, ToRun},
};
use motorlink_protocol::Instant;
use motorlink_runs::{Host, Input, Program};

/// The program that decides, and what it drives.
#[derive(Debug, Default)]
pub(crate) struct Runs {
    program: Program,
    host: Host,
    /// Fails at every call, for tests.
    #[cfg(test)]
    pub(crate) fails: bool,
}

impl Runs {
    /// When the next tick is due.
    pub(crate) const fn wake(&self) -> Option<Instant> {
        self.host.wake()
    }

    /// The settings of the bus: see [`Host::settings`].
    pub(crate) fn settings(&self, of_program: BusSettings) -> BusSettings {
        self.host.settings(of_program)
    }

    /// Ticks if that is due.
    pub(crate) fn tick(&mut self, now: Instant, bus: &mut Bus, settings: BusSettings) {
        #[cfg(test)]
        assert!(!self.fails, "asked for by a test");
        if self.host.tick_due(now).is_some() {
            self.pass(now, Input::Tick, Some(bus), settings);
        }
    }

    /// Passes on an event of the bus that concerns a run.
    pub(crate) fn event(
        &mut self,
        now: Instant,
        event: &Event,
        bus: &mut Bus,
        settings: BusSettings,
    ) {
        if let Some(input) = self.host.input_of(event, bus.model()) {
            self.pass(now, input, Some(bus), settings);
        }
    }

    /// The port is gone: no run goes on.
    pub(crate) fn unplugged(&mut self, now: Instant, settings: BusSettings) {
        if self.wake().is_some() {
            self.pass(now, Input::Unplugged, None, settings);
        }
    }

    /// Passes on a message of the program that opened the driver; without a bus while nothing may be driven.
    pub(crate) fn message(
        &mut self,
        now: Instant,
        message: &ToRun,
        is_old: bool,
        bus: Option<&mut Bus>,
        settings: BusSettings,
    ) {
        let input = Input::Message {
            // A message of ours always encodes.
            bytes: encode(message).unwrap_or_default(),
            is_old,
            line: Host::line_state(now, bus.as_deref()),
        };
        self.pass(now, input, bus, settings);
    }

    /// Gives a command to the bus. One that drives ends a run, whose motors are stopped first.
    ///
    /// # Errors
    /// As [`Bus::command`].
    pub(crate) fn command(
        &mut self,
        now: Instant,
        mut command: Command,
        bus: &mut Bus,
        settings: BusSettings,
    ) -> Result<(), motorlink_bus::Refusal> {
        if let Command::Configure(_) = command {
            command = Command::Configure(self.settings(settings));
        }
        let ends_run = self.host.ended_by(command);
        if let Some(Input::Driven(_)) = ends_run {
            self.host.stop(now, Some(bus), settings);
        }
        let done = bus.command(now, command);
        if let Some(input) = ends_run {
            self.pass(now, input, Some(bus), settings);
        }
        done
    }

    /// What the program of the runs says since the last call.
    pub(crate) fn take_messages(&mut self) -> Vec<FromRun> {
        self.program.take_messages()
    }

    fn pass(&mut self, now: Instant, input: Input, bus: Option<&mut Bus>, settings: BusSettings) {
        let Self { program, host, .. } = self;
        let call = |now, input: &Input| Some(program.handle(now, input));
        // The program is part of this one. If it fails, the thread does, which stops the motors.
        let _ = host.pass(now, input, bus, settings, call);
    }
}
