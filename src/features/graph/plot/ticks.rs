//! The marks of the time axis: the age while the view is live, the time of day while it is paused.

use motorlink_i18n::{terms::in_language, tr};

/// Round distances between marks, in milliseconds.
const STEPS_MS: [u64; 18] = [
    10, 20, 50, 100, 200, 500, 1_000, 2_000, 5_000, 10_000, 15_000, 30_000, 60_000, 120_000,
    300_000, 600_000, 1_200_000, 3_600_000,
];

const MINUTE_MS: u64 = 60_000;
const DAY_MS: u64 = 24 * 60 * MINUTE_MS;

/// A mark: its position from the left edge, 0, to the right edge, 1, and its label.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub(crate) place: f64,
    pub(crate) label: String,
}

/// The smallest round distance with at most `marks_max` marks in a span.
fn step_ms(span_us: u64, marks_max: u32) -> u64 {
    let least_us = span_us / u64::from(marks_max.max(1));
    let step = STEPS_MS.into_iter().find(|step| step * 1_000 >= least_us);
    step.unwrap_or(DAY_MS)
}

/// `60 s`, `50`, ... `10`, `now`: only the oldest mark has the unit.
pub(crate) fn ago(span_us: u64, marks_max: u32) -> Vec<Tick> {
    let step_ms = step_ms(span_us, marks_max);
    let marks = span_us / (step_ms * 1_000);
    let tick = |mark: u64| {
        let label = match mark {
            0 => tr!("now").to_owned(),
            _ => ago_label(mark * step_ms, step_ms, mark == marks),
        };
        Tick {
            place: 1.0 - part(mark * step_ms * 1_000, span_us),
            label,
        }
    };
    (0..=marks).rev().map(tick).collect()
}

fn ago_label(ago_ms: u64, step_ms: u64, with_unit: bool) -> String {
    let (number, unit) = if step_ms.is_multiple_of(MINUTE_MS) {
        ((ago_ms / MINUTE_MS).to_string(), " min")
    } else {
        (in_language(thousandths(ago_ms, step_ms)), " s")
    };
    number + if with_unit { unit } else { "" }
}

/// Thousandths as a number with as many decimals as the step needs: milliseconds as seconds.
pub(crate) fn thousandths(ms: u64, step_ms: u64) -> String {
    let (whole, part) = (ms / 1_000, ms % 1_000);
    if step_ms.is_multiple_of(1_000) {
        whole.to_string()
    } else if step_ms.is_multiple_of(100) {
        format!("{whole}.{}", part / 100)
    } else if step_ms.is_multiple_of(10) {
        format!("{whole}.{:02}", part / 10)
    } else {
        format!("{whole}.{part:03}")
    }
}

/// The marks with the time of day of a span that ends `right_us` after midnight.
pub(crate) fn of_day(right_us: u64, span_us: u64, marks_max: u32) -> Vec<Tick> {
    let step_ms = step_ms(span_us, marks_max);
    // A span just after midnight begins on the day before.
    let left_us = right_us + DAY_MS * 1_000 - span_us;
    let apart_us = step_ms * 1_000;
    let marks = left_us.div_ceil(apart_us)..=(left_us + span_us) / apart_us;
    let tick = |mark: u64| Tick {
        place: part(mark * apart_us - left_us, span_us),
        label: time_of_day(mark * step_ms, step_ms),
    };
    marks.map(tick).collect()
}

/// `13:15:36`, `13:15:36.9`: a time after midnight, with as many decimals as the step needs. A step of 1 ms gives
/// three.
pub(crate) fn time_of_day(ms: u64, step_ms: u64) -> String {
    let of_day_ms = ms % DAY_MS;
    let minutes = of_day_ms / MINUTE_MS;
    let of_minute_ms = of_day_ms % MINUTE_MS;
    let zero = if of_minute_ms < 10_000 { "0" } else { "" };
    let seconds = thousandths(of_minute_ms, step_ms);
    format!("{:02}:{:02}:{zero}{seconds}", minutes / 60, minutes % 60)
}

/// The fraction of a span.
#[allow(
    clippy::cast_precision_loss,
    reason = "an hour in microseconds is exact in a double"
)]
fn part(us: u64, span_us: u64) -> f64 {
    us as f64 / span_us.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: u64 = 1_000_000;

    fn labels(ticks: &[Tick]) -> String {
        let labels: Vec<&str> = ticks.iter().map(|tick| tick.label.as_str()).collect();
        labels.join(" | ")
    }

    #[test]
    fn while_live_marks_say_how_long_ago() {
        for (span_us, marks_max, wanted) in [
            (60 * SECOND, 8, "60 s | 50 | 40 | 30 | 20 | 10 | now"),
            (10 * SECOND, 8, "10 s | 8 | 6 | 4 | 2 | now"),
            (300 * SECOND, 8, "5 min | 4 | 3 | 2 | 1 | now"),
            (200_000, 5, "0.20 s | 0.15 | 0.10 | 0.05 | now"),
            (23_400_000, 5, "20 s | 15 | 10 | 5 | now"),
            (60 * SECOND, 2, "60 s | 30 | now"),
        ] {
            assert_eq!(labels(&ago(span_us, marks_max)), wanted);
        }
        let ticks = ago(60 * SECOND, 8);
        for (mark, place) in [(0, 0.0), (3, 0.5), (6, 1.0)] {
            assert!((ticks[mark].place - place).abs() < 1e-9);
        }
    }

    #[test]
    fn while_held_marks_say_the_time_of_day() {
        let at = |hour: u64, minute: u64, ms: u64| ((hour * 60 + minute) * 60_000 + ms) * 1_000;
        let ticks = of_day(at(13, 15, 41_250), 10 * SECOND, 3);
        assert_eq!(labels(&ticks), "13:15:35 | 13:15:40");
        assert!((ticks[0].place - 0.375).abs() < 1e-9);
        let fine = of_day(at(13, 15, 9_650), 200_000, 4);
        assert_eq!(
            labels(&fine),
            "13:15:09.45 | 13:15:09.50 | 13:15:09.55 | 13:15:09.60 | 13:15:09.65"
        );
    }

    #[test]
    fn midnight_is_passed() {
        let ticks = of_day(5 * SECOND, 10 * SECOND, 2);
        assert_eq!(labels(&ticks), "23:59:55 | 00:00:00 | 00:00:05");
        assert_eq!(time_of_day(DAY_MS + 962, 1), "00:00:00.962");
    }

    #[test]
    fn there_are_no_more_marks_than_fit() {
        for span_us in [200_000, 1_234_567, 10 * SECOND, 77 * SECOND, 600 * SECOND] {
            for marks_max in 1..20 {
                let most = usize::try_from(marks_max).unwrap() + 1;
                assert!(ago(span_us, marks_max).len() <= most);
                assert!(of_day(123_456_789, span_us, marks_max).len() <= most);
            }
        }
    }
}
