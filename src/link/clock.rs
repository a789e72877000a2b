//! Converts between the clocks of the worker and the page.

use std::time::Duration;

use motorlink_messages::protocol::Instant;

use crate::ui::clock::{day_us, page_origin_ms};

/// A recording runs on no further than this until more of it is read: less than the age at which a reading counts as
/// old. At ten times the speed, a state comes every 334 ms of the recording.
const AHEAD_MAX_MS: f64 = 400.0;

/// Both clocks have their own origin; both origins are known on the wall clock.
///
/// What the page draws is drawn at a time that it calls shown. It is the page's `performance.now()`, and while a
/// recording is shown the time of that recording, which runs at the speed of the replay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clock {
    /// How much later the worker's origin is than that of shown times.
    offset_ms: f64,
    /// How much later the origin of shown times is than the page's.
    wall_ms: f64,
    /// From this time of the page's `performance.now()` on, the shown time runs on from `from_shown_ms`.
    from_page_ms: f64,
    from_shown_ms: f64,
    /// Shown time per time of the page.
    pub(crate) speed: f64,
    /// It runs on no further than this.
    ahead_max_ms: f64,
}

impl Default for Clock {
    fn default() -> Self {
        Self::new(0.0, 0.0)
    }
}

impl Clock {
    pub(crate) fn new(page_origin_ms: f64, worker_origin_ms: f64) -> Self {
        Self {
            offset_ms: worker_origin_ms - page_origin_ms,
            wall_ms: 0.0,
            from_page_ms: 0.0,
            from_shown_ms: 0.0,
            speed: 1.0,
            ahead_max_ms: f64::INFINITY,
        }
    }

    /// The zero of the worker's clock, on the clock on which the page's is this.
    pub(crate) fn worker_origin_ms(self, page_origin_ms: f64) -> f64 {
        page_origin_ms + self.offset_ms
    }

    /// The clock of a recording, at this place of it, at this time of the page. `wall_ms` is its origin after that of
    /// the page.
    pub(crate) fn of_recording(wall_ms: f64, place: Instant, page_ms: f64, speed: f64) -> Self {
        let clock = Self {
            wall_ms,
            ..Self::default()
        };
        Self {
            from_page_ms: page_ms,
            from_shown_ms: clock.shown_ms_of(place),
            speed,
            ahead_max_ms: AHEAD_MAX_MS,
            ..clock
        }
    }

    /// Whether it stands still.
    pub(crate) fn is_paused(self) -> bool {
        self.speed <= 0.0
    }

    /// The shown time at this time of the page's `performance.now()`.
    pub(crate) fn shown_ms(self, page_ms: f64) -> f64 {
        let ahead_ms = (page_ms - self.from_page_ms) * self.speed;
        self.from_shown_ms + ahead_ms.min(self.ahead_max_ms)
    }

    /// A time of the worker as a shown time.
    #[allow(
        clippy::cast_precision_loss,
        reason = "microseconds of a session fit into 53 bits for 285 years"
    )]
    pub(crate) fn shown_ms_of(self, instant: Instant) -> f64 {
        instant.as_micros() as f64 / 1000.0 + self.offset_ms
    }

    /// A time of the worker on the wall clock, in milliseconds since 1970, UTC.
    pub(crate) fn wall_ms(self, instant: Instant) -> f64 {
        page_origin_ms() + self.wall_ms + self.shown_ms_of(instant)
    }

    /// The local time of day of a time of the worker, in microseconds since midnight.
    pub(crate) fn day_us(self, instant: Instant) -> u64 {
        day_us(self.wall_ms(instant))
    }

    /// The same for a time this long before the worker's zero.
    pub(crate) fn day_us_before(self, before: Duration) -> u64 {
        day_us(self.wall_ms(Instant::ZERO) - before.as_secs_f64() * 1_000.0)
    }

    /// What is shown at a time of the page's `performance.now()`, on the worker's clock.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float cast saturates, and a moment before the worker's origin is its origin"
    )]
    pub(crate) fn instant(self, page_ms: f64) -> Instant {
        Instant::from_micros(((self.shown_ms(page_ms) - self.offset_ms) * 1000.0) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moment_has_a_place_on_both_clocks() {
        let clock = Clock::new(1_000.0, 1_250.0);
        let moment = Instant::from_millis(50);
        assert!((clock.shown_ms_of(moment) - 300.0).abs() < 1e-9);
        assert_eq!(clock.instant(300.0), moment);
        assert_eq!(clock.instant(0.0), Instant::ZERO, "before the worker was");
        assert!((clock.shown_ms(300.0) - 300.0).abs() < 1e-9);
    }

    #[test]
    fn a_recording_runs_at_its_speed_from_where_it_is_and_not_far_ahead() {
        let place = Instant::from_millis(5_000);
        let at = |speed, page_ms| {
            let clock = Clock::of_recording(-60_000.0, place, 80_000.0, speed);
            clock.instant(page_ms).as_micros() / 1_000
        };
        assert_eq!(at(1.0, 80_000.0), 5_000);
        assert_eq!(at(1.0, 80_100.0), 5_100);
        assert_eq!(at(0.5, 80_100.0), 5_050);
        assert_eq!(at(0.0, 99_000.0), 5_000, "paused");
        assert_eq!(at(100.0, 80_100.0), 5_400, "not yet read");
    }
}
