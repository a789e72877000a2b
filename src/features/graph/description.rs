//! The text that describes the graph for screen readers.

use leptos::prelude::GetUntracked;
use motorlink_i18n::tr;
use motorlink_messages::protocol::Instant;
use web_sys::Element;

use crate::{
    features::graph::{
        kept::state::Aligned,
        plot::{
            comparison::{Subject, marked},
            crosshair,
            marks::Mark,
            texts, ticks,
            view::View,
        },
        state::Chart,
    },
    model::history::History,
    ui::{animation::Next, text::Text},
};

/// Minimal time between updates: more frequent ones would interrupt the screen reader.
const UPDATE_PERIOD_MS: f64 = 3_000.0;

/// Maximal number of marks in the text, of the newest: it is read from its beginning again whenever it changes.
const MARKS_MAX: usize = 8;

/// What the graph shows.
#[derive(Clone, Copy)]
pub(crate) struct Content<'a> {
    pub(crate) history: &'a History,
    pub(crate) subject: &'a Subject,
    /// The kept run.
    pub(crate) kept: Option<&'a Aligned>,
    /// The marks in view.
    pub(crate) marks: &'a [Mark],
}

/// The text that describes the graph.
pub(crate) struct Description {
    text: Text,
    updated_ms: f64,
}

impl Description {
    pub(crate) fn of(element: Element) -> Self {
        Self {
            text: Text::of(element),
            updated_ms: f64::NEG_INFINITY,
        }
    }

    /// Updates the text with the newest values in view, at most once a period. Returns when to call it again.
    pub(crate) fn update(
        &mut self,
        chart: Chart,
        view: View,
        Content {
            history,
            subject,
            kept,
            marks,
        }: Content<'_>,
        now_us: u64,
        frame_ms: f64,
    ) -> Next {
        let due_ms = self.updated_ms + UPDATE_PERIOD_MS - frame_ms;
        if due_ms > 0.0 {
            return Next::After(due_ms);
        }
        self.updated_ms = frame_ms;
        let at = Instant::from_micros(view.right_us(now_us));
        let when = if view.is_live() {
            tr!("Now").to_owned()
        } else {
            let day_us = chart.day_us(at.as_micros());
            let time = ticks::time_of_day(day_us / 1_000, 1_000);
            tr!("At {time}", time)
        };
        let model = chart.page.model.get_untracked();
        let said = match subject {
            Subject::Motor { id, mirror, traces } => {
                let values = |track| crosshair::values(track, *mirror, model, at);
                let values = history.track(*id).map(values);
                let when = marked(when, *mirror);
                let mut sentence = texts::sentence(&when, values.as_ref(), *traces);
                if let Some(kept) = kept {
                    let values = kept.values(model, at);
                    sentence.push(' ');
                    sentence += &texts::sentence(&kept.name(), values.as_ref(), *traces);
                }
                let marks = marks.iter().rev().take(MARKS_MAX).map(|mark| {
                    let day_us = chart.day_us(mark.at.as_micros());
                    (ticks::time_of_day(day_us / 1_000, 1_000), &*mark.words)
                });
                sentence += &texts::marks(marks);
                sentence
            }
            Subject::Compared(comparison) => {
                let motors = crosshair::compared(history, comparison, model, at);
                let named = motors
                    .into_iter()
                    .map(|(_, id, value)| (chart.motor_name(id), value));
                texts::compared_sentence(&when, comparison, &named.collect::<Vec<_>>())
            }
        };
        self.text.set(&said);
        Next::Woken
    }
}
