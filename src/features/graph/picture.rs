//! The picture: the graph in the size of a document's figure, with a legend above it: an image on the background of the
//! page, or a vector drawing.

use js_sys::Array;
use leptos::prelude::*;
use motorlink_i18n::tr;
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{Blob, CanvasRenderingContext2d, HtmlCanvasElement};

use crate::{
    features::graph::{
        axes::{Axes, Canvas, Picture, TEXT},
        kept::{
            drawing,
            state::{Aligned, aligned},
        },
        plot::{
            columns::Grid,
            comparison::Subject,
            layout::{Layout, in_rows},
            palette::{Colour, Palette},
            surface::{Align, AxesSurface, Opacity},
            svg::Svg,
            texts::{self, LocalTime},
            trace::Trace,
        },
        stage::{Stage, StageCell},
        state::Chart,
        traces::Tracing,
    },
    model::history::History,
    ui::download::save_blob,
};

/// Height of the legend, in CSS pixels.
const LEGEND: f64 = 30.0;
/// Length of a line in the legend, in CSS pixels.
const STROKE: f64 = 18.0;
/// Gap between two parts of the legend, in CSS pixels.
const GAP: f64 = 8.0;

/// Makes the browser save the graph as it is now, as a PNG image.
pub(crate) fn save(chart: Chart, cell: StageCell) {
    let now = local_now();
    let cell = cell.get_value();
    let mut stage = cell.borrow_mut();
    let picture = stage.as_mut().and_then(|stage| {
        stage.draw_first(chart);
        let on_screen = stage.layout;
        stage.draw_at(chart, on_screen.of_picture());
        let head = Head::of(chart, &stage.axes, stage.palette, stage.layout, now);
        let picture = paint(stage, &head);
        stage.draw_at(chart, on_screen);
        picture
    });
    let Some(picture) = picture else {
        return;
    };
    let named = Closure::once_into_js(move |blob: Option<Blob>| {
        if let Some(blob) = blob {
            save_blob(&blob, &texts::file_name(now, "png"));
        }
    });
    // It fails for pictures with content of another origin, which this one does not have.
    let _ = picture.to_blob(named.unchecked_ref());
}

/// Makes the browser save the graph as it is now, as an SVG drawing in the colours of the light theme.
pub(crate) fn save_svg(chart: Chart, cell: StageCell) {
    let now = local_now();
    let cell = cell.get_value();
    let mut stage = cell.borrow_mut();
    let Some(stage) = stage.as_mut() else {
        return;
    };
    stage.draw_first(chart);
    let parts = Array::of1(&vector(chart, stage, now).into());
    // It fails without memory only.
    if let Ok(file) = Blob::new_with_str_sequence(&parts) {
        save_blob(&file, &texts::file_name(now, "svg"));
    }
}

fn vector(chart: Chart, stage: &Stage, now: LocalTime) -> String {
    let (layout, palette) = (stage.layout.of_picture(), Palette::LIGHT);
    let head = Head::of(chart, &stage.axes, palette, layout, now);
    let now_us = chart.now_us();
    let view = chart.view.get_untracked();
    let grid = Grid::new(view.span_us, view.right_us(now_us), layout.columns());
    // The lines decide the scales, and lie over the axes.
    let mut scales = stage.scales;
    let new = || Svg::new(layout.ratio, TEXT * layout.ratio);
    let mut lines = new();
    chart.page.history.with_value(|history| {
        let mut tracing = Tracing {
            surface: &mut lines,
            scales: &mut scales,
            fitting: chart.fitting.get_untracked(),
            layout,
            palette,
            kept: kept_run(chart, history, grid),
        };
        tracing.draw(history, &chart.subject(history), grid, now_us);
    });
    let mut svg = new();
    let (width, height) = (f64::from(layout.width), f64::from(layout.height));
    let size = (width, height + head.height);
    svg.fill([0.0, 0.0, size.0, size.1], palette.surface, Opacity::Full);
    head.draw(&mut svg);
    svg.moved_down(head.height, |svg| {
        let marks = chart
            .page
            .history
            .with_value(|history| chart.marks(history, &chart.subject(history), grid));
        Picture::of(chart, view, (grid, &marks), layout, palette, scales).draw(svg);
        svg.append(&lines);
    });
    svg.file(size, &head.title, stage.axes.family())
}

/// A line of the legend.
struct Entry {
    /// Of its line.
    colour: Colour,
    /// Of its name.
    words: Colour,
    dashed: bool,
    name: String,
}

/// The legend, with the title at the end of its first row.
struct Head {
    title: String,
    /// Each with the left end and the middle of its line.
    entries: Vec<(Entry, f64, f64)>,
    /// Of all rows, in device pixels.
    height: f64,
    layout: Layout,
    palette: Palette,
}

impl Head {
    fn of(chart: Chart, axes: &Axes, palette: Palette, layout: Layout, now: LocalTime) -> Self {
        let history = chart.page.history;
        let view = chart.view.get_untracked();
        let (subject, kept) = history.with_value(|history| {
            let grid = Grid::new(
                view.span_us,
                view.right_us(chart.now_us()),
                layout.columns(),
            );
            (chart.subject(history), kept_run(chart, history, grid))
        });
        let (title, mut entries) = legend(chart, &subject, palette);
        entries.extend(kept.map(|kept| Entry {
            colour: drawing::pale(palette.text, palette.surface),
            // As pale as its line, it could hardly be read.
            words: palette.text,
            dashed: false,
            name: kept.name(),
        }));
        let title = format!("{title}, {}", texts::date_and_time(now));
        let pixel = layout.ratio;
        let length = |text: &str| axes.width_of(text, pixel);
        let lengths: Vec<f64> = entries
            .iter()
            .map(|entry| length(&entry.name) + (STROKE + 3.0 * GAP) * pixel)
            .collect();
        let places = in_rows(&lengths, f64::from(layout.plot.width), length(&title));
        let rows = places.last().map_or(1.0, |(row, _)| row + 1.0);
        let left = f64::from(layout.plot.left);
        let place = |(entry, (row, x))| (entry, left + x, (row + 0.5) * LEGEND * pixel);
        Self {
            title,
            entries: entries.into_iter().zip(places).map(place).collect(),
            height: (LEGEND * pixel * rows).round(),
            layout,
            palette,
        }
    }

    fn draw(&self, surface: &mut dyn AxesSurface) {
        let pixel = self.layout.ratio;
        let text = self.palette.text;
        for (entry, x, y) in &self.entries {
            let thickness = (2.0 * pixel).round();
            let dashes: &[[f64; 2]] = if entry.dashed {
                &[[0.0, 0.2], [0.4, 0.2], [0.8, 0.2]]
            } else {
                &[[0.0, 1.0]]
            };
            for [from, length] in dashes.iter().map(|dash| dash.map(|it| it * STROKE * pixel)) {
                let dash = [x + from, y - thickness / 2.0, length, thickness];
                surface.fill(dash, entry.colour, Opacity::Full);
            }
            let behind = (x + (STROKE + GAP) * pixel, *y);
            surface.write(&entry.name, behind, Align::Left, entry.words);
        }
        let right = f64::from(self.layout.plot.left + self.layout.plot.width);
        let end = (right, LEGEND * pixel / 2.0);
        surface.write(&self.title, end, Align::Right, text);
    }
}

fn kept_run(chart: Chart, history: &History, grid: Grid) -> Option<Aligned> {
    aligned(
        history,
        chart.page.selected.get_untracked(),
        grid.right_us(),
    )
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
                colour: palette.of(trace),
                words: palette.of(trace),
                dashed: trace == Trace::Goal,
                name: with_unit(trace),
            };
            (
                tr!("Motor {id}", id = chart.motor_name(*id)),
                on.map(entry).collect(),
            )
        }
        Subject::Compared(comparison) => {
            let entry = |(place, id, _)| {
                let colour = palette.motors.get(place).copied().unwrap_or(palette.text);
                Entry {
                    colour,
                    words: colour,
                    dashed: false,
                    name: chart.motor_name(id),
                }
            };
            let more = comparison.more().map(|more| format!(" {more}"));
            let title = with_unit(comparison.trace) + &more.unwrap_or_default();
            (title, comparison.motors().map(entry).collect())
        }
    }
}

/// `None` if the browser has no memory for it.
fn paint(stage: &Stage, head: &Head) -> Option<HtmlCanvasElement> {
    let layout = stage.layout;
    let canvas: HtmlCanvasElement = document().create_element("canvas").ok()?.dyn_into().ok()?;
    let context: CanvasRenderingContext2d = canvas.get_context("2d").ok()??.dyn_into().ok()?;
    canvas.set_width(layout.width);
    canvas.set_height(layout.height + whole(head.height));
    // A canvas loses its settings when its size is set.
    context.set_font(&stage.axes.font(layout.ratio));
    context.set_text_baseline("middle");
    let (width, height) = (f64::from(layout.width), f64::from(canvas.height()));
    let mut surface = Canvas(&context);
    surface.fill(
        [0.0, 0.0, width, height],
        stage.palette.surface,
        Opacity::Full,
    );
    for layer in [&stage.axes.canvas, &stage.lines.canvas] {
        context
            .draw_image_with_html_canvas_element(layer, 0.0, head.height)
            .ok()?;
    }
    head.draw(&mut surface);
    Some(canvas)
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
