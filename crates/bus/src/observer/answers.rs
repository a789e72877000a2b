//! Replies, lost replies and invalid bytes.

use std::time::Duration;

use motorlink_protocol::{Frame, Instant, Layout, MotorId, family::Reading};

use super::Observer;
use crate::{
    exchange::{Exchange, Expects, Line},
    line_event::{LineEvent, LineEventKind},
    line_use::Use,
    other_bytes::count_line,
    raw::frame::addressee,
    receiver::{OtherBytes, ReceivedReply, reply_byte},
    replies::as_reply,
    timing::earliest_reply,
};

impl Observer {
    pub(super) fn received(&mut self, at: Instant, frame: Frame, asked: Option<Layout>) {
        let model = self.bus.model;
        let Ok(reading) = Reading::decode(model, &frame, None) else {
            return;
        };
        let id = reading.id();
        let received = ReceivedReply { frame, reading };
        match self.bus.line {
            Line::Busy(exchange) if self.answers(at, &exchange, &received, asked) => {
                self.junk_before = 0;
                self.answered(at, &exchange, received, asked);
            }
            Line::Busy(Exchange {
                expects: Expects::Everyone { .. },
                frame,
                ..
            }) => {
                self.bus.evidence.own_reply(id);
                self.hear(at, id);
                if addressee(&frame) == Some(id) {
                    self.take_reading(at, &reading, asked);
                }
            }
            // The log of a late reply names no layout: its request is uncertain.
            _ if asked.is_none() && self.has_requests => {
                self.bus
                    .receive_late_reply(at, received, self.junk_before == 0);
            }
            // Its request is not in the recording.
            _ => {
                self.hear(at, id);
                self.bus.evidence.own_reply(id);
                self.take_reading(at, &reading, asked);
            }
        }
    }

    pub(super) fn silence(&mut self, at: Instant, id: MotorId, waited_us: u32) {
        let waited = Duration::from_micros(waited_us.into());
        match self.bus.line {
            Line::Busy(exchange) if expects(&exchange) == Some(id) => {
                self.adopt(exchange.sent, id);
                // There were none at the end of the window.
                self.junk_before = 0;
                self.lost(at, &exchange, waited, 0);
            }
            _ => {
                self.hear(at - waited, id);
            }
        }
    }

    pub(super) const fn junk_received(&mut self, at: Instant, bytes: usize) {
        let before = match self.junk {
            Some((_, before)) => before,
            None => 0,
        };
        self.junk = Some((at, before + bytes));
    }

    /// Whether invalid bytes took the place of a reply, or came before it, is known by the event behind them.
    pub(super) fn judge_junk(&mut self, junk: Option<(Instant, usize)>, next: &LineEvent) {
        let Some((at, bytes)) = junk else { return };
        match next.kind {
            LineEventKind::Junk(_) if next.at == at => self.junk = junk,
            LineEventKind::Received { .. } if next.at == at => {
                self.count_junk(bytes);
                self.junk_before += bytes;
            }
            _ => self.junk_ends(at, bytes),
        }
    }

    /// No reply came with these invalid bytes.
    pub(super) fn junk_ends(&mut self, at: Instant, bytes: usize) {
        self.count_junk(bytes);
        if let Line::Busy(exchange) = self.bus.line
            && let Some(id) = expects(&exchange)
        {
            self.adopt(exchange.sent, id);
            self.lost(at, &exchange, at.since(exchange.sent), bytes);
        }
    }

    fn count_junk(&mut self, junk_bytes: usize) {
        let rest = OtherBytes {
            junk_bytes,
            ..OtherBytes::default()
        };
        let id = match &self.bus.line {
            Line::Busy(exchange) => expects(exchange),
            Line::Free { .. } => None,
        };
        match id.and_then(|id| self.bus.motor_mut(id)) {
            Some(motor) => count_line(&mut motor.counters, &rest),
            None => count_line(&mut self.bus.counters, &rest),
        }
    }

    /// The next frame shows that the exchange in flight has ended without a reply: a probe of a scan, of which no
    /// silence is recorded.
    pub(super) fn exchange_ended(&mut self, at: Instant) {
        if let Line::Busy(exchange) = self.bus.line {
            match exchange.expects {
                Expects::Reply { .. } => self.lost(at, &exchange, at.since(exchange.sent), 0),
                Expects::Everyone { .. } | Expects::Nothing => self.rested(at, &exchange),
            }
        }
    }

    fn lost(&mut self, at: Instant, exchange: &Exchange, waited: Duration, junk_bytes: usize) {
        let Expects::Reply { id, layout } = exchange.expects else {
            return;
        };
        self.bus.line = Line::Free {
            last: exchange.frame,
        };
        self.bus.line_use.add(at, Use::Waiting, waited);
        self.bus.freed_at = at;
        let rest = OtherBytes {
            junk_bytes: junk_bytes + std::mem::take(&mut self.junk_before),
            ..OtherBytes::default()
        };
        self.bus.unanswered(at, exchange, id, layout, &rest, false);
    }

    fn answered(
        &mut self,
        at: Instant,
        exchange: &Exchange,
        received: ReceivedReply,
        asked: Option<Layout>,
    ) {
        let id = received.reading.id();
        self.adopt(exchange.sent, id);
        let took = at.since(exchange.sent);
        self.bus.line = Line::Free {
            last: exchange.frame,
        };
        self.bus.line_use.add(at, Use::of(&exchange.frame), took);
        self.bus.freed_at = at;
        let layout = match exchange.expects {
            Expects::Reply { layout, .. } => layout.combined(),
            Expects::Everyone { .. } | Expects::Nothing => None,
        };
        let mut outstanding = false;
        if let Some(motor) = self.bus.motor_mut(id) {
            outstanding = motor.late.may_come(at);
            if let (Reading::Combined(reply), Some(layout)) = (received.reading, layout) {
                // It keeps count of outstanding replies. In which layout the reply was read is recorded.
                let _: Option<Layout> = motor.layout_of(at, reply, layout);
            }
        }
        self.bus
            .reply_taken(at, exchange, received, asked, outstanding);
    }

    /// Whether the frame is the reply to the request in flight.
    fn answers(
        &self,
        at: Instant,
        exchange: &Exchange,
        received: &ReceivedReply,
        asked: Option<Layout>,
    ) -> bool {
        let Expects::Reply { id, layout } = exchange.expects else {
            return false;
        };
        let [_, byte_1, ..] = *received.frame.bytes();
        let fits = reply_byte(self.bus.model, layout).is_none_or(|expected| expected == byte_1);
        let is_in_time =
            asked.is_some() || at.since(exchange.sent) >= earliest_reply(self.bus.model);
        received.reading.id() == id && fits && is_in_time
    }

    /// Counts the request to a motor that was unknown until its window ended.
    fn adopt(&mut self, sent: Instant, id: MotorId) {
        if self.knows(id) {
            return;
        }
        self.hear(sent, id);
        self.bus.counters.requests = self.bus.counters.requests.saturating_sub(1);
        if let Some(motor) = self.bus.motor_mut(id) {
            motor.counters.requests += 1;
        }
    }

    fn take_reading(&mut self, at: Instant, reading: &Reading, asked: Option<Layout>) {
        let motor = self.bus.motor_mut(reading.id());
        if let Some(reply) = motor.and_then(|motor| as_reply(motor, at, Some(at), reading, asked)) {
            self.bus.record_reply(at, reply);
        }
    }
}

const fn expects(exchange: &Exchange) -> Option<MotorId> {
    match exchange.expects {
        Expects::Reply { id, .. } => Some(id),
        Expects::Everyone { .. } | Expects::Nothing => None,
    }
}
