//! How a reply of the motor is read, and what a request without one means.

use motorlink_protocol::{Detail, Instant, Layout, Reply, family::Reading};

use super::{Control, Motor};
use crate::motor_status::Answer;
use crate::timing::{DRIVEN_SILENCE_MAX, DRIVEN_UNANSWERED_MAX, FRESH_FOR, TEMPERATURE_JUMP};

/// Windows by which the kind of a silence is judged: five seconds while nothing is driven.
const JUDGED_WINDOWS: u32 = 5;

impl Motor {
    /// The layout in which to read its reply to a request in `layout`; `None` if that is uncertain.
    pub(crate) fn layout_of(
        &mut self,
        now: Instant,
        reply: Reply,
        layout: Layout,
    ) -> Option<Layout> {
        let layout = self.late.layout_of_reply(now, layout)?;
        let reply = reply.in_layout(Some(layout));
        let speed = reply.speed?;
        let certain = self.late.all_answered_in_time();
        let (degrees, fits) = match reply.detail {
            Detail::Query {
                temperature,
                position,
            } => {
                let fits = self.temperature_filter.accepts(now, temperature, certain);
                (position.degrees(), fits)
            }
            Detail::Drive { position } => (position.degrees(), true),
            Detail::Undetermined(_) | Detail::Temperature(_) | Detail::Odometry { .. } => {
                return Some(layout);
            }
        };
        // Both filters see every reading.
        let follows = self.angle_filter.accepts(now, degrees, speed, certain);
        (fits && follows).then_some(layout)
    }

    pub(crate) fn lost(&mut self, now: Instant, layout: Layout, sent: Instant) {
        self.unanswered_in_a_row = self.unanswered_in_a_row.saturating_add(1);
        self.lost_in_a_row = self.lost_in_a_row.saturating_add(1);
        self.late.unanswered(layout, sent, self.unanswered_in_a_row);
        let silent_for = now.since(self.silent_since());
        // Three lost replies in a row are not enough: with 15 % of replies lost, this happens once in 300 frames.
        let may_be_off = self.is_without_answer() && silent_for >= DRIVEN_SILENCE_MAX;
        self.separate.unanswered(may_be_off);
        if may_be_off && matches!(self.control, Control::Stopping(_)) {
            self.rest.wait_for_reply();
        }
    }

    /// Records a reply window without a reply, and updates the kind of silence of a silent motor. A line that gives both
    /// kinds does not change it with each request.
    pub(crate) fn record_lost_window(&mut self, had_invalid_bytes: bool) {
        self.garbled_windows = self.garbled_windows << 1 | u8::from(had_invalid_bytes);
        self.answer = match (self.answer, self.garbled_of_judged()) {
            (Answer::Missing, 4..) => Answer::Corrupted,
            (Answer::Corrupted, ..=1) => Answer::Missing,
            (answer, _) => answer,
        };
    }

    /// The kind of silence of a motor that falls silent.
    pub(crate) fn silence_kind(&self) -> Answer {
        if self.garbled_of_judged() * 2 > self.lost_in_a_row.min(JUDGED_WINDOWS) {
            Answer::Corrupted
        } else {
            Answer::Missing
        }
    }

    const fn garbled_of_judged(&self) -> u32 {
        (self.garbled_windows & ((1 << JUDGED_WINDOWS) - 1)).count_ones()
    }

    /// Its stop has ended, and it has told nothing lately. The frames of the stop may not have left the port: it counts
    /// as silent until it answers.
    pub(crate) fn was_not_reached(&mut self) {
        self.unanswered_in_a_row = self.unanswered_in_a_row.max(DRIVEN_UNANSWERED_MAX);
        self.rest.wait_for_reply();
    }

    /// Whether this reading cannot follow the last one: its temperature has jumped, or its angle is back at zero. Then
    /// the frame, which is identical to its request or begins like it, is an echo.
    pub(crate) fn contradicts(&self, now: Instant, reading: &Reading) -> bool {
        match reading {
            Reading::Drive(reading) => self.temperature.is_some_and(|(at, before)| {
                let jump = before.degrees().abs_diff(reading.temperature.degrees());
                jump > TEMPERATURE_JUMP && now.since(at) < FRESH_FOR
            }),
            Reading::Odometry(reading) => {
                let is_zero = reading.turns == 0 && reading.position.raw() == 0;
                is_zero && self.separate.is_far_from_zero(now)
            }
            Reading::Combined(_) | Reading::Mode(_) => false,
        }
    }

    /// Records an ID query without an answer of this motor. Its answer has the layout of a drive
    /// reply.
    pub(crate) fn id_query_unanswered(&mut self, sent: Instant) {
        self.late.id_query_unanswered(sent);
    }

    /// Records an unknown frame without a reply of this motor. Its reply may have either layout.
    pub(crate) fn unknown_frame_unanswered(&mut self, sent: Instant) {
        self.late.unanswered(Layout::Drive, sent, 1);
        self.late.unanswered(Layout::Query, sent, 1);
    }
}
