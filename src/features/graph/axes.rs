//! The axes and their grid lines, on a canvas under the traces. They change seldom, so they have a canvas of their
//! own.

use motorlink_messages::protocol::family::Model;
use plotters::{
    coord::Shift,
    drawing::{DrawingArea, IntoDrawingArea},
    element::Rectangle,
    style::{Color, RGBAColor, RGBColor},
};
use plotters_canvas::CanvasBackend;
use wasm_bindgen::JsCast;
use web_sys::{CanvasRenderingContext2d, HtmlCanvasElement};

use crate::features::graph::plot::{
    layout::Layout,
    palette::{Colour, Palette, css},
    scale::{self, Scale},
    ticks::Tick,
    trace::{Trace, Traces},
};

/// Font size of the labels, in CSS pixels.
const TEXT: f64 = 11.0;
/// Gap between a line and its label, in CSS pixels.
const LABEL_OFFSET: f64 = 6.0;
/// Distance from a label to the unit below it, in CSS pixels.
const UNIT_OFFSET: f64 = 13.0;
/// Width that `100 °C` needs beside the labels of the angle, in CSS pixels.
const ANGLE_LABELS_WIDTH: f64 = 46.0;

/// The canvas with the axes.
pub(crate) struct Axes {
    pub(crate) canvas: HtmlCanvasElement,
    context: CanvasRenderingContext2d,
    /// `None` before the canvas has a size.
    area: Option<DrawingArea<CanvasBackend, Shift>>,
    font: String,
    drawn: Option<Picture>,
}

/// Everything that the axes depend on. They are drawn again only if it differs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Picture {
    pub(crate) layout: Layout,
    pub(crate) palette: Palette,
    pub(crate) traces: Traces,
    pub(crate) scales: [Scale; 2],
    pub(crate) temperature_end: u16,
    pub(crate) marks: Vec<Tick>,
    pub(crate) model: Model,
}

/// Sets the size of a canvas so that one canvas pixel is one device pixel.
pub(crate) fn resize(canvas: &HtmlCanvasElement, layout: Layout) {
    canvas.set_width(layout.width);
    canvas.set_height(layout.height);
    let size = |pixels: u32| format!("{}px", f64::from(pixels) / layout.ratio);
    let style = canvas.style();
    // It fails for invalid names and values; these are valid.
    let _ = style.set_property("width", &size(layout.width));
    let _ = style.set_property("height", &size(layout.height));
}

impl Axes {
    /// `None` if the browser has no 2D context for the canvas.
    pub(crate) fn of(canvas: HtmlCanvasElement) -> Option<Self> {
        let context = canvas.get_context("2d").ok()??.dyn_into().ok()?;
        Some(Self {
            canvas,
            context,
            area: None,
            font: String::new(),
            drawn: None,
        })
    }

    pub(crate) fn set_font(&mut self, family: &str) {
        family.clone_into(&mut self.font);
        self.drawn = None;
    }

    /// The font of the labels; `ratio` is the number of device pixels per CSS pixel.
    pub(crate) fn font(&self, ratio: f64) -> String {
        format!("{}px {}", TEXT * ratio, self.font)
    }

    pub(crate) fn resize(&mut self, layout: Layout) {
        resize(&self.canvas, layout);
        let backend = CanvasBackend::with_canvas_object(self.canvas.clone());
        self.area = backend.map(IntoDrawingArea::into_drawing_area);
        self.drawn = None;
    }

    pub(crate) fn draw(&mut self, picture: Picture) {
        let layout = picture.layout;
        if self.drawn.as_ref() != Some(&picture) {
            self.context
                .clear_rect(0.0, 0.0, layout.width.into(), layout.height.into());
            self.context.set_font(&self.font(layout.ratio));
            self.context.set_text_baseline("middle");
            self.mesh(&picture);
            self.labels(&picture);
            self.drawn = Some(picture);
        }
    }

    /// Draws the grid lines: one device pixel wide and aligned to pixels.
    fn mesh(&self, picture: &Picture) {
        let Some(area) = &self.area else {
            return;
        };
        let (plot, palette) = (picture.layout.plot, picture.palette);
        let line = |from: (i32, i32), size: (i32, i32), style: RGBAColor| {
            let to = (from.0 + size.0, from.1 + size.1);
            // Drawing a line on a canvas cannot fail.
            let _ = area.draw(&Rectangle::new([from, to], style.filled()));
        };
        let thin = rgb(palette.line).to_rgba();
        let width = pixels(picture.layout.ratio).max(1);
        for mark in &picture.marks {
            let x = plot.left + at(mark.place, plot.width);
            line((x, plot.top), (width, plot.height), thin);
        }
        let from_zero = picture.traces.compared.is_some_and(Trace::is_from_zero);
        for row in 0..5 {
            // The zero line is stronger.
            let style = if row == 2 && !from_zero {
                rgb(palette.text).mix(0.45)
            } else {
                thin
            };
            let y = plot.top + plot.height * row / 4;
            line((plot.left, y), (plot.width, width), style);
        }
    }

    fn labels(&self, picture: &Picture) {
        let Picture {
            layout,
            palette,
            traces,
            ..
        } = *picture;
        // The compared trace has the only axis.
        let shows = |trace| traces.compared.is_none() && traces.has(trace);
        let [speed, current] = picture.scales;
        let plot = layout.plot;
        let (left, right) = (f64::from(plot.left), f64::from(plot.left + plot.width));
        let (top, height) = (f64::from(plot.top), f64::from(plot.height));
        let offset = LABEL_OFFSET * layout.ratio;
        let rows = |row: usize| top + height * [0.0, 0.25, 0.5, 0.75, 1.0].get(row).unwrap_or(&0.0);
        let below = UNIT_OFFSET * layout.ratio;
        for (trace, scale, x, align, colour) in [
            (Trace::Speed, speed, left - offset, "right", palette.speed),
            (
                Trace::Current,
                current,
                right + offset,
                "left",
                palette.current,
            ),
        ] {
            if shows(trace) {
                self.write_in(colour, align);
                for (row, label) in scale.labels().iter().enumerate() {
                    if row % 2 == 0 || layout.has_quarters() {
                        self.write(label, x, rows(row));
                    }
                }
                self.write(trace.unit(picture.model), x, top + below);
            }
        }
        if let Some(trace) = traces.compared {
            self.write_in(palette.text, "right");
            for (row, label) in compared_labels(trace, picture).iter().enumerate() {
                if row % 2 == 0 || layout.has_quarters() {
                    self.write(label, left - offset, rows(row));
                }
            }
            self.write(trace.unit(picture.model), left - offset, top + below);
        }
        let mut x = right - offset;
        for (trace, colour, end) in [
            (
                Trace::Temperature,
                palette.temperature,
                picture.temperature_end,
            ),
            (Trace::Position, palette.position, 360),
        ] {
            if shows(trace) {
                self.write_in(colour, "right");
                let space = if trace == Trace::Temperature { " " } else { "" };
                let upper = format!("{end}{space}{}", trace.unit(picture.model));
                self.write(&upper, x, top + below * 0.75);
                self.write(&(end / 2).to_string(), x, rows(2) - below * 0.75);
                self.write("0", x, rows(4) - below * 0.75);
                x -= ANGLE_LABELS_WIDTH * layout.ratio;
            }
        }
        self.write_in(palette.text, "center");
        for mark in &picture.marks {
            let x = left + mark.place * f64::from(plot.width);
            self.write(&mark.label, x, rows(4) + below);
        }
    }

    fn write_in(&self, colour: Colour, align: &str) {
        self.context.set_fill_style_str(&css(colour));
        self.context.set_text_align(align);
    }

    fn write(&self, text: &str, x: f64, y: f64) {
        // It fails for invalid coordinates only.
        let _ = self.context.fill_text(text, x, y);
    }
}

/// The labels of the five lines of the only axis, from the top.
fn compared_labels(trace: Trace, picture: &Picture) -> [String; 5] {
    let [speed, current] = picture.scales;
    match trace {
        Trace::Speed | Trace::Goal => speed.labels(),
        Trace::Current => current.labels(),
        Trace::Temperature => scale::labels_from_zero(picture.temperature_end),
        Trace::Position => scale::labels_from_zero(360),
    }
}

fn rgb((red, green, blue): Colour) -> RGBColor {
    RGBColor(red, green, blue)
}

/// The pixel at a position from 0 to 1; 1 is the last pixel.
fn at(place: f64, length: i32) -> i32 {
    pixels(place * f64::from(length)).min(length - 1)
}

#[allow(clippy::cast_possible_truncation, reason = "no more than a canvas has")]
fn pixels(length: f64) -> i32 {
    length.round() as i32
}
