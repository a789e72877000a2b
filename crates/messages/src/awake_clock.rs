//! A monotonic clock that counts the time asleep.

/// A wall clock that runs ahead of the monotonic clock by so much between two readings was either set
/// forward or went on while the computer slept. Corrections by a time server come in smaller steps.
const GAP_MS: f64 = 500.0;

/// Adds the time that the computer slept to a monotonic clock that leaves it out.
///
/// `performance.now()` stands still while a computer sleeps on Linux and macOS, and goes on under Windows;
/// the wall clock always goes on. With the time asleep added, a reading from before the sleep is as old as
/// it is, and no setpoint looks fresh.
///
/// A wall clock that is set forward looks like sleep, and counts as such; one that is set back changes
/// nothing.
#[derive(Clone, Copy, Debug, Default)]
#[allow(clippy::struct_field_names, reason = "the unit stands last in a name")]
pub struct AwakeClock {
    /// How far the wall clock was ahead at the last reading.
    ahead_ms: Option<f64>,
    asleep_ms: f64,
    /// When the last sleep was noticed, by the monotonic clock, and how long it was.
    last_sleep_ms: Option<(f64, f64)>,
}

impl AwakeClock {
    /// The time by the monotonic clock with all sleep so far, in milliseconds. Both readings are of now.
    pub fn read(&mut self, monotonic_ms: f64, wall_ms: f64) -> f64 {
        let ahead_ms = wall_ms - monotonic_ms;
        let gap_ms = self.ahead_ms.map_or(0.0, |before| ahead_ms - before);
        if gap_ms > GAP_MS {
            self.asleep_ms += gap_ms;
            self.last_sleep_ms = Some((monotonic_ms, gap_ms));
        }
        self.ahead_ms = Some(ahead_ms);
        monotonic_ms + self.asleep_ms
    }

    /// The time of an earlier reading of the monotonic clock, such as an event's. One from before the last
    /// sleep is as old as that makes it.
    #[must_use]
    pub fn of_event(&self, monotonic_ms: f64) -> f64 {
        let since = self
            .last_sleep_ms
            .filter(|(at_ms, _)| monotonic_ms < *at_ms);
        let slept_since_ms = since.map_or(0.0, |(_, gap_ms)| gap_ms);
        monotonic_ms + self.asleep_ms - slept_since_ms
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WALL_MS: f64 = 1_780_000_000_000.0;
    const NIGHT_MS: f64 = 8.0 * 3_600_000.0;

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 0.01, "{a}, not {b}");
    }

    #[test]
    fn time_asleep_counts() {
        let mut clock = AwakeClock::default();
        near(clock.read(1_000.0, WALL_MS), 1_000.0);
        near(clock.read(1_020.0, WALL_MS + 20.0), 1_020.0);
        near(
            clock.read(1_040.0, WALL_MS + 40.0 + NIGHT_MS),
            1_040.0 + NIGHT_MS,
        );
        near(
            clock.read(2_040.0, WALL_MS + 1_040.0 + NIGHT_MS),
            2_040.0 + NIGHT_MS,
        );
        near(clock.of_event(1_900.0), 1_900.0 + NIGHT_MS);
        near(clock.of_event(1_039.0), 1_039.0);
        // Once more, for as long.
        let wall_ms = WALL_MS + 2_000.0 + 2.0 * NIGHT_MS;
        near(clock.read(3_000.0, wall_ms), 3_000.0 + 2.0 * NIGHT_MS);
    }

    #[test]
    fn a_clock_that_is_set_back_or_drifts_changes_nothing() {
        let mut clock = AwakeClock::default();
        clock.read(0.0, WALL_MS);
        near(clock.read(10.0, WALL_MS - NIGHT_MS), 10.0);
        near(clock.read(20.0, WALL_MS - NIGHT_MS + 10.0), 20.0);
        // A second of drift in 100 readings.
        let mut ahead_ms = WALL_MS;
        let mut clock = AwakeClock::default();
        for turn in 0..100 {
            let now_ms = f64::from(turn) * 1_000.0;
            ahead_ms += 10.0;
            near(clock.read(now_ms, ahead_ms + now_ms), now_ms);
        }
    }

    #[test]
    fn a_platform_whose_clock_goes_on_in_sleep_counts_nothing_twice() {
        let mut clock = AwakeClock::default();
        clock.read(0.0, WALL_MS);
        near(clock.read(NIGHT_MS, WALL_MS + NIGHT_MS), NIGHT_MS);
    }
}
