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
        crosshair::{self, Values},
        marks::Mark,
        texts, ticks,
        trace::Trace,
        view::View,
    },
    stage::Stage,
    state::{Chart, Crosshair},
};

/// How near to a mark the crosshair says its words, in CSS pixels.
const NEAR_PX: f64 = 6.0;
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
        let reference_us = chart.reference.get_untracked();
        let second = reference_us.map(|at_us| grid.place(at_us));
        let second = second.filter(|column| (0.0..=width).contains(column));
        self.overlay
            .show_second(second.map(|column| self.layout.x(column)));
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
                self.overlay.show_newest(values_at(shown, model, at, None));
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
        let when = match reference_us {
            Some(from_us) => format!("{when}, {}", texts::since(at_us, from_us)),
            None => when,
        };
        let x = self.layout.x(column);
        let near = |mark: &&Mark| {
            let at = self.layout.x(grid.place(mark.at.as_micros()));
            (at - x).abs() <= NEAR_PX
        };
        let when = match shown.marks.iter().rfind(near) {
            Some(mark) => format!("{when}, {}", mark.words),
            None => when,
        };
        let reference = reference_us.map(Instant::from_micros);
        let values = values_at(shown, model, Instant::from_micros(at_us), reference);
        let by_keys = matches!(chart.crosshair.get(), Crosshair::Moment(_));
        self.overlay.show(x, &when, values, by_keys);
    }
}

/// The values at a time, with their difference to those at the second cursor.
fn values_at(
    Content {
        history,
        subject,
        kept,
        ..
    }: Content<'_>,
    model: Model,
    at: Instant,
    reference: Option<Instant>,
) -> Vec<CrosshairValue> {
    match subject {
        Subject::Motor { id, mirror, traces } => {
            let values_at = |at| {
                let values = |track| crosshair::values(track, *mirror, model, at);
                history.track(*id).map(values).unwrap_or_default()
            };
            let values: Values = values_at(at);
            let reference = reference.map(values_at);
            let kept = kept.and_then(|kept| kept.values(model, at));
            let text = |trace| {
                let value = with_difference(&values, reference.as_ref(), trace);
                match &kept {
                    Some(kept) => tr!("{value} (kept {kept})", value, kept = kept.text(trace)),
                    None => value,
                }
            };
            let on = Trace::ALL.into_iter().filter(|trace| traces.has(*trace));
            on.map(|trace| CrosshairValue::Trace(trace, text(trace)))
                .collect()
        }
        Subject::Compared(comparison) => {
            let value = |(place, id, mirror)| {
                let track = history.track(id)?;
                let values = |at| crosshair::values(track, mirror, model, at);
                let reference = reference.map(values);
                let text = with_difference(&values(at), reference.as_ref(), comparison.trace);
                Some(CrosshairValue::Motor(place, text))
            };
            comparison.motors().filter_map(value).collect()
        }
    }
}

/// `+100 rpm (Δ +50 rpm)`
fn with_difference(values: &Values, reference: Option<&Values>, trace: Trace) -> String {
    let value = values.text(trace);
    match reference {
        Some(reference) if trace != Trace::Goal => {
            format!("{value} (Δ {})", values.since(reference, trace))
        }
        _ => value,
    }
}
