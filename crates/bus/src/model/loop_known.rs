//! The loop of a motor with separate frames, which few of its replies name.

use motorlink_protocol::{Instant, Mode, family::Model};

use crate::timing::FRESH_FOR;

/// What is known of the loop of a motor with separate frames.
///
/// A motor that loses power leaves its loop, and its drive replies do not say so. So the bus asks for the loop several
/// times a second. The loop is unknown once the motor has been silent for `DRIVEN_SILENCE_MAX`, which also ends its
/// setpoint.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LoopKnown {
    /// The last reported loop, and when.
    reported: Option<(Instant, Mode)>,
    /// Whether the motor has reported that it is enabled. Cleared when it reports the opposite, or may have lost power.
    enabled: bool,
    /// Whether a request was unanswered since the last report: the motor may have lost power.
    is_doubted: bool,
}

impl LoopKnown {
    pub(crate) fn reported(&mut self, now: Instant, mode: Mode) {
        self.reported = Some((now, mode));
        self.is_doubted = false;
    }

    /// The motor has answered that it is enabled or not, but names no loop: it obeys drive frames once it is switched to
    /// one.
    pub(crate) fn enabled(&mut self, on: bool) {
        self.enabled = on;
        self.is_doubted &= !on;
        self.reported = None;
    }

    /// Records an unanswered request. `may_be_off` says that the motor has been silent so long that it may have lost
    /// power.
    pub(crate) fn unanswered(&mut self, may_be_off: bool) {
        self.is_doubted = true;
        if may_be_off {
            *self = Self {
                is_doubted: true,
                ..Self::default()
            };
        }
    }

    /// Whether a motor of this model is known to obey drive frames.
    pub(crate) fn obeys(&self, model: Model) -> bool {
        (self.enabled && self.reported.is_some()) || !model.spec().needs_enable
    }

    /// The loop by a report of the last 500 ms, of a motor that obeys drive frames.
    pub(crate) fn fresh(&self, now: Instant, model: Model) -> Option<Mode> {
        let (at, mode) = self.reported?;
        (self.obeys(model) && now.since(at) <= FRESH_FOR).then_some(mode)
    }

    /// The last reported loop, of any age. A motor powers up in the velocity loop.
    pub(crate) fn last(&self) -> Option<Mode> {
        self.reported.map(|(_, mode)| mode)
    }

    /// When the motor last named its loop.
    pub(crate) fn reported_at(&self) -> Option<Instant> {
        self.reported.map(|(at, _)| at)
    }

    /// Whether the loop must be asked for before the next drive frame: outside the velocity loop, a motor that lost
    /// power would read the value as a speed.
    pub(crate) fn is_doubted(&self) -> bool {
        self.is_doubted
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn at(ms: u64) -> Instant {
        Instant::ZERO + Duration::from_millis(ms)
    }

    #[test]
    fn a_report_is_fresh_for_half_a_second() {
        let mut known = LoopKnown::default();
        known.reported(at(0), Mode::Position);
        assert_eq!(known.fresh(at(500), Model::Ddsm210), Some(Mode::Position));
        assert_eq!(known.fresh(at(501), Model::Ddsm210), None);
        assert_eq!(known.last(), Some(Mode::Position));
    }

    #[test]
    fn one_lost_reply_makes_the_loop_doubted_and_a_long_silence_unknown() {
        let mut known = LoopKnown::default();
        known.reported(at(0), Mode::Position);
        known.unanswered(false);
        assert!(known.is_doubted());
        assert_eq!(known.last(), Some(Mode::Position));
        known.reported(at(10), Mode::Position);
        assert!(!known.is_doubted());
        known.unanswered(true);
        assert_eq!(known.last(), None);
    }

    #[test]
    fn a_ddsm400_must_be_enabled_again_after_a_power_cut() {
        let mut known = LoopKnown::default();
        known.reported(at(0), Mode::Velocity);
        assert_eq!(known.fresh(at(1), Model::Ddsm400), None);
        known.enabled(true);
        assert_eq!(known.fresh(at(1), Model::Ddsm400), None, "in no loop");
        known.reported(at(1), Mode::Velocity);
        assert_eq!(known.fresh(at(1), Model::Ddsm400), Some(Mode::Velocity));
        known.unanswered(true);
        known.reported(at(2), Mode::Velocity);
        assert!(!known.obeys(Model::Ddsm400));
        assert_eq!(known.fresh(at(2), Model::Ddsm400), None);
    }
}
