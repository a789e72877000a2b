//! The shown period of time.
//!
//! All times are microseconds of the history's clock.

use crate::ui::mathematics::limited;

/// The windows that have a button, in microseconds.
pub(crate) const WINDOWS: [(u64, &str); 3] = [
    (10_000_000, "10 s"),
    (60_000_000, "60 s"),
    (300_000_000, "5 min"),
];

/// The shortest span: a hundred replies at 500 Hz.
const SPAN_MIN_US: u64 = 200_000;
/// The longest span: the whole history.
const SPAN_MAX_US: u64 = 600_000_000;

/// The closest span that the graph can show.
pub(crate) fn limited_span(span_us: u64) -> u64 {
    span_us.clamp(SPAN_MIN_US, SPAN_MAX_US)
}

/// The position of the right edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Watch {
    /// It follows the present.
    Live,
    /// The user has moved it to this time.
    Panned(u64),
    /// The user has pressed Pause: it stays at this time.
    Paused(u64),
}

/// A period of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct View {
    /// Length in microseconds.
    pub(crate) span_us: u64,
    pub(crate) watch: Watch,
}

/// The limits of panning at this moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) struct Reach {
    /// The oldest kept reply; now if there is none.
    pub(crate) oldest_us: u64,
    pub(crate) now_us: u64,
}

impl Default for View {
    fn default() -> Self {
        let [(span_us, _), ..] = WINDOWS;
        Self {
            span_us,
            watch: Watch::Live,
        }
    }
}

impl View {
    /// The time at the right edge.
    pub(crate) const fn right_us(self, now_us: u64) -> u64 {
        match self.watch {
            Watch::Live => now_us,
            Watch::Panned(right_us) | Watch::Paused(right_us) => right_us,
        }
    }

    pub(crate) const fn is_live(self) -> bool {
        matches!(self.watch, Watch::Live)
    }

    pub(crate) const fn is_paused(self) -> bool {
        matches!(self.watch, Watch::Paused(_))
    }

    /// The same right edge with another length.
    pub(crate) const fn with_span(self, span_us: u64) -> Self {
        Self { span_us, ..self }
    }

    /// Paused at the present right edge.
    pub(crate) const fn paused(self, now_us: u64) -> Self {
        Self {
            watch: Watch::Paused(self.right_us(now_us)),
            ..self
        }
    }

    /// Following the present.
    pub(crate) const fn live(self) -> Self {
        Self {
            watch: Watch::Live,
            ..self
        }
    }

    /// The part between two places: 0 is the left edge, 1 the right.
    pub(crate) fn part(self, (from, to): (f64, f64), reach: Reach) -> Self {
        let (from, to) = (
            limited(from.min(to), 0.0, 1.0),
            limited(from.max(to), 0.0, 1.0),
        );
        let span_us = limited_span(scaled(self.span_us, to - from).unsigned_abs());
        let moved_us = scaled(self.span_us, 1.0 - to);
        self.with_span(span_us).panned(-moved_us, reach)
    }

    /// A period of `percent` of the length. The moment at `place` keeps its position: 0 is the left edge, 1 the
    /// right.
    pub(crate) fn zoomed(self, percent: u64, place: f64, reach: Reach) -> Self {
        let span_us = limited_span(self.span_us.saturating_mul(percent) / 100);
        let right_of_place = 1.0 - limited(place, 0.0, 1.0);
        // The distance from `place` to the right edge changes by this.
        let moved_us = scaled(self.span_us, right_of_place) - scaled(span_us, right_of_place);
        self.with_span(span_us).panned(-moved_us, reach)
    }

    /// Moved by this time, positive is later, but not beyond now and not before the oldest reply. A view that reaches
    /// now follows the time again, unless it is paused.
    pub(crate) fn panned(self, by_us: i64, reach: Reach) -> Self {
        let Reach { oldest_us, now_us } = reach;
        let earliest_us = oldest_us.saturating_add(self.span_us).min(now_us);
        let right_us = self.right_us(now_us).saturating_add_signed(by_us);
        let right_us = right_us.clamp(earliest_us, now_us);
        let watch = match self.watch {
            Watch::Paused(_) => Watch::Paused(right_us),
            Watch::Live | Watch::Panned(_) if right_us == now_us => Watch::Live,
            Watch::Live | Watch::Panned(_) => Watch::Panned(right_us),
        };
        Self { watch, ..self }
    }

    /// Moved so that a moment is in the middle, unless it is in view.
    pub(crate) fn showing(self, at_us: u64, reach: Reach) -> Self {
        let right_us = self.right_us(reach.now_us);
        if (right_us.saturating_sub(self.span_us)..=right_us).contains(&at_us) {
            return self;
        }
        let to_us = at_us.saturating_add(self.span_us / 2);
        let by_us = i64::try_from(to_us.abs_diff(right_us)).unwrap_or(i64::MAX);
        self.panned(if to_us < right_us { -by_us } else { by_us }, reach)
    }

    /// Moved to the oldest reply.
    pub(crate) fn at_oldest(self, reach: Reach) -> Self {
        self.panned(i64::MIN, reach)
    }

    /// Moved to now.
    pub(crate) fn at_now(self, reach: Reach) -> Self {
        self.panned(i64::MAX, reach)
    }

    /// A fraction of the length: 1 is all of it.
    pub(crate) fn part_us(self, part: f64) -> i64 {
        scaled(self.span_us, part)
    }
}

#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "ten minutes in microseconds are exact in a double, and a cast back saturates"
)]
fn scaled(span_us: u64, by: f64) -> i64 {
    (span_us as f64 * by) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: u64 = 1_000_000;
    const REACH: Reach = Reach {
        oldest_us: 100 * SECOND,
        now_us: 400 * SECOND,
    };

    fn minute() -> View {
        View::default().with_span(60 * SECOND)
    }

    fn right_s(view: View) -> u64 {
        view.right_us(REACH.now_us) / SECOND
    }

    #[test]
    fn a_view_begins_live_with_ten_seconds() {
        let view = View::default();
        assert_eq!((view.span_us, right_s(view)), (10 * SECOND, 400));
        assert!(view.is_live() && !view.is_paused());
    }

    #[test]
    fn panning_ends_at_the_oldest_and_at_now() {
        let back = minute().panned(-10_000_000, REACH);
        assert_eq!((right_s(back), back.is_live()), (390, false));
        let oldest = back.at_oldest(REACH);
        assert_eq!(right_s(oldest), 160, "the left edge is at the oldest");
        assert_eq!(oldest.panned(-1, REACH), oldest);
        assert!(back.panned(11_000_000, REACH).is_live());
        assert!(oldest.at_now(REACH).is_live());
    }

    #[test]
    fn what_is_shorter_than_the_window_cannot_be_panned() {
        let reach = Reach {
            oldest_us: 390 * SECOND,
            ..REACH
        };
        assert!(minute().panned(-5_000_000, reach).is_live());
    }

    #[test]
    fn pause_holds_the_view_through_pan_and_zoom_until_it_is_live_again() {
        let paused = minute().paused(300 * SECOND);
        assert_eq!(right_s(paused), 300);
        let moved = paused.panned(-20_000_000, REACH).zoomed(50, 1.0, REACH);
        assert_eq!((right_s(moved), moved.span_us), (280, 30 * SECOND));
        assert!(moved.is_paused());
        assert!(paused.at_now(REACH).is_paused(), "the newest, and held");
        assert!(moved.live().is_live());
        let panned = minute().panned(-20_000_000, REACH);
        assert_eq!(right_s(panned.paused(REACH.now_us)), 380);
    }

    #[test]
    fn zooming_keeps_the_moment_under_the_pointer() {
        let view = minute().panned(-100_000_000, REACH);
        for (percent, place) in [(50, 0.25), (80, 0.0), (125, 0.75), (50, 1.0)] {
            let moment = |view: View| {
                let right_us = i64::try_from(view.right_us(REACH.now_us)).unwrap();
                right_us - view.part_us(1.0 - place)
            };
            let zoomed = view.zoomed(percent, place, REACH);
            assert!(
                (moment(zoomed) - moment(view)).abs() <= 1,
                "{percent} {place}"
            );
        }
    }

    #[test]
    fn a_part_of_a_view_is_chosen_in_either_direction() {
        let view = minute().paused(300 * SECOND);
        let part = view.part((0.25, 0.5), REACH);
        assert_eq!((right_s(part), part.span_us), (270, 15 * SECOND));
        assert_eq!(view.part((0.5, 0.25), REACH), part);
        assert_eq!(
            minute().part((0.0, 0.5), REACH).watch,
            Watch::Panned(370 * SECOND)
        );
    }

    #[test]
    fn a_moment_out_of_view_is_shown_in_the_middle() {
        let view = minute().paused(300 * SECOND);
        assert_eq!(view.showing(250 * SECOND, REACH), view);
        assert_eq!(right_s(view.showing(200 * SECOND, REACH)), 230);
        assert_eq!(right_s(view.showing(350 * SECOND, REACH)), 380);
        assert_eq!(right_s(view.showing(399 * SECOND, REACH)), 400, "up to now");
    }

    #[test]
    fn a_live_view_zoomed_at_its_right_edge_stays_live() {
        assert!(minute().zoomed(50, 1.0, REACH).is_live());
        assert!(!minute().zoomed(50, 0.5, REACH).is_live());
        assert!(minute().zoomed(200, 0.5, REACH).is_live());
    }

    #[test]
    fn zooming_ends_at_a_fifth_of_a_second_and_at_ten_minutes() {
        let mut view = minute();
        for _ in 0..50 {
            view = view.zoomed(80, 1.0, REACH);
        }
        assert_eq!(view.span_us, SPAN_MIN_US);
        for _ in 0..60 {
            view = view.zoomed(125, 1.0, REACH);
        }
        assert_eq!(view.span_us, SPAN_MAX_US);
    }
}
