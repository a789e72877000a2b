//! The runs beside a bus: what the owner of a port does with both.

use motorlink_bus::{self as bus, Bus, BusSettings, Command, Event, Refusal};
use motorlink_protocol::Instant;

use crate::{
    exchange::{Input, Output},
    host::Host,
    program::Program,
};

/// The side that decides, wherever it is.
pub trait Decides {
    /// Whether it can be called.
    fn is_there(&self) -> bool {
        true
    }

    /// Takes an input. Returns nothing if it has failed.
    fn decide(&mut self, now: Instant, input: &Input) -> Option<Output>;

    /// It has failed, and its motors have been stopped. It is not called again.
    fn has_failed(&mut self) {}
}

impl Decides for Program {
    fn decide(&mut self, now: Instant, input: &Input) -> Option<Output> {
        Some(self.handle(now, input))
    }
}

/// The side that decides, and what it drives.
#[derive(Debug, Default)]
pub struct Runs<P> {
    /// The side that decides.
    pub program: P,
    host: Host,
    /// When the port had taken the last frame.
    taken: Instant,
}

impl<P: Decides> Runs<P> {
    /// When the next tick is due.
    pub const fn wake(&self) -> Option<Instant> {
        self.host.wake()
    }

    /// Ticks if that is due. Call it before [`Self::poll`]: the bus then sends the setpoints of this moment.
    pub fn tick(&mut self, now: Instant, bus: &mut Bus, of_person: BusSettings) {
        if self.host.tick_due(now).is_some() {
            self.pass(now, Input::Tick, Some(bus), of_person);
        }
    }

    /// Gives the bus what a line without a reader has received, and polls it. The run hears of the event first.
    pub fn poll(
        &mut self,
        now: Instant,
        bus: &mut Bus,
        of_person: BusSettings,
        mut received: impl FnMut() -> Option<Vec<u8>>,
    ) -> bus::Output {
        while let Some(bytes) = received() {
            bus.receive(now, &bytes);
        }
        let output = bus.poll(now);
        if let bus::Output::Event(event) = &output {
            self.event(now, event, bus, of_person);
        }
        output
    }

    /// The port has taken a frame of the bus.
    pub const fn frame_taken(&mut self, at: Instant) {
        self.taken = at;
    }

    fn event(&mut self, now: Instant, event: &Event, bus: &mut Bus, of_person: BusSettings) {
        if let Some(mut input) = self.host.input_of(event, bus.model()) {
            if let Input::Sent { at, .. } = &mut input {
                *at = self.taken;
            }
            self.pass(now, input, Some(bus), of_person);
        }
    }

    /// The port is gone: no run goes on.
    pub fn closed(&mut self, now: Instant, input: Input, of_person: BusSettings) {
        if self.wake().is_some() {
            self.pass(now, input, None, of_person);
        }
    }

    /// Passes on a [`ToRun`](motorlink_messages::runs::ToRun); without a bus while nothing may be driven. `is_old`:
    /// the person's act is too old to start something.
    pub fn message(
        &mut self,
        now: Instant,
        (bytes, is_old): (Vec<u8>, bool),
        bus: Option<&mut Bus>,
        of_person: BusSettings,
    ) {
        let line = Host::line_state(now, bus.as_deref());
        let input = Input::Message {
            bytes,
            is_old,
            line,
        };
        self.pass(now, input, bus, of_person);
    }

    /// Gives a person's command to the bus. One that drives ends a run, whose motors are stopped first.
    ///
    /// # Errors
    /// As [`Bus::command`].
    pub fn command(
        &mut self,
        now: Instant,
        mut command: Command,
        bus: &mut Bus,
        of_person: BusSettings,
    ) -> Result<(), Refusal> {
        if let Command::Configure(settings) = command {
            command = Command::Configure(self.host.settings(settings));
        }
        let ends_run = self.host.ended_by(command);
        if let Some(Input::Driven(_)) = ends_run {
            self.host.stop(now, Some(bus), of_person);
        }
        let done = bus.command(now, command);
        if let Some(input) = ends_run {
            self.pass(now, input, Some(bus), of_person);
        }
        done
    }

    fn pass(&mut self, now: Instant, input: Input, bus: Option<&mut Bus>, of_person: BusSettings) {
        let Self { program, host, .. } = self;
        if program.is_there() {
            let call = |now, input: &Input| program.decide(now, input);
            if host.pass(now, input, bus, of_person, call).is_err() {
                program.has_failed();
            }
        }
    }
}
