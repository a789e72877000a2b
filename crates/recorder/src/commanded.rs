//! What a motor was told, beside what it reports.

use std::time::Duration;

use motorlink_bus::{CommandedValue, LineEvent};
use motorlink_protocol::{Acceleration, Drive, Instant, Mode, family::Model};

/// How long a drive frame counts as the command of the host, whatever the motor does when frames cease. At the lowest command rate, 1 Hz, the next one comes after a second; the rest is for a delayed line.
const COUNTS_FOR: Duration = Duration::from_millis(1_500);

/// The setpoint of a drive frame, in the loop in which the motor reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Commanded {
    /// Bytes 2 and 3 of the frame.
    pub value: [u8; 2],
    /// The loop.
    pub mode: Mode,
}

impl Commanded {
    /// The value in its unit, for a motor of this model.
    #[must_use]
    pub fn value(self, model: Model) -> CommandedValue {
        let drive = Drive {
            value: self.value,
            acceleration: Acceleration::DEFAULT,
            brake: 0,
        };
        CommandedValue::of(model, drive, self.mode)
    }
}

/// The last command of each motor.
#[derive(Clone, Debug, Default)]
pub struct Commands(Vec<Last>);

#[derive(Clone, Copy, Debug)]
struct Last {
    /// The motor's ID.
    address: u8,
    at: Instant,
    commanded: Option<Commanded>,
}

impl Commands {
    pub(crate) const fn new() -> Self {
        Self(Vec::new())
    }

    /// Takes in an event of a line of this model. Only drive frames, mode switches and what is known count.
    #[inline(never)]
    pub fn add_event(&mut self, model: Model, event: &LineEvent) {
        let Some((id, told)) = motorlink_bus::commanded(model, &event.kind) else {
            return;
        };
        // Without its loop, a value has no unit.
        let commanded = told.map(|(drive, mode)| {
            let value = drive.value;
            Commanded { value, mode }
        });
        self.set(Last {
            address: id.get(),
            at: event.at,
            commanded,
        });
    }

    fn set(&mut self, last: Last) {
        match self
            .0
            .iter_mut()
            .find(|known| known.address == last.address)
        {
            Some(known) => *known = last,
            None => self.0.push(last),
        }
    }

    fn last(&self, address: u8) -> Option<Last> {
        self.0.iter().find(|last| last.address == address).copied()
    }

    /// The command of a motor at this time.
    #[must_use]
    pub fn at(&self, address: u8, at: Instant) -> Option<Commanded> {
        let last = self.last(address)?;
        last.commanded.filter(|_| at.since(last.at) <= COUNTS_FOR)
    }

    /// The command of a motor, by the marks of a saved recording.
    pub(crate) fn marked(&self, address: u8) -> Option<Commanded> {
        self.last(address)?.commanded
    }

    /// Sets the times to another clock.
    pub(crate) fn set_clock(&mut self, mut at: impl FnMut(Instant) -> Instant) {
        for last in &mut self.0 {
            last.at = at(last.at);
        }
    }
}

#[cfg(test)]
mod tests {
    use motorlink_bus::LineEventKind;
    use motorlink_protocol::{MotorId, Request, Rpm, Setpoint, SpeedTarget};

    use super::*;

    const ID: MotorId = MotorId::FIRST;

    fn sent(millis: u64, request: Request, mode: Option<Mode>) -> LineEvent {
        let frame = request.frame();
        LineEvent {
            at: Instant::from_millis(millis),
            kind: LineEventKind::Sent { frame, mode },
        }
    }

    fn drive(millis: u64, rpm: i32) -> LineEvent {
        let setpoint = Setpoint::velocity(SpeedTarget::new(rpm).unwrap());
        sent(millis, Request::drive(ID, setpoint), Some(Mode::Velocity))
    }

    fn value(commands: &Commands, millis: u64) -> Option<CommandedValue> {
        let commanded = commands.at(ID.get(), Instant::from_millis(millis));
        commanded.map(|commanded| commanded.value(Model::Ddsm115))
    }

    #[test]
    fn a_command_is_the_last_drive_frame_for_as_long_as_such_frames_come() {
        let mut commands = Commands::default();
        assert_eq!(value(&commands, 0), None);
        commands.add_event(Model::Ddsm115, &drive(10, -100));
        let speed = Some(CommandedValue::Speed(Rpm::new(-100)));
        assert_eq!(value(&commands, 12), speed);
        commands.add_event(
            Model::Ddsm115,
            &sent(20, Request::Query { id: ID }, Some(Mode::Velocity)),
        );
        assert_eq!(value(&commands, 1_510), speed);
        assert_eq!(value(&commands, 1_511), None);
        assert_eq!(commands.at(2, Instant::from_millis(12)), None);
    }

    #[test]
    fn a_mode_switch_and_an_unknown_loop_end_a_command() {
        let mode = Mode::Current;
        for ends in [
            sent(20, Request::SwitchMode { id: ID, mode }, None),
            LineEvent {
                kind: match drive(20, 50).kind {
                    LineEventKind::Sent { frame, .. } => LineEventKind::Sent { frame, mode: None },
                    other => other,
                },
                ..drive(20, 50)
            },
        ] {
            let mut commands = Commands::default();
            commands.add_event(Model::Ddsm115, &drive(10, 50));
            commands.add_event(Model::Ddsm115, &ends);
            assert_eq!(value(&commands, 21), None, "{ends:?}");
        }
    }
}
