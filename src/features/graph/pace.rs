//! When the graph is drawn next.

use leptos::prelude::*;

use crate::{
    features::graph::{plot::columns::Grid, state::Chart},
    model::snapshot::Session,
    ui::{
        animation::Next,
        frame_rate::{FrameRate, frame_rate},
    },
};

/// Minimal time between drawings: slightly less than a frame at 60 Hz, because frame times jitter.
pub(super) const DRAWN_EVERY_MS: f64 = 15.0;

/// The columns of a wide graph of 10 s last less than this. While something moves, they are drawn in every frame; longer
/// columns when they are due.
const FRAMES_BELOW_US: u64 = 25_000;

/// Maximal delay of a report, unless the page is busy: a slow adapter delays it by 16 ms, the worker by 50 ms. A
/// paused view is drawn once more after this time.
pub(super) const SETTLED_AFTER_US: u64 = 200_000;

/// What decides how often the graph is drawn.
#[derive(Default)]
pub(super) struct Pace {
    /// When a motor was last driven or turned, or a recording was shown.
    moved_us: u64,
}

impl Pace {
    /// When the right edge enters another column. Where nothing in sight has moved, the graph is drawn in the same frames as
    /// the rest of the page.
    pub(super) fn next_column(
        &mut self,
        chart: Chart,
        grid: Grid,
        now_us: u64,
        frame_ms: f64,
    ) -> Next {
        let rate = frame_rate();
        let page = chart.page;
        if page.is_anything_driven() || page.latest.with_value(Session::is_recording) {
            self.moved_us = now_us;
        }
        let in_sight = grid.left_us()..=now_us;
        if grid.column_us >= FRAMES_BELOW_US {
            after(grid.right_us(), now_us).put_off_to_step(frame_ms)
        } else if rate == FrameRate::Full && in_sight.contains(&self.moved_us) {
            Next::Frame
        } else {
            Next::in_step(rate.step_ms(), frame_ms)
        }
    }
}

/// At this time of the history.
#[allow(
    clippy::cast_precision_loss,
    reason = "no more microseconds than a window is long"
)]
pub(super) fn after(at_us: u64, now_us: u64) -> Next {
    Next::After(at_us.saturating_sub(now_us) as f64 / 1_000.0)
}
