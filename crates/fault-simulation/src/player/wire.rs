//! Bytes to the bus, and frames to the wire.

use motorlink_protocol::family::Request;
use motorlink_protocol::{Frame, Mode};
use motorlink_simulator::Sender;

use crate::rule::Violation;

use super::Player;

impl Player {
    /// Delivers bytes to the bus, if there is one.
    pub(super) fn hand_over(&mut self, bytes: &[u8]) {
        if let Some(bus) = &mut self.bus {
            self.rules.delivered(self.now, bytes);
            bus.receive(self.now, bytes);
        }
    }

    /// Passes the replies of the motors to the rules.
    pub(super) fn receive_replies(&mut self) {
        let is_heard = self.bus.is_some();
        let passed: Vec<_> = self.world.drain_wire_frames().collect();
        for traffic in passed {
            if let Sender::Motor(_) = traffic.from {
                self.rules.said(traffic.at, traffic.frame);
                if is_heard {
                    self.rules.replied(traffic.at, traffic.frame, &self.world);
                }
            }
        }
    }

    /// The port takes a frame, refuses it or truncates it.
    pub(super) fn transmit(&mut self, frame: Frame) -> Result<(), Violation> {
        let Some(bus) = &mut self.bus else {
            return Ok(());
        };
        self.left_driven = bus.left_driven().collect();
        if let Some(left) = self.refuses.checked_sub(1) {
            self.refuses = left;
            bus.transmit_failed();
            self.rules.refused(self.now, frame, 0, true);
            return Ok(());
        }
        if let Some((frames @ 1.., bytes, reported)) = self.cuts {
            self.cuts = Some((frames - 1, bytes, reported));
            if reported {
                bus.transmit_failed();
            }
            self.rules.refused(self.now, frame, bytes, reported);
            let front = frame.bytes().get(..bytes).unwrap_or_default();
            self.world.transmit(self.now, front);
            return Ok(());
        }
        self.rules.sent(self.now, frame, bus, &self.world)?;
        let asks = match Request::parse(self.model, &frame) {
            Ok(Request::Query { .. } | Request::ModeQuery { .. } | Request::IdQuery) => true,
            // A motor that has lost its supply is made ready again, which moves nothing.
            Ok(
                Request::Enable { on: true, .. }
                | Request::SwitchMode {
                    mode: Mode::Velocity,
                    ..
                },
            ) => self.model.spec().needs_enable,
            _ => false,
        };
        self.acted += u64::from(!asks);
        self.sent.update(&self.now.as_micros().to_le_bytes());
        self.sent.update(frame.bytes());
        self.world.transmit(self.now, frame.bytes());
        Ok(())
    }
}
