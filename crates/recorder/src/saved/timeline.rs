//! Converts the times of several runs of the page to one clock.
//!
//! Every run counts from its own start. Saved runs are placed by the wall clock. If the wall clock was set
//! back between two runs, the later one follows directly after the earlier one, so that the log stays in
//! order.

use motorlink_protocol::Instant;

/// Converts the times of several runs to the clock of the first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Timeline {
    /// The zero of converted times, in microseconds since 1970.
    base_us: i64,
    /// The known runs: their epochs, and how much later their zero is than ours.
    runs: Vec<(i64, i64)>,
    run: Run,
    newest_us: i64,
}

/// The current run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Run {
    /// Its zero is this much later than ours.
    Placed { offset_us: i64 },
    /// Its offset is determined by its first time.
    New { epoch_us: i64 },
}

impl Default for Run {
    fn default() -> Self {
        Self::Placed { offset_us: 0 }
    }
}

impl Timeline {
    /// A timeline whose zero is the epoch of the earliest run, in microseconds since 1970.
    pub(crate) fn from(base_us: i64) -> Self {
        Self {
            base_us,
            ..Self::default()
        }
    }

    /// Whether it has placed any run.
    pub(crate) const fn has_runs(&self) -> bool {
        !self.runs.is_empty()
    }

    /// Begins another run, which follows all earlier ones.
    pub(crate) fn begin(&mut self, epoch_us: i64) {
        self.run = match self.offset_us(epoch_us) {
            Some(offset_us) => Run::Placed { offset_us },
            None => Run::New { epoch_us },
        };
    }

    /// The same for a run that may be earlier than the others.
    pub(crate) fn recall(&mut self, epoch_us: i64) {
        let offset_us = self.offset_us(epoch_us);
        let offset_us = offset_us.unwrap_or(self.wall_offset_us(epoch_us));
        self.run = Run::Placed { offset_us };
    }

    fn offset_us(&self, epoch_us: i64) -> Option<i64> {
        let mut runs = self.runs.iter();
        runs.find(|run| run.0 == epoch_us).map(|run| run.1)
    }

    /// How much later the zero of this run is than ours, in microseconds. Before its first time, if its clock
    /// was set back, this is the upper bound.
    pub(crate) fn zero_us(&self) -> i64 {
        match self.run {
            Run::Placed { offset_us } => offset_us,
            Run::New { epoch_us } => self.wall_offset_us(epoch_us).max(self.newest_us),
        }
    }

    const fn wall_offset_us(&self, epoch_us: i64) -> i64 {
        epoch_us.saturating_sub(self.base_us)
    }

    /// Converts a time of this run.
    pub(crate) fn at(&mut self, instant: Instant) -> Instant {
        let own_us = i64::try_from(instant.as_micros()).unwrap_or(i64::MAX);
        let offset_us = match self.run {
            Run::Placed { offset_us } => offset_us,
            Run::New { epoch_us } => {
                let wall_offset_us = self.wall_offset_us(epoch_us);
                let offset_us = wall_offset_us.max(self.newest_us.saturating_sub(own_us));
                self.runs.push((epoch_us, offset_us));
                self.run = Run::Placed { offset_us };
                offset_us
            }
        };
        let us = own_us.saturating_add(offset_us).max(0);
        self.newest_us = self.newest_us.max(us);
        Instant::from_micros(us.unsigned_abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ms(timeline: &mut Timeline, millis: u64) -> u64 {
        timeline.at(Instant::from_millis(millis)).as_micros() / 1000
    }

    #[test]
    fn one_run_keeps_its_times() {
        assert_eq!(ms(&mut Timeline::default(), 5), 5);
    }

    #[test]
    fn a_later_run_is_placed_by_the_wall_clock() {
        let mut timeline = Timeline::from(1_000_000);
        timeline.begin(1_000_000);
        assert_eq!(ms(&mut timeline, 200), 200);
        timeline.begin(61_000_000);
        assert_eq!(ms(&mut timeline, 5), 60_005);
        // Another file of the same run.
        timeline.begin(61_000_000);
        assert_eq!(ms(&mut timeline, 7), 60_007);
    }

    #[test]
    fn a_clock_that_was_set_back_puts_no_run_before_another() {
        let mut timeline = Timeline::from(1_000_000);
        timeline.begin(1_000_000);
        assert_eq!(ms(&mut timeline, 5_000), 5_000);
        timeline.begin(900_000);
        assert_eq!(ms(&mut timeline, 300), 5_000);
        assert_eq!(ms(&mut timeline, 310), 5_010);
        timeline.begin(1_000_000);
        assert_eq!(ms(&mut timeline, 5_001), 5_001, "it keeps its place");
        timeline.recall(900_000);
        assert_eq!(ms(&mut timeline, 300), 5_000);
    }

    #[test]
    fn the_zero_of_a_run_is_known_before_its_first_moment() {
        let mut timeline = Timeline::from(1_000_000);
        assert_eq!(timeline.zero_us(), 0);
        timeline.begin(1_000_000);
        assert_eq!(ms(&mut timeline, 5_000), 5_000);
        timeline.begin(61_000_000);
        assert_eq!(timeline.zero_us(), 60_000_000);
        timeline.begin(900_000);
        assert_eq!(timeline.zero_us(), 5_000_000, "its clock was set back");
        assert_eq!(ms(&mut timeline, 300), 5_000);
        assert_eq!(timeline.zero_us(), 4_700_000);
    }

    #[test]
    fn a_run_that_was_before_all_is_no_reason_to_move() {
        let mut timeline = Timeline::from(1_000_000);
        timeline.begin(61_000_000);
        assert_eq!(ms(&mut timeline, 0), 60_000);
        timeline.recall(1_000_000);
        assert_eq!(ms(&mut timeline, 10), 10);
        timeline.recall(0);
        assert_eq!(ms(&mut timeline, 10), 0, "there is no time before zero");
    }
}
