//! The place while a replay plays, by the clock of the caller.

use std::time::Duration;

use motorlink_messages::sessions::PlaySpeed;
use motorlink_protocol::Instant;

/// The state is shown 30 times a second.
const PERIOD: Duration = Duration::from_micros(33_400);

/// The longest time that one step plays. If reading takes longer, the replay falls behind the clock, so that no step has
/// more than this to read.
const STEP_MAX: Duration = Duration::from_millis(50);

/// A replay that plays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Playing {
    speed: PlaySpeed,
    /// When the last step began, on the clock of the caller.
    stepped: Instant,
}

impl Playing {
    pub(super) const fn begin(now: Instant, speed: PlaySpeed) -> Self {
        let stepped = now;
        Self { speed, stepped }
    }

    /// When the next step is due.
    pub(super) fn due(self) -> Instant {
        self.stepped + PERIOD
    }

    /// Begins the next step. Returns the place at its end.
    pub(super) fn step(&mut self, now: Instant, place: Instant) -> Instant {
        let passed = now.since(self.stepped).min(STEP_MAX);
        self.stepped = now;
        let passed_us = u64::try_from(passed.as_micros()).unwrap_or_default();
        let played_us = passed_us * u64::from(self.speed.per_mille()) / 1_000;
        Instant::from_micros(place.as_micros().saturating_add(played_us))
    }

    /// The time until now is not played: the replay was searching.
    pub(super) const fn wait(&mut self, now: Instant) {
        self.stepped = now;
    }
}
