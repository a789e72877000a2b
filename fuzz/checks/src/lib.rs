//! What no input may do to the parts that read it, however hostile. Each function takes any bytes and
//! panics where a promise is broken.
//!
//! | function | what it reads | what it promises |
//! |---|---|---|
//! | [`decode`] | ten bytes of a wire | a reply or request that reads is written as the same bytes |
//! | [`resynchronise`] | any bytes of a wire, in any pieces | the next good reply but one is read |
//! | [`session_file`] | a file that a person opens as a session | records in bounded time and memory, or a refusal |
//!
//! `fuzz/` feeds them with what `cargo-fuzz` invents (`cargo xtask reliability fuzz`), `tests/corpus.rs` with
//! what is kept in `fuzz/corpus`. What the page reads is in `src/fuzzing.rs`, so that this crate does not compile the
//! page a second time.
#![allow(
    clippy::panic,
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a promise that is broken is told by a panic"
)]

mod session;

use std::time::Duration;

pub use session::session_file;

use motorlink_bus::{Bus, Command, Event, Output};
use motorlink_protocol::{
    Celsius, CoarsePosition, Current, Detail, FRAME_LEN, Faults, Frame, Instant, Layout, Mode,
    MotorId, Reply, Request, Rpm,
};

/// The decoder of frames.
pub fn decode(bytes: &[u8]) {
    for ten in bytes.windows(FRAME_LEN) {
        let frame = Frame::new(<[u8; FRAME_LEN]>::try_from(ten).unwrap());
        for asked in [None, Some(Layout::Drive), Some(Layout::Query)] {
            if let Ok(reply) = Reply::decode(&frame, asked) {
                assert_eq!(reply.frame(), frame);
                assert!(frame.crc_holds());
            }
        }
        if let Ok(request) = Request::parse(&frame) {
            assert_eq!(Request::parse(&request.frame()), Ok(request));
        }
        let written: Frame = frame.to_string().parse().unwrap();
        assert_eq!(written, frame);
    }
}

/// Three exchanges: the first may still meet what came before.
const GOOD_REPLIES: i16 = 3;
/// From a request to its reply.
const TURNAROUND: Duration = Duration::from_micros(2_336);
/// The longest that the bus takes from one question to the next, a silent motor's.
const PATIENCE: Duration = Duration::from_secs(3);

/// The bus on a line that carries anything. The first byte of each piece says how long it is and how many
/// milliseconds pass before it.
pub fn resynchronise(bytes: &[u8]) {
    let mut wire = Wire::new();
    let mut rest = bytes;
    while let Some((head, behind)) = rest.split_first() {
        let (length, pause) = (usize::from(head & 31), u64::from(head >> 5));
        let (piece, behind) = behind.split_at(length.min(behind.len()));
        wire.pass(Duration::from_millis(pause));
        wire.bus.receive(wire.now, piece);
        rest = behind;
    }
    // No reply comes in one piece with what came long before it.
    wire.pass(Duration::from_millis(100));
    wire.read.clear();
    for number in 1..=GOOD_REPLIES {
        wire.answer(number);
    }
    let next_but_one = wire.read.contains(&2);
    assert!(
        next_but_one,
        "of the replies 1, 2, 3 only {:?} were read",
        wire.read
    );
}

struct Wire {
    now: Instant,
    bus: Bus,
    asked: Option<Instant>,
    /// The speeds that were read.
    read: Vec<i16>,
}

impl Wire {
    fn new() -> Self {
        let now = Instant::from_millis(1_000);
        let mut bus = Bus::new(now);
        bus.command(now, Command::Watch(MotorId::FIRST)).unwrap();
        Self {
            now,
            bus,
            asked: None,
            read: Vec::new(),
        }
    }

    /// Does what is due now; gives when the next is.
    fn settle(&mut self) -> Instant {
        for _ in 0..10_000 {
            match self.bus.poll(self.now) {
                Output::Transmit(frame) => {
                    let asks = matches!(Request::parse(&frame), Ok(Request::Query { .. }));
                    assert!(asks, "{frame} was sent, and nobody asked for it");
                    self.asked = Some(self.now);
                }
                Output::Event(Event::PingPage) => self.bus.page_answered(self.now),
                Output::Event(Event::Telemetry(sample)) => {
                    self.read.extend(sample.reply.speed.map(Rpm::rpm));
                }
                Output::Event(_) => {}
                Output::Wait(at) => return at,
            }
        }
        panic!("the bus never rests");
    }

    fn pass(&mut self, time: Duration) {
        let end = self.now + time;
        loop {
            let next = self.settle().min(end);
            self.now = next.max(self.now);
            if self.now >= end {
                self.settle();
                return;
            }
        }
    }

    /// Waits for the next question, and answers it by a good reply.
    fn answer(&mut self, rpm: i16) {
        self.asked = None;
        let until = self.now + PATIENCE;
        while self.asked.is_none() && self.now < until {
            self.pass(Duration::from_micros(500));
        }
        let asked = self.asked.unwrap();
        let reply = Reply {
            id: MotorId::FIRST,
            mode: Mode::Velocity,
            current: Some(Current::from_raw(0)),
            speed: Some(Rpm::new(rpm)),
            detail: Detail::Query {
                temperature: Celsius::new(28),
                position: CoarsePosition::from_raw(0),
            },
            faults: Faults::NONE,
        };
        self.pass((asked + TURNAROUND).since(self.now));
        self.bus.receive(self.now, reply.frame().bytes());
        self.settle();
    }
}
