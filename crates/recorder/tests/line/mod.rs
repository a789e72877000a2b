//! Line events for the tests of the recorder.

use std::ops::Range;

use motorlink_bus::{JunkBytes, LineEvent, LineEventKind};
use motorlink_messages::recorder::{Filter, Kind, LogPage, Row, Window};
use motorlink_protocol::{
    Current, Detail, Faults, Frame, Instant, Layout, Mode, MotorId, Position, Reply, Request, Rpm,
    Setpoint, SpeedTarget,
};
use motorlink_recorder::{Log, WallClock};

/// 2026-11-21 13:15:36.962 UTC at [`Instant::ZERO`].
pub const CLOCK: WallClock = WallClock::new(1_795_266_936_962.0, 0);

/// Every row that a page may ask for.
pub const ALL: Window = Window {
    first: None,
    rows: Window::ROWS_MAX,
};

/// The time of a line that is the only one.
pub const ALWAYS: Range<Instant> = Instant::ZERO..Instant::from_micros(u64::MAX);

pub fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

/// A line event at this time in milliseconds.
pub fn at(millis: u64, passed: LineEventKind) -> LineEvent {
    LineEvent {
        at: Instant::from_millis(millis),
        kind: passed,
    }
}

pub fn sent(request: Request) -> LineEventKind {
    LineEventKind::Sent {
        frame: request.frame(),
        mode: Some(Mode::Velocity),
    }
}

/// The first frame of a Send, and its repetitions.
pub fn by_hand(request: Request) -> [LineEventKind; 2] {
    let (frame, mode) = (request.frame(), Some(Mode::Velocity));
    [
        LineEventKind::SentByHand { frame, mode },
        LineEventKind::RepeatedByHand { frame, mode },
    ]
}

pub fn query(address: u8) -> LineEventKind {
    sent(Request::Query { id: id(address) })
}

pub fn drive(address: u8, rpm: i32) -> LineEventKind {
    let setpoint = Setpoint::velocity(SpeedTarget::new(rpm).unwrap());
    sent(Request::drive(id(address), setpoint))
}

/// A reply at 50 rpm to a drive frame.
pub fn reply(address: u8, position: u16) -> LineEventKind {
    let reply = Reply {
        id: id(address),
        mode: Mode::Velocity,
        current: Some(Current::from_raw(717)),
        speed: Some(Rpm::new(50)),
        detail: Detail::Drive {
            position: Position::from_raw(position),
        },
        faults: Faults::NONE,
    };
    heard(reply.frame(), Some(Layout::Drive))
}

pub fn heard(frame: Frame, asked: Option<Layout>) -> LineEventKind {
    LineEventKind::Received { frame, asked }
}

pub fn junk(bytes: &[u8]) -> LineEventKind {
    LineEventKind::Junk(JunkBytes::new(bytes))
}

pub fn silence(address: u8) -> LineEventKind {
    LineEventKind::Silence {
        id: id(address),
        waited_us: 8_000,
    }
}

/// The n-th frame of a line on which motor 1 is driven and queried, one frame a millisecond.
pub fn driven(n: u64) -> LineEvent {
    let position = u16::try_from(n * 91 % 32_768).unwrap();
    at(
        n,
        match n % 100 {
            0 => query(1),
            n if n % 2 == 0 => drive(1, 50),
            _ => reply(1, position),
        },
    )
}

/// A log with room for this number of entries, with [`CLOCK`].
pub fn log(capacity: u64) -> Log {
    let mut log = Log::with_capacity(capacity);
    log.set_clock(CLOCK);
    log
}

/// The newest rows, at most [`Window::ROWS_MAX`].
pub fn newest(log: &Log) -> LogPage {
    log.page(ALL)
}

pub fn meanings(rows: &[Row]) -> Vec<&str> {
    rows.iter().map(|row| row.meaning.as_str()).collect()
}

pub fn text(text: &str) -> Filter {
    Filter {
        text: text.into(),
        ..Filter::default()
    }
}

pub fn of_kind(kind: Kind) -> Filter {
    Filter {
        kind: Some(kind),
        ..Filter::default()
    }
}

pub fn collapsed() -> Filter {
    Filter {
        collapse: true,
        ..Filter::default()
    }
}

/// Completes a filter.
pub fn finish(log: &mut Log) {
    while !log.advance(997) {}
}
