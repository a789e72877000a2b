//! The picture: the graph in the size of a document's figure, with a legend above it, on the background of the page.

use leptos::prelude::*;
use motorlink_i18n::tr;
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{Blob, CanvasRenderingContext2d, HtmlCanvasElement};

use crate::{
    features::graph::{
        plot::{
            comparison::Subject,
            layout::in_rows,
            palette::{Colour, Palette, css},
            texts::{self, LocalTime},
            trace::Trace,
        },
        stage::{Stage, StageCell},
        state::Chart,
    },
    ui::download::save_blob,
};

/// Height of the legend, in CSS pixels.
const LEGEND: f64 = 30.0;
/// Length of a line in the legend, in CSS pixels.
const STROKE: f64 = 18.0;
/// Gap between two parts of the legend, in CSS pixels.
const GAP: f64 = 8.0;

/// Makes the browser save the graph as it is now.
pub(crate) fn save(chart: Chart, cell: StageCell) {
    let now = local_now();
    let subject = chart
        .page
        .history
        .with_value(|history| chart.subject(history));
    let cell = cell.get_value();
    let mut stage = cell.borrow_mut();
    let picture = stage.as_mut().and_then(|stage| {
        stage.draw_first(chart);
        let on_screen = stage.layout;
        stage.draw_at(chart, on_screen.of_picture());
        let (title, entries) = legend(chart, &subject, stage.palette);
        let picture = paint(stage, &title, &entries, now);
        stage.draw_at(chart, on_screen);
        picture
    });
    let Some(picture) = picture else {
        return;
    };
    let named = Closure::once_into_js(move |blob: Option<Blob>| {
        if let Some(blob) = blob {
            save_blob(&blob, &texts::file_name(now));
        }
    });
    // It fails for pictures with content of another origin, which this one does not have.
    let _ = picture.to_blob(named.unchecked_ref());
}

/// A line of the legend.
struct Entry {
    colour: Colour,
    dashed: bool,
    name: String,
}

/// The title of the picture, and the entries of its legend.
fn legend(chart: Chart, subject: &Subject, palette: Palette) -> (String, Vec<Entry>) {
    let model = chart.page.model.get_untracked();
    let with_unit = |trace: Trace| match trace.unit(model) {
        "" => trace.name().to_owned(),
        unit => format!("{} ({unit})", trace.name()),
    };
    match subject {
        Subject::Motor { id, traces, .. } => {
            let on = Trace::ALL.into_iter().filter(|trace| traces.has(*trace));
            let entry = |trace| Entry {
                colour: match trace {
                    Trace::Speed => palette.speed,
                    Trace::Current => palette.current,
                    Trace::Goal => palette.text,
                    Trace::Temperature => palette.temperature,
                    Trace::Position => palette.position,
                },
                dashed: trace == Trace::Goal,
                name: with_unit(trace),
            };
            (
                tr!("Motor {id}", id = chart.motor_name(*id)),
                on.map(entry).collect(),
            )
        }
        Subject::Compared(comparison) => {
            let entry = |(place, id, _)| Entry {
                colour: palette.motors.get(place).copied().unwrap_or(palette.text),
                dashed: false,
                name: chart.motor_name(id),
            };
            let more = comparison.more().map(|more| format!(" {more}"));
            let title = with_unit(comparison.trace) + &more.unwrap_or_default();
            (title, comparison.motors().map(entry).collect())
        }
    }
}

/// `None` if the browser has no memory for it.
fn paint(
    stage: &Stage,
    title: &str,
    entries: &[Entry],
    now: LocalTime,
) -> Option<HtmlCanvasElement> {
    let layout = stage.layout;
    let pixel = layout.ratio;
    let canvas: HtmlCanvasElement = document().create_element("canvas").ok()?.dyn_into().ok()?;
    let context: CanvasRenderingContext2d = canvas.get_context("2d").ok()??.dyn_into().ok()?;
    let font = stage.axes.font(pixel);
    context.set_font(&font);
    let length = |text: &str| context.measure_text(text).map_or(0.0, |text| text.width());
    let title = format!("{title}, {}", texts::date_and_time(now));
    let (left, right) = (
        f64::from(layout.plot.left),
        f64::from(layout.plot.left + layout.plot.width),
    );
    let lengths: Vec<f64> = entries
        .iter()
        .map(|entry| length(&entry.name) + (STROKE + 3.0 * GAP) * pixel)
        .collect();
    // The title is at the end of the first row.
    let places = in_rows(&lengths, right - left, length(&title));
    let rows = places.last().map_or(1.0, |(row, _)| row + 1.0);
    let head = (LEGEND * pixel * rows).round();
    let (width, height) = (f64::from(layout.width), f64::from(layout.height) + head);
    canvas.set_width(layout.width);
    canvas.set_height(layout.height + whole(head));
    context.set_fill_style_str(&css(stage.palette.surface));
    context.fill_rect(0.0, 0.0, width, height);
    for layer in [&stage.axes.canvas, &stage.lines.canvas] {
        context
            .draw_image_with_html_canvas_element(layer, 0.0, head)
            .ok()?;
    }
    // A canvas loses its settings when its size is set.
    context.set_font(&font);
    context.set_text_baseline("middle");
    for (entry, (row, x)) in entries.iter().zip(places) {
        write(
            &context,
            entry,
            pixel,
            left + x,
            (row + 0.5) * LEGEND * pixel,
        );
    }
    context.set_fill_style_str(&css(stage.palette.text));
    context.set_text_align("right");
    // It fails for places that are none.
    let _ = context.fill_text(&title, right, LEGEND * pixel / 2.0);
    Some(canvas)
}

/// Draws a line and a name.
fn write(context: &CanvasRenderingContext2d, entry: &Entry, pixel: f64, x: f64, y: f64) {
    context.set_fill_style_str(&css(entry.colour));
    let thickness = (2.0 * pixel).round();
    if entry.dashed {
        for dash in [0.0, 0.4, 0.8] {
            let (from, length) = (x + dash * STROKE * pixel, 0.2 * STROKE * pixel);
            context.fill_rect(from, y - thickness / 2.0, length, thickness);
        }
    } else {
        context.fill_rect(x, y - thickness / 2.0, STROKE * pixel, thickness);
    }
    // It fails for places that are none.
    let _ = context.fill_text(&entry.name, x + (STROKE + GAP) * pixel, y);
}

/// The local date and time.
fn local_now() -> LocalTime {
    let now = js_sys::Date::new_0();
    [
        now.get_full_year(),
        now.get_month() + 1,
        now.get_date(),
        now.get_hours(),
        now.get_minutes(),
        now.get_seconds(),
    ]
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a few lines of text"
)]
fn whole(pixels: f64) -> u32 {
    pixels as u32
}
