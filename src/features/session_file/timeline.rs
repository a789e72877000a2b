//! The whole session in one picture: for each motor the range of its speed and current over time, and all events.

use std::fmt::Write;

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::sessions::SessionInfo;

use crate::{features::session_file::player::Player, ui::reactive::dynamic};

/// Width and height of the picture of a motor, in its own units.
const SIZE: (u64, u64) = (1_000, 60);

/// Least and greatest value of each bucket of time.
type Buckets = [Option<[i16; 2]>];

/// A longer time without a reply is empty, as in the graph. A standing motor is queried ten times a second, so in a
/// short session most buckets between two replies are empty.
const GAP_US: u64 = 1_000_000;

/// The pictures of all motors that have replied, one below the other.
pub(super) fn timeline(player: Player, info: &SessionInfo) -> impl IntoView + use<> {
    let (marks, errors) = (lines(info, false), lines(info, true));
    let motors: Vec<_> = info
        .motors
        .iter()
        // A scan sends frames to every ID.
        .filter(|motor| motor.replies > 0)
        .map(|motor| {
            let speed = area(&motor.speeds, info.bucket_us, info.duration_us);
            let current = area(&motor.currents, info.bucket_us, info.duration_us);
            let name = tr!("Motor {id}: speed and current over time", id = motor.id);
            view! {
                <figure class="session-motor">
                    <figcaption>{motor.id.to_string()}</figcaption>
                    <svg
                        role="img"
                        aria-label=name
                        viewBox=format!("0 0 {} {}", SIZE.0, SIZE.1)
                        preserveAspectRatio="none"
                    >
                        <path class="session-zero" d=format!("M0 {0}H{1}", SIZE.1 / 2, SIZE.0) />
                        <path class="session-current" d=current />
                        <path class="session-speed" d=speed />
                        <path class="session-mark" d=marks.clone() />
                        <path class="session-mark bad" d=errors.clone() />
                        {bookmarks(player, info.duration_us)}
                    </svg>
                </figure>
            }
        })
        .collect();
    motors
}

/// The speeds of all motors over each other and the events, behind the slider of a replay.
pub(super) fn strip(player: Player, info: &SessionInfo) -> impl IntoView + use<> {
    let speeds: Vec<_> = info
        .motors
        .iter()
        .map(|motor| {
            let speed = area(&motor.speeds, info.bucket_us, info.duration_us);
            view! { <path class="session-speed" d=speed /> }
        })
        .collect();
    let [others, errors] = [false, true].map(|errors| lines(info, errors));
    view! {
        <svg
            class="replay-strip"
            aria-hidden="true"
            viewBox=format!("0 0 {} {}", SIZE.0, SIZE.1)
            preserveAspectRatio="none"
        >
            {speeds}
            <path class="session-mark" d=others />
            <path class="session-mark bad" d=errors />
            {bookmarks(player, info.duration_us)}
        </svg>
    }
}

/// The bookmarks as vertical lines.
fn bookmarks(player: Player, duration_us: u64) -> impl IntoView {
    let lines = move || {
        player.bookmarks.with(|bookmarks| {
            let entries = bookmarks.entries().iter();
            path(entries.map(|entry| entry.bookmark.after_us), duration_us)
        })
    };
    view! { <path class="session-mark session-bookmark-line" d=dynamic(lines) /> }
}

/// The events that are errors, or all others, as vertical lines in one path.
fn lines(info: &SessionInfo, errors: bool) -> String {
    let marks = info.marks.iter();
    let marks = marks.filter(|mark| mark.error == errors && !mark.is_bookmark);
    path(marks.map(|mark| mark.after_us), info.duration_us)
}

/// Vertical lines at these times, which ascend, as a path. At most one at each place, so that a path has a bound.
fn path(times: impl Iterator<Item = u64>, duration_us: u64) -> String {
    let mut path = String::new();
    let mut last = None;
    for after_us in times {
        let x = x(after_us, duration_us);
        if last.replace(x) != Some(x) {
            // Writing to a string cannot fail.
            let _ = write!(path, "M{x} 0V{}", SIZE.1);
        }
    }
    path
}

fn x(at_us: u64, duration_us: u64) -> u64 {
    let share = u128::from(at_us.min(duration_us)) * u128::from(SIZE.0);
    u64::try_from(share / u128::from(duration_us.max(1))).unwrap_or(SIZE.0)
}

/// The outline of a value between its least and greatest, as a path: each stretch of time with replies is a closed
/// area. The zero is in the middle, and the greatest magnitude of the session reaches an edge.
fn area(buckets: &Buckets, bucket_us: u64, duration_us: u64) -> String {
    let values = buckets.iter().flatten().flatten();
    let greatest = values.map(|value| i64::from(*value).abs()).max();
    let greatest = greatest.unwrap_or(0).max(1);
    let middle = i64::try_from(SIZE.1 / 2).unwrap_or(0);
    let y = |value: i64| middle - value * (middle - 1) / greatest;
    let mut path = String::new();
    let mut stretch: Vec<(u64, u64, i64, i64)> = Vec::new();
    let mut close = |stretch: &mut Vec<(u64, u64, i64, i64)>| {
        // Writing to a string cannot fail.
        for (place, (from, to, _, high)) in stretch.iter().enumerate() {
            let begin = if place == 0 { 'M' } else { 'L' };
            let _ = write!(path, "{begin}{from} {high}H{to}");
        }
        for (from, to, low, _) in stretch.iter().rev() {
            // At least a pixel high, so that a constant value is seen.
            let _ = write!(path, "L{to} {}H{from}", low + 1);
        }
        if !stretch.is_empty() {
            path.push('Z');
        }
        stretch.clear();
    };
    let mut empty_us = 0;
    for (number, bucket) in (0_u64..).zip(buckets) {
        let Some(bucket) = bucket else {
            empty_us += bucket_us;
            continue;
        };
        if std::mem::take(&mut empty_us) > GAP_US {
            close(&mut stretch);
        }
        let from = x(number.saturating_mul(bucket_us), duration_us);
        let to = x((number + 1).saturating_mul(bucket_us), duration_us);
        let [least, most] = bucket.map(i64::from);
        stretch.push((from, to.max(from + 1), y(least), y(most)));
    }
    close(&mut stretch);
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_reaches_the_edge_at_its_greatest_and_gaps_stay_empty() {
        let speeds = [Some([0, 100]), Some([100, 100]), None, Some([-50, -50])];
        let path = area(&speeds, 2 * GAP_US, 8 * GAP_US);
        assert_eq!(
            path,
            "M0 1H250L250 1H500L500 2H250L250 31H0ZM750 44H1000L1000 45H750Z"
        );
        let is_split =
            |bucket_us| area(&speeds, bucket_us, 4 * bucket_us).matches('Z').count() == 2;
        assert_eq!([GAP_US, GAP_US + 1].map(is_split), [false, true]);
    }

    #[test]
    fn the_last_of_many_marks_is_drawn_and_no_place_twice() {
        let times = (0..5_000).chain([1_000_000]);
        assert_eq!(
            path(times, 1_000_000),
            "M0 0V60M1 0V60M2 0V60M3 0V60M4 0V60M1000 0V60"
        );
    }

    #[test]
    fn no_replies_and_no_time_draw_nothing_outside() {
        assert_eq!(area(&[], 0, 0), "");
        let widest = [Some([i16::MIN, i16::MAX])];
        assert_eq!(area(&widest, 1, 0), "M0 2H1L1 60H0Z");
        assert_eq!([x(7, 0), x(u64::MAX, u64::MAX)], [0, 1_000]);
    }
}
