//! Dates and times of day as text.
//!
//! A calendar library would be larger than the whole recorder; only the date of a day is needed.

use motorlink_protocol::Instant;

use crate::{
    digits::{push_decimal, push_padded},
    local_time::LocalTime,
};

const MS_A_DAY: i64 = 86_400_000;
const MS_A_MINUTE: i64 = 60_000;

/// Converts an [`Instant`] to UTC and to local time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct WallClock {
    /// Microseconds since 1970 at [`Instant::ZERO`].
    zero_us: i64,
    local_time: LocalTime,
}

/// A time in milliseconds since 1970, in UTC or in local time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct UnixMs(i64);

impl WallClock {
    /// A clock that showed `unix_ms` (milliseconds since 1970, UTC) at [`Instant::ZERO`], where local
    /// time is this many minutes ahead of UTC (negative in the west).
    #[must_use]
    #[allow(
        clippy::cast_possible_truncation,
        reason = "a float cast saturates, and no clock shows a time so far away"
    )]
    pub const fn new(unix_ms: f64, utc_offset_minutes: i32) -> Self {
        Self {
            zero_us: (unix_ms * 1000.0) as i64,
            local_time: LocalTime::fixed(utc_offset_minutes),
        }
    }

    /// A clock whose [`Instant::ZERO`] is this time, in microseconds since 1970, UTC.
    #[must_use]
    pub const fn from_us(zero_us: i64, local_time: LocalTime) -> Self {
        Self {
            zero_us,
            local_time,
        }
    }

    /// Microseconds since 1970 at [`Instant::ZERO`].
    pub(crate) const fn zero_us(self) -> i64 {
        self.zero_us
    }

    /// The same clock with another local time.
    #[must_use]
    pub const fn with_local_time(self, local_time: LocalTime) -> Self {
        Self { local_time, ..self }
    }

    pub(crate) const fn local_time(self) -> LocalTime {
        self.local_time
    }

    pub(crate) fn utc(self, at: Instant) -> UnixMs {
        let micros = i64::try_from(at.as_micros()).unwrap_or(i64::MAX);
        UnixMs(self.zero_us.saturating_add(micros).div_euclid(1000))
    }

    pub(crate) fn local(self, at: Instant) -> UnixMs {
        let UnixMs(utc) = self.utc(at);
        UnixMs(utc + i64::from(self.local_time.minutes_at(utc)) * MS_A_MINUTE)
    }

    /// Local date and time for the name of a file: `20261121-131536`.
    pub(crate) fn push_file_stamp(self, out: &mut String, at: Instant) {
        let UnixMs(ms) = self.local(at);
        let (year, month, day) = civil_from_days(ms.div_euclid(MS_A_DAY));
        push_date(out, [year, month, day], "");
        out.push('-');
        push_clock(out, ms, "");
    }
}

impl UnixMs {
    /// `13:15:36.962`
    pub(crate) fn push_time_of_day(self, out: &mut String) {
        push_clock(out, self.0, ":");
        self.push_millis(out);
    }

    fn push_millis(self, out: &mut String) {
        out.push('.');
        push_padded(out, unsigned(self.0.rem_euclid(1000)), 3);
    }
}

/// Writes times in ISO 8601, UTC: `2026-11-21T13:15:36.962Z`. In a log a thousand entries share a second,
/// so the text of the last second is reused.
#[derive(Debug, Default)]
pub(crate) struct IsoWriter {
    second: i64,
    written: String,
}

impl IsoWriter {
    pub(crate) fn push(&mut self, out: &mut String, at: UnixMs) {
        let second = at.0.div_euclid(1000);
        if second != self.second || self.written.is_empty() {
            self.second = second;
            self.written.clear();
            let (year, month, day) = civil_from_days(at.0.div_euclid(MS_A_DAY));
            push_date(&mut self.written, [year, month, day], "-");
            self.written.push('T');
            push_clock(&mut self.written, at.0, ":");
        }
        out.push_str(&self.written);
        at.push_millis(out);
        out.push('Z');
    }
}

/// Adds a moment in microseconds since 1970 in ISO 8601, UTC, to the millisecond.
pub fn push_iso(out: &mut String, unix_us: i64) {
    IsoWriter::default().push(out, UnixMs(unix_us.div_euclid(1000)));
}

fn push_date(out: &mut String, [year, month, day]: [i64; 3], separator: &str) {
    push_padded(out, unsigned(year), 4);
    out.push_str(separator);
    push_padded(out, unsigned(month), 2);
    out.push_str(separator);
    push_padded(out, unsigned(day), 2);
}

/// Hours, minutes and seconds.
fn push_clock(out: &mut String, ms: i64, separator: &str) {
    let second_of_day = unsigned(ms.rem_euclid(MS_A_DAY)) / 1000;
    push_padded(out, second_of_day / 3600, 2);
    out.push_str(separator);
    push_padded(out, second_of_day / 60 % 60, 2);
    out.push_str(separator);
    push_padded(out, second_of_day % 60, 2);
}

/// Seconds to the millisecond, `12.345`.
pub(crate) fn push_seconds(out: &mut String, micros: u64) {
    let millis = micros / 1000;
    push_decimal(out, millis / 1000);
    out.push('.');
    push_padded(out, millis % 1000, 3);
}

/// Seconds to the microsecond, `12.345678`.
pub(crate) fn push_seconds_to_us(out: &mut String, micros: u64) {
    push_decimal(out, micros / 1_000_000);
    out.push('.');
    push_padded(out, micros % 1_000_000, 6);
}

/// Converts a number that is never negative.
fn unsigned(value: i64) -> u64 {
    u64::try_from(value).unwrap_or_default()
}

/// Year, month 1-12 and day 1-31 in the Gregorian calendar, from the days since 1 January 1970.
///
/// Source: `civil_from_days` in Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms",
/// <https://howardhinnant.github.io/date_algorithms.html>. It counts years from 1 March, so that a leap
/// day is the last of its year, and in eras of 400 years, which all have 146,097 days.
const fn civil_from_days(days: i64) -> (i64, i64, i64) {
    // Days since 1 March of the year 0.
    let days = days + 719_468;
    let era = days.div_euclid(146_097);
    let day_of_era = days.rem_euclid(146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    // 0 is March.
    let month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let (month, next_year) = if month < 10 {
        (month + 3, 0)
    } else {
        (month - 9, 1)
    };
    (year_of_era + era * 400 + next_year, month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By `date -u -d 2026-11-21T13:15:36Z +%s`.
    const SAMPLE: f64 = 1_795_266_936_962.0;

    fn iso(unix_ms: f64, micros: u64) -> String {
        let mut out = String::new();
        let at = WallClock::new(unix_ms, 0).utc(Instant::from_micros(micros));
        IsoWriter::default().push(&mut out, at);
        out
    }

    #[test]
    fn dates_are_those_of_the_calendar() {
        // By `date -u -d <date> +%s`, divided by 86,400.
        for (days, date) in [
            (0, (1970, 1, 1)),
            (-1, (1969, 12, 31)),
            (58, (1970, 2, 28)),
            (59, (1970, 3, 1)),
            (789, (1972, 2, 29)),
            (11_016, (2000, 2, 29)),
            (11_017, (2000, 3, 1)),
            (20_453, (2025, 12, 31)),
            (20_454, (2026, 1, 1)),
            (20_778, (2026, 11, 21)),
            (47_540, (2100, 2, 28)),
            (47_541, (2100, 3, 1)),
        ] {
            assert_eq!(civil_from_days(days), date);
        }
    }

    #[test]
    fn every_day_of_four_centuries_follows_the_one_before() {
        let mut before = civil_from_days(-1);
        for days in 0..146_097 {
            let (year, month, day) = civil_from_days(days);
            let next = match before {
                (last_year, 12, 31) => (last_year + 1, 1, 1),
                (same_year, same_month, last_day) if (year, month) == (same_year, same_month) => {
                    (year, month, last_day + 1)
                }
                (same_year, last_month, _) => (same_year, last_month + 1, 1),
            };
            assert_eq!((year, month, day), next);
            before = next;
        }
        assert_eq!(before, (2369, 12, 31));
    }

    #[test]
    fn times_are_iso_8601_in_utc_to_the_millisecond() {
        assert_eq!(iso(0.0, 0), "1970-01-01T00:00:00.000Z");
        assert_eq!(iso(SAMPLE, 0), "2026-11-21T13:15:36.962Z");
        assert_eq!(iso(SAMPLE, 37_999), "2026-11-21T13:15:36.999Z");
        assert_eq!(iso(SAMPLE, 38_000), "2026-11-21T13:15:37.000Z");
        assert_eq!(iso(951_782_399_999.5, 0), "2000-02-28T23:59:59.999Z");
        assert_eq!(iso(951_782_399_999.5, 500), "2000-02-29T00:00:00.000Z");
    }

    #[test]
    fn a_second_that_was_kept_is_not_that_of_another_minute() {
        let clock = WallClock::new(SAMPLE, 0);
        let mut writer = IsoWriter::default();
        let mut out = String::new();
        for millis in [0, 20, 60_000, 3_600_000, 86_400_000] {
            out.clear();
            writer.push(&mut out, clock.utc(Instant::from_millis(millis)));
        }
        assert_eq!(out, "2026-11-22T13:15:36.962Z");
    }

    #[test]
    fn local_time_is_ahead_in_the_east_and_behind_in_the_west() {
        let shown = |minutes| {
            let mut out = String::new();
            let clock = WallClock::new(SAMPLE, 0).with_local_time(LocalTime::fixed(minutes));
            clock.local(Instant::ZERO).push_time_of_day(&mut out);
            out.push(' ');
            clock.push_file_stamp(&mut out, Instant::ZERO);
            out
        };
        assert_eq!(shown(0), "13:15:36.962 20261121-131536");
        assert_eq!(shown(60), "14:15:36.962 20261121-141536");
        assert_eq!(shown(765), "02:00:36.962 20261122-020036");
        assert_eq!(shown(-840), "23:15:36.962 20261120-231536");
    }

    #[test]
    fn seconds_are_cut_to_the_millisecond() {
        let shown = |micros| {
            let mut out = String::new();
            push_seconds(&mut out, micros);
            out
        };
        assert_eq!(shown(0), "0.000");
        assert_eq!(shown(1_999), "0.001");
        assert_eq!(shown(61_005_000), "61.005");
    }
}
