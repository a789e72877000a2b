//! The values at the crosshair.

use leptos::prelude::GetUntracked;
use motorlink_messages::protocol::{Instant, family::Model};

use crate::{
    features::graph::{
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
    },
    model::history::History,
};

impl Stage {
    pub(crate) fn show_crosshair(
        &mut self,
        chart: Chart,
        view: View,
        grid: Grid,
        history: &History,
        subject: &Subject,
        now_us: u64,
    ) {
        let width = f64::from(self.layout.columns());
        let column = match chart.crosshair.get() {
            Crosshair::None => None,
            Crosshair::Pointer(x) => Some(self.layout.column(x)),
            Crosshair::Moment(at_us) => Some(grid.place(at_us)),
        };
        let column = column.filter(|column| (0.0..=width).contains(column));
        let (Some(column), Some(_)) = (column, subject.newest(history)) else {
            self.overlay.hide();
            return;
        };
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
        let model = chart.page.model.get_untracked();
        let values = values_at(history, subject, model, Instant::from_micros(at_us));
        let by_keys = matches!(chart.crosshair.get(), Crosshair::Moment(_));
        let x = self.layout.x(column);
        self.overlay.show(x, when, values, by_keys);
    }
}

/// The values at a time.
fn values_at(
    history: &History,
    subject: &Subject,
    model: Model,
    at: Instant,
) -> Vec<CrosshairValue> {
    match subject {
        Subject::Motor { id, mirror, traces } => {
            let values = |track| crosshair::values(track, *mirror, model, at);
            let values = history.track(*id).map(values);
            let values = values.unwrap_or_default();
            let on = Trace::ALL.into_iter().filter(|trace| traces.has(*trace));
            on.map(|trace| CrosshairValue::Trace(trace, values.text(trace)))
                .collect()
        }
        Subject::Compared(comparison) => crosshair::compared(history, comparison, model, at)
            .into_iter()
            .map(|(place, _, value)| CrosshairValue::Motor(place, value))
            .collect(),
    }
}
