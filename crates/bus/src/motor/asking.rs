//! When a motor is asked for its telemetry.

use std::time::Duration;

use motorlink_protocol::Instant;

use super::{Control, Motor, Rest};
use crate::{
    driving::is_rest,
    timing::{
        CATCH_UP_MAX, NO_DRIVE_FRAME_MAX, PROBE_DOUBLINGS_MAX, SILENT_QUERY_PERIOD,
        TEMPERATURE_OLD, TEMPERATURE_URGENT,
    },
};

impl Motor {
    /// Records a query. `period` is the time between two queries of an answering motor;
    /// `others_driven` is whether other motors are driven.
    pub(crate) fn query_sent(&mut self, now: Instant, period: Duration, others_driven: bool) {
        self.separate.asks_loop = !self.separate.asks_loop;
        // A silent motor costs the others a reply window each time, so it is queried more and more
        // rarely, unless its wheel may turn.
        let period = if !self.answer.is_silent() {
            self.silent_queries = 0;
            period
        } else if others_driven && self.rest != Rest::StopWhenBack {
            self.silent_queries = (self.silent_queries + 1).min(PROBE_DOUBLINGS_MAX);
            SILENT_QUERY_PERIOD * (1 << self.silent_queries)
        } else {
            self.silent_queries = 0;
            SILENT_QUERY_PERIOD
        };
        // On schedule. A missed schedule is not caught up by a burst, and a query that goes early, for proof or for
        // the loop, does not move it on.
        let next = (self.next_query + period).min(now + period);
        let behind = now.since(self.next_query);
        self.next_query = next.max(now + period / 2);
        let dropped = self.next_query.since(next);
        self.counters.not_asked += self.missed_queries.sent(behind, dropped, period);
    }

    /// A drive frame went out; `before` is its schedule without it.
    pub(crate) fn drive_sent(&mut self, now: Instant, before: Control, period: Duration) {
        self.drive_frames.count(now);
        if let (Control::Driven(before), Control::Driven(driven)) = (before, self.control) {
            let behind = now.since(before.on_schedule);
            let dropped = driven
                .on_schedule
                .since(before.on_schedule.min(now) + period);
            self.counters.not_asked += self.missed_drives.sent(behind, dropped, period);
        }
    }

    /// A call of the bus came so late.
    pub(crate) fn called_late(&mut self, by: Duration) {
        self.missed_drives.called_late(by);
        self.missed_queries.called_late(by);
        // A shorter delay is caught up.
        if by > CATCH_UP_MAX {
            self.stalled += by;
        }
    }

    /// Until when queries go instead of drive frames, because the temperature is old though the motor was asked.
    ///
    /// Between drive frames on a line that loses replies, a query has no certain reply: bytes 6 and 7 may be those of a
    /// drive reply. After some queries in a row the reply is certain. The wheel keeps its last command meanwhile. A
    /// new command does not wait, unless commands follow so fast that the temperature would never be known.
    ///
    /// `driven` is the number of driven motors, which share the line.
    pub(crate) fn asks_instead_until(&self, now: Instant, driven: u32) -> Option<Instant> {
        let Control::Driven(control) = self.control else {
            return None;
        };
        if self.model.has_separate_frames() || self.is_holding(now) || self.is_withheld(now) {
            return None;
        }
        let known = self.temperature.map_or(control.since, |(at, _)| at);
        let age = now.since(known.max(control.since));
        let may_wait = !control.is_new || (age > TEMPERATURE_URGENT && !is_rest(control.goal));
        let is_old = age > TEMPERATURE_OLD * driven.div_ceil(4).clamp(1, 4);
        let until = self.late.asked_otherwise_at()? + NO_DRIVE_FRAME_MAX;
        (is_old && may_wait && now < until).then_some(until)
    }
}
