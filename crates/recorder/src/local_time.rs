//! The offset of local time to UTC, now and before: a log may start before a change of the clocks.

/// Number of known changes: two years of summer time.
const CHANGES_MAX: usize = 4;

/// The search for changes proceeds by days: no zone changes its clocks twice within one day.
const STEP_MS: i64 = 86_400_000;

/// How far back the search goes: three years.
const STEPS_MAX: u32 = 1_096;

/// How far local time is ahead of UTC, and when that changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LocalTime {
    /// The offset in minutes since the latest change.
    minutes: i32,
    /// Earlier offsets: until when, in milliseconds since 1970, and minutes; the latest first.
    before: [(i64, i32); CHANGES_MAX],
}

impl Default for LocalTime {
    fn default() -> Self {
        Self::fixed(0)
    }
}

impl LocalTime {
    /// A constant offset in minutes; negative in the west.
    #[must_use]
    pub const fn fixed(minutes: i32) -> Self {
        Self {
            minutes,
            before: [(i64::MIN, 0); CHANGES_MAX],
        }
    }

    /// The local time between two times in milliseconds since 1970. `minutes_at` returns the offset at a time.
    pub fn between(from_ms: i64, until_ms: i64, minutes_at: impl Fn(i64) -> i32) -> Self {
        let mut local = Self::fixed(minutes_at(until_ms));
        let mut changes = local.before.iter_mut();
        let mut minutes = local.minutes;
        let mut later_ms = until_ms;
        for _ in 0..STEPS_MAX {
            if later_ms <= from_ms {
                break;
            }
            let earlier_ms = later_ms.saturating_sub(STEP_MS).max(from_ms);
            let before = minutes_at(earlier_ms);
            if before != minutes {
                let Some(change) = changes.next() else { break };
                let (mut old_ms, mut new_ms) = (earlier_ms, later_ms);
                while new_ms - old_ms > 1 {
                    let middle_ms = old_ms + (new_ms - old_ms) / 2;
                    if minutes_at(middle_ms) == minutes {
                        new_ms = middle_ms;
                    } else {
                        old_ms = middle_ms;
                    }
                }
                *change = (new_ms, before);
                minutes = before;
            }
            later_ms = earlier_ms;
        }
        local
    }

    /// How many minutes local time was ahead of UTC at a moment, in milliseconds since 1970.
    pub(crate) fn minutes_at(&self, unix_ms: i64) -> i32 {
        let before = self.before.iter();
        let before = before.take_while(|(until_ms, _)| unix_ms < *until_ms);
        before.last().map_or(self.minutes, |(_, minutes)| *minutes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By `date -u -d <time> +%s`, in milliseconds: clocks go forward in Berlin, back, and forward again.
    const CHANGES: [(i64, i32); 3] = [
        (1_774_746_000_000, 60),
        (1_792_890_000_000, 120),
        (1_806_195_600_000, 60),
    ];

    fn berlin(unix_ms: i64) -> i32 {
        let mut changes = CHANGES.iter();
        let change = changes.find(|(until_ms, _)| unix_ms < *until_ms);
        change.map_or(120, |(_, minutes)| *minutes)
    }

    #[test]
    fn local_time_is_that_of_the_moment_on_either_side_of_every_change() {
        let (from_ms, until_ms) = (1_774_000_000_000, 1_810_000_000_000);
        let local = LocalTime::between(from_ms, until_ms, berlin);
        for (at_ms, _) in CHANGES {
            for unix_ms in [at_ms - 86_400_000, at_ms - 1, at_ms, at_ms + 86_400_000] {
                assert_eq!(local.minutes_at(unix_ms), berlin(unix_ms), "{unix_ms}");
            }
        }
        assert_eq!(local.minutes_at(from_ms), 60);
        assert_eq!(local.minutes_at(until_ms + 1), 120);
    }

    #[test]
    fn a_zone_without_changes_and_a_span_of_nothing_have_one_offset() {
        assert_eq!(
            LocalTime::between(0, 90_000_000_000, |_| -210),
            LocalTime::fixed(-210)
        );
        assert_eq!(LocalTime::between(5, 5, berlin), LocalTime::fixed(60));
        assert_eq!(LocalTime::fixed(60).minutes_at(i64::MIN), 60);
    }

    /// The oldest keep the offset of the oldest change that is known.
    #[test]
    fn changes_that_are_too_many_are_bounded() {
        let weekly = |unix_ms: i64| i32::try_from(unix_ms / 604_800_000 % 2).unwrap() * 60;
        let until_ms = 1_795_266_936_962;
        let local = LocalTime::between(0, until_ms, weekly);
        for weeks in 0..4 {
            let unix_ms = until_ms - weeks * 604_800_000;
            assert_eq!(local.minutes_at(unix_ms), weekly(unix_ms));
        }
    }
}
