//! A motor that is driven 500 times a second for an hour.

use std::time::Duration;

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_protocol::{Frame, Instant, Layout, Mode, MotorId, Request, Setpoint, SpeedTarget};
use motorlink_simulator::{World, WorldConfig};

const EXCHANGES: u64 = 3_600 * 500;
const PERIOD_US: u64 = 2_000;

/// What passes on the line: the simulator's motor, at times as a browser tells them.
pub struct Line {
    world: World,
    seed: u64,
    n: u64,
    reply: Option<LineEvent>,
}

impl Line {
    pub fn new() -> Self {
        let world = World::new(WorldConfig {
            turnaround: Duration::from_micros(100),
            ..WorldConfig::default()
        });
        Self {
            world,
            seed: 88_172_645_463_325_252,
            n: 0,
            reply: None,
        }
    }

    /// A browser's clock has steps of 100 us, and its messages come up to two of them late.
    fn seen_at(&mut self, us: u64) -> Instant {
        self.seed ^= self.seed << 13;
        self.seed ^= self.seed >> 7;
        self.seed ^= self.seed << 17;
        let late = self.seed % 3;
        Instant::from_micros((us / 100 + late) * 100)
    }
}

impl Iterator for Line {
    type Item = LineEvent;

    fn next(&mut self) -> Option<LineEvent> {
        if let Some(reply) = self.reply.take() {
            return Some(reply);
        }
        if self.n == EXCHANGES {
            return None;
        }
        let us = self.n * PERIOD_US;
        // A new speed each four seconds.
        let rpm = i32::try_from(self.n / 2_000 % 7).ok()? * 40 - 120;
        let query = self.n.is_multiple_of(100);
        self.n += 1;
        let setpoint = Setpoint::velocity(SpeedTarget::clamped(rpm));
        let request = if query {
            Request::Query { id: MotorId::FIRST }
        } else {
            Request::drive(MotorId::FIRST, setpoint)
        };
        let frame = request.frame();
        let now = Instant::from_micros(us);
        self.world.transmit(now, frame.bytes());
        let until = now + Duration::from_micros(PERIOD_US - 1);
        let mut heard = Vec::new();
        while let Some(chunk) = self.world.receive(until) {
            heard.extend(chunk.bytes);
        }
        let at = self.seen_at(us);
        if let Ok(bytes) = <[u8; 10]>::try_from(heard.as_slice()) {
            let asked = Some(if query { Layout::Query } else { Layout::Drive });
            let kind = LineEventKind::Received {
                frame: Frame::new(bytes),
                asked,
            };
            let at = self.seen_at(us + 1_836);
            self.reply = Some(LineEvent { at, kind });
        }
        let mode = Some(Mode::Velocity);
        let kind = LineEventKind::Sent { frame, mode };
        Some(LineEvent { at, kind })
    }
}
