//! The loop of a motor: as reported, as last known, and after a switch that is not confirmed.

use motorlink_protocol::{Instant, Mode};

use super::{Control, Motor, Switched};
use crate::timing::LOOP_CERTAIN_FOR;

impl Motor {
    /// Records a mode switch. If one of several unconfirmed switches is to the position loop, that loop counts: in it
    /// a zero moves the wheel.
    pub(crate) fn switch_sent(&mut self, now: Instant, to: Mode) {
        let outstanding = self.late.outstanding(now);
        match &mut self.switched_to {
            // The same loop again: a reply after the first switch already reports it.
            Some(before) if before.to == to && to != Mode::Position => {}
            Some(before) if before.to == Mode::Position && to != Mode::Position => {
                before.among_others = true;
            }
            before => {
                let others = before.is_some_and(|before| before.among_others || before.to != to);
                *before = Some(Switched {
                    to,
                    outstanding,
                    among_others: others,
                });
            }
        }
    }

    /// Whether a reply in its window reports the loop after the last mode switch.
    pub(crate) fn confirms_loop(&self) -> bool {
        !self
            .switched_to
            .is_some_and(|switched| switched.among_others && switched.outstanding > 0)
    }

    /// Records that a reply has reported the loop. This confirms the last mode switch, unless the reply may answer a
    /// request before it.
    pub(crate) fn loop_reported(&mut self) {
        if self
            .switched_to
            .is_some_and(|switched| switched.outstanding == 0)
        {
            self.switched_to = None;
        }
    }

    /// Whether a mode switch was sent that no reply has confirmed yet.
    pub(crate) const fn loop_is_unconfirmed(&self) -> bool {
        self.switched_to.is_some()
    }

    /// Whether only a reply to a query for the loop can confirm its stop.
    pub(crate) fn is_without_confirmed_loop(&self) -> bool {
        let is_named = !self.loop_is_unconfirmed() && self.last_mode().is_some();
        self.model.has_separate_frames() && !is_named
    }

    /// Whether the bus must ask for the loop before a drive frame in another loop than the velocity loop: the motor may
    /// have lost power since its last good reply, and then reads the value as a speed. A damaged reply proves nothing.
    pub(crate) fn must_name_loop(&self, now: Instant) -> bool {
        if !self.model.has_separate_frames() {
            // Every reply names the loop.
            return self.lost_in_a_row > 0;
        }
        let answered = self
            .separate
            .loop_known
            .reported_at()
            .max(self.last.map(|last| last.at));
        let is_long_ago = answered.is_none_or(|at| now.since(at) > LOOP_CERTAIN_FOR);
        self.separate.loop_known.is_doubted() || is_long_ago
    }

    /// The loop that a reply of the last 500 ms has reported, and the last known loop.
    pub(crate) fn known_loop(&self, now: Instant) -> (Option<Mode>, Option<Mode>) {
        let last = self.assumed_loop();
        match self.switched_to {
            Some(_) => (None, last),
            None => (self.fresh_mode(now), last),
        }
    }

    /// The loop that it may be in, by all that is known. An unconfirmed switch to the position loop counts: in it a zero
    /// moves the wheel.
    pub(crate) fn assumed_loop(&self) -> Option<Mode> {
        match self.switched_to.map(|switched| switched.to) {
            Some(Mode::Position) => Some(Mode::Position),
            _ => self.last_mode().or(self.left_in),
        }
    }

    /// The loop in which the motor reads a drive frame now, for the packet log.
    pub(crate) fn reads_drive_frames_in(&self, now: Instant) -> Option<Mode> {
        match self.control {
            Control::Driven(driven) => Some(driven.goal.mode()),
            // A stop brakes, which only the velocity loop can.
            Control::Stopping(_) => Some(Mode::Velocity),
            Control::Idle | Control::Switching(_) => self.fresh_mode(now),
        }
    }

    pub(crate) fn fresh_mode(&self, now: Instant) -> Option<Mode> {
        let fresh = self
            .fresh(now)
            .filter(|_| self.switched_to.is_none() && self.other_loop.is_none())?;
        if self.model.has_separate_frames() {
            self.separate.loop_known.fresh(now, self.model)
        } else {
            Some(fresh.mode)
        }
    }

    /// The loop that a motor with separate frames is driven in. It is asked for its loop a few times a second: one lost
    /// answer does not end what it is driven in, which the bus watches by all its replies.
    pub(crate) fn driven_loop(&self) -> Option<Mode> {
        match self.control {
            Control::Driven(driven) if self.model.has_separate_frames() => {
                let mode = driven.goal.mode();
                let is_named = self.last_mode() == Some(mode) && !self.loop_is_unconfirmed();
                is_named.then_some(mode)
            }
            _ => None,
        }
    }

    /// The loop in the last reply, of any age.
    pub(crate) fn last_mode(&self) -> Option<Mode> {
        if self.model.has_separate_frames() {
            return self.separate.loop_known.last();
        }
        let last = self.last.map(|sample| sample.reply.mode);
        self.other_loop.or(last)
    }
}
