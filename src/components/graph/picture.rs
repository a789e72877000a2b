//! The picture: what the graph shows, with a legend above it, on the background of the page.

use leptos::prelude::*;
use motorlink_messages::protocol::MotorId;
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{Blob, CanvasRenderingContext2d, HtmlCanvasElement};

use super::{stage::Stage, state::Chart};
use crate::{
    download::save_blob,
    graph::{
        ink::{Inks, css},
        trace::{Trace, Traces},
        words::{self, LocalTime},
    },
};

/// Height of the legend, in pixels of the style sheet.
const LEGEND: f64 = 30.0;
/// Length of a line in it.
const STROKE: f64 = 18.0;
/// Between two of its parts.
const AIR: f64 = 8.0;

/// Has the browser save the graph as it is now.
pub(super) fn save(chart: Chart) {
    let now = local_now();
    let id = chart.desk.selected.get_untracked();
    let traces = chart.traces.get_untracked();
    let stage = chart.stage.borrow();
    let picture = stage
        .as_ref()
        .and_then(|stage| paint(stage, id, traces, now));
    let Some(picture) = picture else {
        return;
    };
    let named = Closure::once_into_js(move |blob: Option<Blob>| {
        if let Some(blob) = blob {
            save_blob(&blob, &words::file_name(now));
        }
    });
    // It fails for pictures with parts from elsewhere, and this one has none.
    let _ = picture.to_blob(named.unchecked_ref());
}

/// `None` where the browser has no memory left for it.
fn paint(stage: &Stage, id: MotorId, traces: Traces, now: LocalTime) -> Option<HtmlCanvasElement> {
    let layout = stage.layout;
    let head = (LEGEND * layout.ratio).round();
    let (width, height) = (f64::from(layout.width), f64::from(layout.height) + head);
    let canvas: HtmlCanvasElement = document().create_element("canvas").ok()?.dyn_into().ok()?;
    canvas.set_width(layout.width);
    canvas.set_height(layout.height + whole(head));
    let context: CanvasRenderingContext2d = canvas.get_context("2d").ok()??.dyn_into().ok()?;
    context.set_fill_style_str(&css(stage.inks.surface));
    context.fill_rect(0.0, 0.0, width, height);
    for layer in [&stage.axes.canvas, &stage.lines.canvas] {
        context
            .draw_image_with_html_canvas_element(layer, 0.0, head)
            .ok()?;
    }
    let pixel = layout.ratio;
    context.set_font(&stage.axes.font(pixel));
    context.set_text_baseline("middle");
    legend(
        &context,
        stage.inks,
        traces,
        pixel,
        f64::from(layout.plot.left),
        head / 2.0,
    );
    context.set_fill_style_str(&css(stage.inks.text));
    context.set_text_align("right");
    let when = words::date_and_time(now);
    let right = f64::from(layout.plot.left + layout.plot.width);
    // It fails for places that are none.
    let _ = context.fill_text(&format!("Motor {id}, {when}"), right, head / 2.0);
    Some(canvas)
}

/// A line and a name for every trace that is on, from left to right.
fn legend(
    context: &CanvasRenderingContext2d,
    inks: Inks,
    traces: Traces,
    pixel: f64,
    left: f64,
    y: f64,
) {
    let mut x = left;
    for trace in Trace::ALL.into_iter().filter(|trace| traces.has(*trace)) {
        let ink = match trace {
            Trace::Speed => inks.speed,
            Trace::Current => inks.current,
            Trace::Goal => inks.text,
            Trace::Temperature => inks.temperature,
            Trace::Position => inks.position,
        };
        context.set_fill_style_str(&css(ink));
        let thickness = (2.0 * pixel).round();
        if trace == Trace::Goal {
            for dash in [0.0, 0.4, 0.8] {
                let (from, length) = (x + dash * STROKE * pixel, 0.2 * STROKE * pixel);
                context.fill_rect(from, y - thickness / 2.0, length, thickness);
            }
        } else {
            context.fill_rect(x, y - thickness / 2.0, STROKE * pixel, thickness);
        }
        x += (STROKE + AIR) * pixel;
        let name = match trace.unit() {
            "" => trace.name().to_owned(),
            unit => format!("{} ({unit})", trace.name()),
        };
        let _ = context.fill_text(&name, x, y);
        let length = context.measure_text(&name).map_or(0.0, |text| text.width());
        x += length + 2.0 * AIR * pixel;
    }
}

/// The time on the wall here.
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
