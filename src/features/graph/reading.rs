//! The values at the crosshair.

use leptos::prelude::GetUntracked;
use motorlink_i18n::tr;
use motorlink_messages::protocol::{Instant, family::Model};

use crate::features::graph::{
    description::Content,
    overlay::CrosshairValue,
    plot::{
        columns::Grid,
        comparison::{Subject, marked},
        crosshair, texts, ticks,
        trace::Trace,
        view::View,
    },
    stage::Stage,
    state::{Chart, Crosshair},
};

/// Minimal time between updates of the newest values: faster ones cannot be read.
const READ_EVERY_MS: f64 = 200.0;

impl Stage {
    pub(crate) fn show_crosshair(
        &mut self,
        chart: Chart,
        view: View,
        grid: Grid,
        shown: Content<'_>,
        now_us: u64,
        frame_ms: f64,
    ) {
        let Content {
            history, subject, ..
        } = shown;
        let width = f64::from(self.layout.columns());
        let column = match chart.crosshair.get() {
            Crosshair::None => None,
            Crosshair::Pointer(x) => Some(self.layout.column(x)),
            Crosshair::Moment(at_us) => Some(grid.place(at_us)),
        };
        let column = column.filter(|column| (0.0..=width).contains(column));
        let model = chart.page.model.get_untracked();
        let (Some(column), Some(_)) = (column, subject.newest(history)) else {
            self.overlay.hide();
            if frame_ms - self.read_ms >= READ_EVERY_MS {
                self.read_ms = frame_ms;
                let at = Instant::from_micros(view.right_us(now_us));
                self.overlay.show_newest(values_at(shown, model, at));
            }
            return;
        };
        self.read_ms = f64::NEG_INFINITY;
        let at_us = match chart.crosshair.get() {
            Crosshair::Moment(at_us) => at_us,
            _ => grid.moment_us(column),
        };
        let when = if view.is_live() {
            texts::ago(now_us.saturating_sub(at_us))
        } else {
            ticks::time_of_day(chart.day_us(at_us) / 1_000, 1)
        };
        let when = match subject {
            Subject::Motor { mirror, .. } => marked(when, *mirror),
            Subject::Compared(_) => when,
        };
        let values = values_at(shown, model, Instant::from_micros(at_us));
        let by_keys = matches!(chart.crosshair.get(), Crosshair::Moment(_));
        let x = self.layout.x(column);
        self.overlay.show(x, when, values, by_keys);
    }
}

/// The values at a time.
fn values_at(
    Content {
        history,
        subject,
        kept,
    }: Content<'_>,
    model: Model,
    at: Instant,
) -> Vec<CrosshairValue> {
    match subject {
        Subject::Motor { id, mirror, traces } => {
            let values = |track| crosshair::values(track, *mirror, model, at);
            let values = history.track(*id).map(values);
            let values = values.unwrap_or_default();
            let kept = kept.and_then(|kept| kept.values(model, at));
            let text = |trace| {
                let value = values.text(trace);
                match &kept {
                    Some(kept) => tr!("{value} (kept {kept})", value, kept = kept.text(trace)),
                    None => value,
                }
            };
            let on = Trace::ALL.into_iter().filter(|trace| traces.has(*trace));
            on.map(|trace| CrosshairValue::Trace(trace, text(trace)))
                .collect()
        }
        Subject::Compared(comparison) => crosshair::compared(history, comparison, model, at)
            .into_iter()
            .map(|(place, _, value)| CrosshairValue::Motor(place, value))
            .collect(),
    }
}
