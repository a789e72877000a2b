//! What outlives a port: the settings of the person, Stop all motors, and the runs.

use motorlink_bus::{Bus, BusSettings, Command, Event, Output, Refusal};
use motorlink_protocol::{Instant, MotorId, family::Model};
use motorlink_runs::{Decides, Input, Runs};

use crate::{
    host::{Host, Turned},
    line::{Line, Written},
};

/// What stays the same while ports are opened, lost and closed. The commands of the person or of the program reach the bus
/// through it.
#[derive(Debug, Default)]
pub struct PortControl<P> {
    /// What the person has set.
    pub settings: BusSettings,
    /// Whether Stop all motors is in effect. It stays so after the port is closed.
    pub is_halted: bool,
    /// The runs.
    pub runs: Runs<P>,
}

/// Why a command is not done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotDone {
    /// No port is open that may be driven.
    NotConnected,
    /// The bus refuses it.
    Refused(Refusal),
}

impl<P: Decides> PortControl<P> {
    /// A bus on which nothing drives. It sends the ID query first if `asks_for_id`, and asks the `watched` motors.
    pub fn new_bus(
        &self,
        now: Instant,
        model: Model,
        asks_for_id: bool,
        watched: impl IntoIterator<Item = MotorId>,
    ) -> Bus {
        let mut bus = Bus::with_model(now, model);
        if self.is_halted {
            bus = bus.into_halted();
        }
        bus.prepared(now, self.settings, asks_for_id, watched)
    }

    /// Does everything that is due; `clock` says when the port has taken a frame. `remember` is called whenever the bus may
    /// have changed, and before each frame: a process that is killed after the frame leaves a file that names its motor.
    pub fn turn<L: Line>(
        &mut self,
        now: Instant,
        mut clock: impl FnMut() -> Instant,
        host: &mut Host<L>,
        mut remember: impl FnMut(&Bus),
        mut tell: impl FnMut(&Bus, Event),
    ) -> Turned {
        let Self { settings, runs, .. } = self;
        let Host { bus, line } = host;
        runs.tick(now, bus, *settings);
        let turned = loop {
            let output = runs.poll(now, bus, *settings, || line.take_received(now));
            remember(bus);
            match output {
                Output::Transmit(frame) => match line.write(now, bus.model(), &frame) {
                    Written::Taken => runs.frame_taken(clock()),
                    Written::Refused => bus.transmit_failed(),
                    Written::Gone => {
                        bus.transmit_failed();
                        break Turned::Gone;
                    }
                },
                Output::Event(event) => tell(bus, event),
                Output::Wait(at) => {
                    let others = [line.next_event(), runs.wake()];
                    break Turned::Wait(others.into_iter().flatten().fold(at, Instant::min));
                }
            }
        };
        // The bus stops all motors by itself after a silence of the program or a sleep of the computer.
        self.is_halted |= bus.is_halted();
        turned
    }

    /// Gives a command to the bus of the open port. Nothing may move before the port is settled.
    ///
    /// # Errors
    /// [`NotDone`].
    pub fn command(
        &mut self,
        now: Instant,
        command: Command,
        bus: Option<&mut Bus>,
        is_settled: bool,
    ) -> Result<(), NotDone> {
        match command {
            Command::Configure(settings) => self.settings = settings,
            Command::StopAll(_) => self.is_halted = true,
            Command::Release => self.is_halted = false,
            _ => {}
        }
        match (bus, command) {
            (Some(bus), _) if is_settled || !command.may_move() => {
                let done = self.runs.command(now, command, bus, self.settings);
                done.map_err(NotDone::Refused)
            }
            // They hold for the next port.
            (None, Command::Configure(_) | Command::StopAll(_) | Command::Release) => Ok(()),
            _ => Err(NotDone::NotConnected),
        }
    }

    /// The port is closed or gone, as `why` says: no run goes on.
    pub fn closed(&mut self, now: Instant, why: Input) {
        self.runs.closed(now, why, self.settings);
    }
}
