//! Parses the times of CSV files.

const US_A_SECOND: i64 = 1_000_000;
const SECONDS_A_DAY: i64 = 86_400;
/// A time of day that goes back by more than this belongs to the next day.
const HALF_A_DAY_US: i64 = SECONDS_A_DAY / 2 * US_A_SECOND;

/// A time as written in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Time {
    /// Microseconds since 1970, UTC.
    Utc(i64),
    /// Microseconds since midnight, in an unknown time zone.
    OfDay(i64),
}

impl Time {
    pub(super) const fn has_date(self) -> bool {
        matches!(self, Self::Utc(_))
    }

    /// Reads `2026-11-21T13:15:36.962Z`, the same as pandas writes it, `2026-11-21 13:15:36.962000+00:00`, or `13:15:36.962`.
    pub(super) fn read(text: &str) -> Option<Self> {
        let Some((date, clock)) = text.split_once(['T', ' ']) else {
            return Some(Self::OfDay(clock_us(text)?));
        };
        let mut parts = date.split('-');
        let mut number = |digits| parts.next().and_then(|part| digits_of(part, digits));
        let (year, month, day) = (number(4)?, number(2)?, number(2)?);
        if parts.next().is_some() || !(1..=12).contains(&month) || !(1..=31).contains(&day) {
            return None;
        }
        let days = days_from_civil(year, month, day);
        let clock = clock.strip_suffix('Z').or(clock.strip_suffix("+00:00"));
        let clock_us = clock_us(clock?)?;
        Some(Self::Utc(days * SECONDS_A_DAY * US_A_SECOND + clock_us))
    }
}

/// `13:15:36.962`, or without a fraction, or with up to six digits of it, behind a comma where that is the decimal mark.
fn clock_us(text: &str) -> Option<i64> {
    let (clock, fraction) = text.split_once(['.', ',']).unwrap_or((text, "0"));
    let mut parts = clock.split(':');
    let mut number = || parts.next().and_then(|part| digits_of(part, 2));
    let (hours, minutes, seconds) = (number()?, number()?, number()?);
    let is_clock = hours < 24 && minutes < 60 && seconds <= 60 && parts.next().is_none();
    let digits = u32::try_from(fraction.len())
        .ok()
        .filter(|digits| *digits <= 6)?;
    let fraction_us = digits_of(fraction, fraction.len())? * 10_i64.pow(6 - digits);
    let seconds = (hours * 60 + minutes) * 60 + seconds;
    is_clock.then_some(seconds * US_A_SECOND + fraction_us)
}

/// A number with exactly this many digits.
fn digits_of(text: &str, digits: usize) -> Option<i64> {
    let is_number = text.len() == digits && text.bytes().all(|byte| byte.is_ascii_digit());
    text.parse().ok().filter(|_| is_number)
}

/// Days since 1 January 1970, in the Gregorian calendar.
///
/// Source: `days_from_civil` in Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms",
/// <https://howardhinnant.github.io/date_algorithms.html>.
const fn days_from_civil(year: i64, month: i64, day: i64) -> i64 {
    // Years begin on 1 March.
    let year = if month <= 2 { year - 1 } else { year };
    let era = year.div_euclid(400);
    let year_of_era = year.rem_euclid(400);
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
    era * 146_097 + day_of_era - 719_468
}

/// Converts times of day to increasing times, also over midnight.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Clock {
    days_us: i64,
    before_us: i64,
}

impl Clock {
    /// Microseconds since 1970, or since the first midnight.
    pub(super) fn unix_us(&mut self, time: Time) -> i64 {
        match time {
            Time::Utc(us) => us,
            Time::OfDay(us) => {
                if self.before_us - us > HALF_A_DAY_US {
                    self.days_us += SECONDS_A_DAY * US_A_SECOND;
                }
                self.before_us = us;
                self.days_us + us
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read() {
        // By `date -u -d 2026-11-21T13:15:36Z +%s`.
        let sample = Some(Time::Utc(1_795_266_936_962_000));
        assert_eq!(Time::read("2026-11-21T13:15:36.962Z"), sample);
        assert_eq!(Time::read("2026-11-21 13:15:36.962000+00:00"), sample);
        assert_eq!(Time::read("13:15:36,962"), Time::read("13:15:36.962"));
        assert_eq!(Time::read("1970-01-01T00:00:00.000Z"), Some(Time::Utc(0)));
        assert_eq!(
            Time::read("2000-02-29T00:00:00.000Z"),
            Some(Time::Utc(951_782_400_000_000))
        );
        assert_eq!(
            Time::read("13:15:36.962"),
            Some(Time::OfDay(47_736_962_000))
        );
        for other in [
            "",
            "T",
            "2026-11-21",
            "2026-11-21T13:15:36.962",
            "2026-11-21 13:15:36",
            "15:36.9",
            "2026-13-01T00:00:00.000Z",
            "24:00:00",
            "1:2:3",
            "13:15",
            "13:15:36.1234567",
            "13:15:36.",
            "+1:15:36",
            "13:15:36:00",
        ] {
            assert_eq!(Time::read(other), None, "{other}");
        }
    }

    #[test]
    fn midnight_is_passed_and_a_small_step_back_is_not_a_day() {
        let mut clock = Clock::default();
        let mut at = |text| clock.unix_us(Time::read(text).unwrap()) / US_A_SECOND;
        assert_eq!(at("23:59:59.900"), 86_399);
        assert_eq!(at("23:59:58.900"), 86_398);
        assert_eq!(at("00:00:01.000"), 86_401);
        assert_eq!(at("12:00:00.000"), 86_400 + 43_200);
    }
}
