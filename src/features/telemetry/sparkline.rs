//! Decimates reports at the full rate to a line of a few hundred points without losing a peak.
//!
//! Every column keeps its least and its greatest value. Columns are aligned to the clock, not to the edge of the
//! drawing, so that their shape does not change as the line moves.

use std::fmt::Write;

use motorlink_messages::bus::FRESH_FOR;

use crate::features::telemetry::recent::Recent;

/// Width of a column in the drawing's units.
pub(crate) const COLUMN_WIDTH: u16 = 10;
/// From the middle of the drawing to its upper edge, in its units.
pub(crate) const HALF_HEIGHT: i32 = 500;
/// Margin of the largest value to the edge, so that the line is not cut off.
const MARGIN: i32 = 40;

/// The reports within one column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Column {
    /// Counted from the clock's zero.
    number: f64,
    /// The first report in it and the last, in milliseconds.
    from_ms: f64,
    to_ms: f64,
    low: i32,
    high: i32,
}

/// The columns of the last ten seconds, oldest first, without empty ones. Reports are a time in milliseconds and a
/// value, oldest first.
pub(crate) fn columns(
    reports: impl Iterator<Item = (f64, i32)>,
    now_ms: f64,
    count: u16,
) -> Vec<Column> {
    let width_ms = column_ms(count);
    let oldest = (now_ms / width_ms).floor() - f64::from(count);
    let mut columns: Vec<Column> = Vec::with_capacity(usize::from(count) + 1);
    for (at_ms, value) in reports {
        let number = (at_ms / width_ms).floor();
        if number < oldest {
            continue;
        }
        match columns.last_mut().filter(|last| last.number >= number) {
            Some(last) => {
                last.to_ms = at_ms;
                last.low = last.low.min(value);
                last.high = last.high.max(value);
            }
            None => columns.push(Column {
                number,
                from_ms: at_ms,
                to_ms: at_ms,
                low: value,
                high: value,
            }),
        }
    }
    columns
}

/// The largest magnitude among them.
pub(crate) fn peak(columns: &[Column]) -> i32 {
    let magnitude = |column: &Column| column.high.max(-column.low);
    columns.iter().map(magnitude).max().unwrap_or(0)
}

/// The line as path data, with the present at the right edge. A value of `limit` is at the upper edge. Gaps in which
/// the value was unknown have no line.
#[allow(
    clippy::cast_possible_truncation,
    reason = "a place in the drawing, and a float cast saturates"
)]
pub(crate) fn path(columns: &[Column], now_ms: f64, count: u16, limit: i32) -> String {
    let mut path = String::with_capacity(columns.len() * 16);
    let left = now_ms / column_ms(count) - f64::from(count);
    let silence_ms = FRESH_FOR.as_secs_f64() * 1000.0;
    let mut before: Option<(f64, i32)> = None;
    for column in columns {
        let x = ((column.number + 0.5 - left) * f64::from(COLUMN_WIDTH)) as i32;
        let (low, high) = (height(column.low, limit), height(column.high, limit));
        let follows = before.filter(|(to_ms, _)| column.from_ms - to_ms <= silence_ms);
        // The nearer end first, so that the line does not cross itself.
        let (first, second) = match follows {
            Some((_, y)) if (y - low).abs() > (y - high).abs() => (high, low),
            _ => (low, high),
        };
        // Writing to a string cannot fail.
        let _ = match follows {
            Some(_) => write!(path, "L{x} {first}"),
            // A line without length draws a dot, if nothing follows.
            None => write!(path, "M{x} {first}h0"),
        };
        if first != second {
            let _ = write!(path, "V{second}");
        }
        before = Some((column.to_ms, second));
    }
    path
}

/// Downwards from the upper edge.
fn height(value: i32, limit: i32) -> i32 {
    let limit = limit.max(1);
    HALF_HEIGHT - value.clamp(-limit, limit) * (HALF_HEIGHT - MARGIN) / limit
}

fn column_ms(count: u16) -> f64 {
    Recent::SPAN_MS / f64::from(count.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW_MS: f64 = 123_456.0;
    const LIMIT: i32 = 400;

    /// Ten seconds at 500 Hz; one value differs.
    fn with_spike(place: usize, value: i32) -> impl Iterator<Item = (f64, i32)> {
        (0_u16..5_000).map(move |number| {
            let at_ms = NOW_MS - 9_999.0 + f64::from(number) * 2.0;
            (
                at_ms,
                if usize::from(number) == place {
                    value
                } else {
                    100
                },
            )
        })
    }

    /// Every height that the line touches.
    fn heights(path: &str) -> Vec<i32> {
        let parts = path.split(['M', 'L', 'V', ' ', 'h']).collect::<Vec<_>>();
        parts.iter().filter_map(|part| part.parse().ok()).collect()
    }

    #[test]
    fn a_spike_of_one_report_is_seen_at_every_width() {
        for count in 20..=400 {
            for (place, value) in [
                (0, 330),
                (1, -330),
                (2_500, 330),
                (4_998, -330),
                (4_999, 330),
            ] {
                let columns = columns(with_spike(place, value), NOW_MS, count);
                assert_eq!(peak(&columns), 330, "{count} columns");
                let path = path(&columns, NOW_MS, count, LIMIT);
                let wanted = height(value, LIMIT);
                assert!(
                    heights(&path).contains(&wanted),
                    "{value} in {count} columns"
                );
            }
        }
    }

    #[test]
    fn there_are_no_more_columns_than_asked_for_and_the_two_that_are_cut() {
        for count in [20, 160, 400] {
            let columns = columns(with_spike(7, 0), NOW_MS, count);
            let found = columns.len();
            assert!(
                (usize::from(count)..=usize::from(count) + 1).contains(&found),
                "{found}"
            );
        }
    }

    /// Or the line would shimmer.
    #[test]
    fn a_column_keeps_its_values_while_the_line_moves_on() {
        let noisy = || {
            (0_u16..5_000).map(|number| {
                let value = i32::from(number).wrapping_mul(7_919) % 101;
                (NOW_MS - 9_999.0 + f64::from(number) * 2.0, value)
            })
        };
        let before = columns(noisy(), NOW_MS, 160);
        let after = columns(noisy(), NOW_MS + 137.0, 160);
        for column in &after {
            assert!(before.contains(column));
        }
    }

    #[test]
    fn where_nothing_was_heard_there_is_no_line() {
        let reports = [(0.0, 5), (100.0, 5), (601.0, 7), (1_102.0, 9)];
        let columns = columns(reports.into_iter(), 2_000.0, 100);
        let path = path(&columns, 2_000.0, 100, 10);
        assert_eq!(path.matches('M').count(), 3, "{path}");
        assert_eq!(path.matches('L').count(), 1, "{path}");
        assert!(path.ends_with("h0"), "a lone report is a dot: {path}");
    }

    #[test]
    fn nothing_heard_is_no_line_at_all() {
        let none = columns(std::iter::empty(), NOW_MS, 160);
        assert_eq!(path(&none, NOW_MS, 160, LIMIT), "");
        assert_eq!(peak(&none), 0);
    }

    #[test]
    fn now_is_at_the_right_edge_and_up_is_positive() {
        let columns = columns([(NOW_MS, 400)].into_iter(), NOW_MS, 100);
        let path = path(&columns, NOW_MS, 100, LIMIT);
        let x: i32 = path[1..].split(' ').next().unwrap().parse().unwrap();
        assert!((990..=1_005).contains(&x), "{path}");
        assert_eq!(heights(&path)[1], MARGIN);
        assert_eq!(height(-400, LIMIT), 2 * HALF_HEIGHT - MARGIN);
        assert_eq!(height(0, LIMIT), HALF_HEIGHT);
        // Never outside the picture.
        assert_eq!(height(9_999, LIMIT), MARGIN);
    }
}
