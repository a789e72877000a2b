//! The axes and their grid lines, on a canvas under the traces. They change seldom, so they have a canvas of their
//! own.

use leptos::prelude::GetUntracked;
use motorlink_messages::protocol::family::Model;
use wasm_bindgen::JsCast;
use web_sys::{CanvasRenderingContext2d, HtmlCanvasElement};

use crate::{
    features::graph::{
        plot::{
            columns::Grid,
            layout::{Layout, Rectangle},
            marks::{Kind, Mark},
            palette::{Colour, Palette, css},
            scale::{self, Scales},
            surface::{Align, AxesSurface, Opacity},
            ticks::{self, Tick},
            trace::{Trace, Traces},
            view::View,
        },
        state::Chart,
    },
    ui::mathematics::limited,
};

/// Font size of the labels, in CSS pixels.
pub(crate) const TEXT: f64 = 11.0;
/// Gap between a line and its label, in CSS pixels.
const LABEL_OFFSET: f64 = 6.0;
/// Distance from the plot to the middle of the labels of the time axis, in CSS pixels.
const TIME_OFFSET: f64 = 13.0;

/// The canvas with the axes.
pub(crate) struct Axes {
    pub(crate) canvas: HtmlCanvasElement,
    context: CanvasRenderingContext2d,
    font: String,
    drawn: Option<Picture>,
}

/// Everything that the axes depend on. They are drawn again only if it differs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Picture {
    pub(crate) layout: Layout,
    pub(crate) palette: Palette,
    pub(crate) traces: Traces,
    pub(crate) scales: Scales,
    pub(crate) marks: Vec<Tick>,
    /// The commands and events: the place of each, from the left edge, 0, to the right edge, 1.
    pub(crate) events: Vec<(f64, Kind)>,
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

    /// Its family.
    pub(crate) fn family(&self) -> &str {
        &self.font
    }

    /// The width of a text in this font, in device pixels.
    pub(crate) fn width_of(&self, text: &str, ratio: f64) -> f64 {
        self.context.set_font(&self.font(ratio));
        let measured = self.context.measure_text(text);
        measured.map_or(0.0, |measured| measured.width())
    }

    pub(crate) fn resize(&mut self, layout: Layout) {
        resize(&self.canvas, layout);
        self.drawn = None;
    }

    pub(crate) fn draw(&mut self, picture: Picture) {
        let layout = picture.layout;
        if self.drawn.as_ref() != Some(&picture) {
            self.context
                .clear_rect(0.0, 0.0, layout.width.into(), layout.height.into());
            self.context.set_font(&self.font(layout.ratio));
            self.context.set_text_baseline("middle");
            picture.draw(&mut Canvas(&self.context));
            self.drawn = Some(picture);
        }
    }
}

/// A canvas whose font and baseline are set.
pub(crate) struct Canvas<'a>(pub(crate) &'a CanvasRenderingContext2d);

impl AxesSurface for Canvas<'_> {
    fn fill(&mut self, [left, top, width, height]: [f64; 4], colour: Colour, opacity: Opacity) {
        let (red, green, blue) = colour;
        self.0.set_fill_style_str(&match opacity {
            Opacity::Full => css(colour),
            Opacity::Weak => format!("rgba({red},{green},{blue},0.45)"),
        });
        self.0.fill_rect(left, top, width, height);
    }

    fn write(&mut self, text: &str, (x, y): (f64, f64), align: Align, colour: Colour) {
        self.0.set_fill_style_str(&css(colour));
        self.0.set_text_align(match align {
            Align::Left => "left",
            Align::Center => "center",
            Align::Right => "right",
        });
        // It fails for invalid coordinates only.
        let _ = self.0.fill_text(text, x, y);
    }
}

impl Picture {
    /// The axes of this view.
    pub(crate) fn of(
        chart: Chart,
        view: View,
        (grid, events): (Grid, &[Mark]),
        layout: Layout,
        palette: Palette,
        scales: Scales,
    ) -> Self {
        let width = f64::from(layout.columns().max(1));
        let place = |mark: &Mark| (grid.place(mark.at.as_micros()) / width, mark.kind);
        let marks = layout.marks(view.is_live());
        let marks = if view.is_live() {
            ticks::ago(view.span_us, marks)
        } else {
            let right_us = chart.day_us(grid.right_us());
            ticks::of_day(right_us, grid.span_us(), marks)
        };
        Self {
            layout,
            palette,
            traces: chart.traces.get_untracked(),
            scales,
            marks,
            events: events.iter().map(place).collect(),
            model: chart.page.model.get_untracked(),
        }
    }

    /// Draws grid lines and labels.
    pub(crate) fn draw(&self, surface: &mut dyn AxesSurface) {
        self.mesh(surface);
        self.labels(surface);
    }

    /// Draws the grid lines: one device pixel wide and aligned to pixels.
    fn mesh(&self, surface: &mut dyn AxesSurface) {
        let (plot, palette) = (self.layout.plot, self.palette);
        let mut line = |rectangle: [i32; 4], colour, opacity| {
            surface.fill(rectangle.map(f64::from), colour, opacity);
        };
        let width = pixels(self.layout.ratio).max(1);
        for mark in &self.marks {
            let x = plot.left + at(mark.place, plot.width);
            let rectangle = [x, plot.top, width, plot.height];
            line(rectangle, palette.line, Opacity::Full);
        }
        for (place, _) in &self.events {
            let x = plot.left + at(*place, plot.width);
            line(
                [x, plot.top, width, plot.height],
                palette.text,
                Opacity::Weak,
            );
        }
        for (_, pane, ticks) in self.panes() {
            for edge in [0, pane.height - 1] {
                line(
                    [pane.left, pane.top + edge, pane.width, width],
                    palette.line,
                    Opacity::Full,
                );
            }
            for tick in ticks {
                let y = pane.top + at(tick.place, pane.height);
                let rectangle = [pane.left, y, pane.width, width];
                // The zero line is stronger.
                if tick.is_zero {
                    line(rectangle, palette.text, Opacity::Weak);
                } else {
                    line(rectangle, palette.line, Opacity::Full);
                }
            }
        }
    }

    /// Each pane with its trace and the ticks of its value axis.
    fn panes(&self) -> impl Iterator<Item = (Trace, Rectangle, Vec<scale::Tick>)> {
        let (traces, layout) = (self.traces.panes(), self.layout);
        let panes = layout.panes(traces.len());
        traces.into_iter().zip(panes).map(move |(trace, pane)| {
            let unit = trace.unit(self.model);
            let ticks = self
                .scales
                .of(trace)
                .ticks(trace, unit, layout.half_rows(pane));
            (trace, pane, ticks)
        })
    }

    fn labels(&self, surface: &mut dyn AxesSurface) {
        let Self {
            layout, palette, ..
        } = *self;
        let plot = layout.plot;
        let left = f64::from(plot.left);
        let x = left - LABEL_OFFSET * layout.ratio;
        // The labels of two panes do not touch.
        let half = TEXT / 2.0 * layout.ratio;
        for (trace, pane, ticks) in self.panes() {
            let colour = match self.traces.compared {
                Some(_) => palette.text,
                None => palette.of(trace),
            };
            let (top, height) = (f64::from(pane.top), f64::from(pane.height));
            for tick in ticks {
                let y = top + limited(tick.place * height, half, height - half);
                surface.write(&tick.label, (x, y), Align::Right, colour);
            }
        }
        // Above the plot they cover no curve.
        for (place, kind) in &self.events {
            let at = (
                left + place * f64::from(plot.width),
                f64::from(plot.top) / 2.0,
            );
            let colour = if *kind == Kind::Event {
                palette.temperature
            } else {
                palette.text
            };
            surface.write(kind.sign(), at, Align::Center, colour);
        }
        let below = f64::from(plot.top + plot.height) + TIME_OFFSET * layout.ratio;
        for mark in &self.marks {
            let x = left + mark.place * f64::from(plot.width);
            surface.write(&mark.label, (x, below), Align::Center, palette.text);
        }
    }
}

/// The pixel at a position from 0 to 1; 1 is the last pixel.
fn at(place: f64, length: i32) -> i32 {
    pixels(place * f64::from(length)).min(length - 1)
}

#[allow(clippy::cast_possible_truncation, reason = "no more than a canvas has")]
fn pixels(length: f64) -> i32 {
    length.round() as i32
}
