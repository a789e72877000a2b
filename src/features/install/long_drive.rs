//! Measures the driving time, to advise installing the page.

/// The driving time after which the advice is shown.
const LONG_MS: f64 = 10.0 * 60_000.0;
/// The time with a hidden page after which the advice is shown.
const LONG_HIDDEN_MS: f64 = 60_000.0;
/// A hidden page's timers run at least once a minute; after a longer gap the computer was asleep.
const GAP_MS_MAX: f64 = 90_000.0;

/// The time that was driven since the page was opened, all in milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LongDrive {
    updated: Option<f64>,
    driven: f64,
    hidden: f64,
}

impl LongDrive {
    /// Adds the time since the last call. Returns whether the driving time has become long.
    pub(crate) fn update(&mut self, now_ms: f64, drives: bool, hidden: bool) -> bool {
        let since_ms = self.updated.map_or(0.0, |last_ms| now_ms - last_ms);
        self.updated = Some(now_ms);
        if drives && since_ms <= GAP_MS_MAX {
            self.driven += since_ms;
            self.hidden += if hidden { since_ms } else { 0.0 };
        }
        self.driven >= LONG_MS || self.hidden >= LONG_HIDDEN_MS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// When it becomes long, if it is updated at this interval for an hour.
    fn long_after_s(every_ms: f64, drives: bool, hidden: bool) -> Option<f64> {
        let mut drive = LongDrive::default();
        let mut now_ms = 5_000.0;
        while now_ms < 3_600_000.0 {
            if drive.update(now_ms, drives, hidden) {
                return Some((now_ms - 5_000.0) / 1_000.0);
            }
            now_ms += every_ms;
        }
        None
    }

    #[test]
    fn ten_minutes_seen_or_one_hidden_are_long() {
        assert_eq!(long_after_s(1_000.0, true, false), Some(600.0));
        assert_eq!(long_after_s(1_000.0, true, true), Some(60.0));
        assert_eq!(long_after_s(60_000.0, true, true), Some(60.0));
    }

    #[test]
    fn what_was_not_driven_and_a_machine_asleep_do_not_count() {
        assert_eq!(long_after_s(1_000.0, false, true), None);
        assert_eq!(long_after_s(600_000.0, true, true), None);
    }
}
