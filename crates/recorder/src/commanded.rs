//! What a motor was told, beside what it reports.

use std::time::Duration;

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_protocol::{Current, Frame, Instant, Mode, OpenLoopTarget, Position, Request, Rpm};

/// How long a drive frame counts as the command of the host, whatever the motor does when frames cease. At the lowest command rate, 1 Hz, the next one comes after a second; the rest is for a delayed line.
const COUNTS_FOR: Duration = Duration::from_millis(1_500);

/// Second byte of a drive frame.
const DRIVE: u8 = 0x64;

/// The setpoint of a drive frame, in the loop in which the motor reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Commanded {
    /// Bytes 2 and 3 of the frame.
    value: [u8; 2],
    pub(crate) mode: Mode,
}

/// A commanded value in its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CommandedValue {
    Speed(Rpm),
    Current(Current),
    Position(Position),
    OpenLoop(OpenLoopTarget),
}

impl Commanded {
    pub(crate) const fn value(self) -> CommandedValue {
        let signed = i16::from_be_bytes(self.value);
        match self.mode {
            Mode::Velocity => CommandedValue::Speed(Rpm::new(signed)),
            Mode::Current => CommandedValue::Current(Current::from_raw(signed)),
            Mode::OpenLoop => CommandedValue::OpenLoop(OpenLoopTarget::nearest(signed)),
            Mode::Position => {
                CommandedValue::Position(Position::from_raw(u16::from_be_bytes(self.value)))
            }
        }
    }
}

/// The last command of each motor.
#[derive(Clone, Debug, Default)]
pub(crate) struct Commands(Vec<Last>);

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

    /// Takes in a line event. Only drive frames and mode switches count.
    #[inline(never)]
    pub(crate) fn add_event(&mut self, event: &LineEvent) {
        let commanded = match event.kind {
            LineEventKind::Commanded { frame, mode } => Some((frame, mode)),
            kind => kind.sent(),
        };
        let Some((frame, mode)) = commanded else {
            return;
        };
        let (id, commanded) = match Request::parse(&frame) {
            // Without its loop, a value has no unit.
            Ok(Request::Drive { id, drive }) => {
                let value = drive.value;
                (id, mode.map(|mode| Commanded { value, mode }))
            }
            // The value before it was for another loop.
            Ok(Request::SwitchMode { id, .. }) => (id, None),
            _ => return,
        };
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
    pub(crate) fn at(&self, address: u8, at: Instant) -> Option<Commanded> {
        let last = self.last(address)?;
        last.commanded.filter(|_| at.since(last.at) <= COUNTS_FOR)
    }

    /// The command of a motor, by the marks of a saved recording.
    pub(crate) fn marked(&self, address: u8) -> Option<Commanded> {
        self.last(address)?.commanded
    }

    /// The mark to save before a sample with this command: a drive frame, if the marks before say otherwise.
    pub(crate) fn mark(
        &mut self,
        address: u8,
        at: Instant,
        commanded: Option<Commanded>,
    ) -> Option<LineEvent> {
        if self.marked(address) == commanded {
            return None;
        }
        self.set(Last {
            address,
            at,
            commanded,
        });
        let [high, low] = commanded.map_or([0; 2], |commanded| commanded.value);
        // With the acceleration spelled out: the zero frame to 0xC8 is the ID query otherwise.
        let frame = Frame::with_crc([address, DRIVE, high, low, 0, 0, 1, 0, 0]);
        let mode = commanded.map(|commanded| commanded.mode);
        let kind = LineEventKind::Sent { frame, mode };
        Some(LineEvent { at, kind })
    }

    /// Sets the times to another clock.
    pub(crate) fn set_clock(&mut self, mut at: impl FnMut(Instant) -> Instant) {
        for last in &mut self.0 {
            last.at = at(last.at);
        }
    }

    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{MotorId, Setpoint, SpeedTarget};

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
        commanded.map(Commanded::value)
    }

    #[test]
    fn a_command_is_the_last_drive_frame_for_as_long_as_such_frames_come() {
        let mut commands = Commands::default();
        assert_eq!(value(&commands, 0), None);
        commands.add_event(&drive(10, -100));
        let speed = Some(CommandedValue::Speed(Rpm::new(-100)));
        assert_eq!(value(&commands, 12), speed);
        commands.add_event(&sent(20, Request::Query { id: ID }, Some(Mode::Velocity)));
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
            commands.add_event(&drive(10, 50));
            commands.add_event(&ends);
            assert_eq!(value(&commands, 21), None, "{ends:?}");
        }
    }

    #[test]
    fn marks_tell_every_change_and_nothing_else() {
        let mut live = Commands::default();
        let (mut written, mut read) = (Commands::default(), Commands::default());
        let mut marks = 0;
        for n in 0..4_000 {
            if n < 2_000 {
                live.add_event(&drive(n, if n < 1_000 { 100 } else { -100 }));
            }
            let at = Instant::from_millis(n + 1);
            let commanded = live.at(ID.get(), at);
            if let Some(mark) = written.mark(ID.get(), at, commanded) {
                marks += 1;
                read.add_event(&mark);
            }
            assert_eq!(read.marked(ID.get()), commanded, "{n}");
        }
        assert_eq!(marks, 3, "+100, -100 and none");
    }

    #[test]
    fn a_mark_of_motor_200_is_no_id_query() {
        let (mut written, mut read) = (Commands::default(), Commands::default());
        let (value, mode) = ([0; 2], Mode::Velocity);
        let commanded = Some(Commanded { value, mode });
        for commanded in [commanded, None] {
            let mark = written.mark(0xC8, Instant::ZERO, commanded).unwrap();
            read.add_event(&mark);
            assert_eq!(read.marked(0xC8), commanded);
        }
    }
}
