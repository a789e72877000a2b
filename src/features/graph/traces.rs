//! Draws the lines with plotters on their own canvas, over the axes.

use plotters::{
    coord::{CoordTranslate, Shift, types::RangedCoordf64},
    drawing::{DrawingArea, IntoDrawingArea},
    element::PathElement,
    prelude::Cartesian2d,
    style::{Color, RGBColor, ShapeStyle},
};
use plotters_canvas::CanvasBackend;
use wasm_bindgen::JsCast;
use web_sys::{CanvasRenderingContext2d, HtmlCanvasElement};

use crate::{
    features::graph::plot::{
        columns::{Dot, Grid, extent},
        layout::{Layout, Rectangle},
        lines::{goal_lines, trace_lines},
        palette::{Colour, Palette, css},
        scale::{self, Scale},
        strokes::{Pixel, Strokes, strokes},
        trace::{Trace, Traces},
    },
    model::{
        history::{History, Track},
        mirror::Mirror,
    },
};

/// Subpixels per device pixel. plotters draws at whole pixels, which turns a gentle slope into steps. So it gets
/// coordinates eight times as large, and the canvas scales them down.
pub(crate) const FINE: i32 = 8;

/// Line width of a motor's reports, in CSS pixels.
pub(crate) const BOLD: f64 = 1.75;
/// Line width of the other lines.
const THIN: f64 = 1.25;
/// The dashes of the goal and their gaps, in CSS pixels.
const DASH: [f64; 2] = [5.0, 4.0];
/// How far lines may exceed the edge of the plot, so that a line at the end of its scale is not cut in half
/// lengthwise.
const BLEED: f64 = 2.0;

/// The canvas with the lines.
pub(crate) struct TraceCanvas {
    pub(crate) canvas: HtmlCanvasElement,
    pub(crate) context: CanvasRenderingContext2d,
    /// `None` before the canvas has a size.
    area: Option<DrawingArea<CanvasBackend, Shift>>,
    pub(crate) layout: Layout,
    speed: Scale,
    current: Scale,
    /// The upper end of the temperature's scale, in degrees.
    temperature_end: u16,
}

/// The style of a line.
pub(crate) struct Pen {
    pub(crate) colour: Colour,
    /// In CSS pixels.
    pub(crate) width: f64,
}

/// Converts columns and values to subpixels.
pub(crate) type Coordinates = Cartesian2d<RangedCoordf64, RangedCoordf64>;

/// The values at the lower and the upper end of the plot.
pub(crate) type Ends = (f64, f64);

impl TraceCanvas {
    /// `None` if the browser has no 2D context for the canvas.
    pub(crate) fn of(canvas: HtmlCanvasElement) -> Option<Self> {
        let context = canvas.get_context("2d").ok()??.dyn_into().ok()?;
        Some(Self {
            canvas,
            context,
            area: None,
            layout: Layout::default(),
            speed: Scale::of_speed(),
            current: Scale::of_current(),
            temperature_end: 100,
        })
    }

    /// The scales of speed and current in the last drawing.
    pub(crate) fn scales(&self) -> [Scale; 2] {
        [self.speed, self.current]
    }

    /// The upper end of the scale of the temperature, in degrees.
    pub(crate) fn temperature_end(&self) -> u16 {
        self.temperature_end
    }

    pub(crate) fn resize(&mut self, layout: Layout) {
        self.layout = layout;
        super::axes::resize(&self.canvas, layout);
        let fine = f64::from(FINE);
        // A canvas loses its settings when its size is set.
        let Rectangle {
            left, top, height, ..
        } = layout.plot;
        let bleed = (BLEED * layout.ratio).ceil();
        self.context.begin_path();
        self.context.rect(
            f64::from(left),
            f64::from(top) - bleed,
            // Up to the edge of the canvas: the names of the lines are after their ends.
            f64::from(layout.width) - f64::from(left),
            f64::from(height) + 2.0 * bleed,
        );
        self.context.clip();
        // It fails for invalid numbers only.
        let _ = self.context.scale(1.0 / fine, 1.0 / fine);
        // A mitre join would extend far beyond the end of a spike.
        self.context.set_line_join("bevel");
        self.area = CanvasBackend::with_canvas_object(self.canvas.clone()).map(|backend| {
            let whole = |pixels: u32| i32::try_from(pixels).unwrap_or(0) * FINE;
            let size = (whole(layout.width), whole(layout.height));
            // A drawing area clips points to the canvas; this one has the size in subpixels.
            backend.into_drawing_area().shrink((0, 0), size)
        });
    }

    /// Clears all lines.
    pub(crate) fn clear(&self) {
        let (width, height) = (self.layout.width, self.layout.height);
        let fine = f64::from(FINE);
        self.context
            .clear_rect(0.0, 0.0, f64::from(width) * fine, f64::from(height) * fine);
    }

    /// Draws the reports of a motor in these columns, and its setpoints up to now.
    pub(crate) fn draw_motor(
        &mut self,
        history: &History,
        track: &Track,
        (mirror, traces): (Mirror, Traces),
        grid: Grid,
        now_us: u64,
        palette: Palette,
    ) {
        // The most important trace comes last, on top.
        for trace in [
            Trace::Position,
            Trace::Temperature,
            Trace::Current,
            Trace::Speed,
        ] {
            if !traces.has(trace) {
                continue;
            }
            let lines = trace_lines(history, track, trace, mirror, grid);
            let goals = if traces.has(Trace::Goal) {
                goal_lines(track, trace, mirror, grid, now_us)
            } else {
                Vec::new()
            };
            let ends = self.fit(trace, extent(&lines).max(extent(&goals)));
            let colour = match trace {
                Trace::Current => palette.current,
                Trace::Temperature => palette.temperature,
                Trace::Position => palette.position,
                Trace::Speed | Trace::Goal => palette.speed,
            };
            self.set_dashed(true);
            self.draw_goals(
                &goals,
                ends,
                &Pen {
                    colour,
                    width: THIN,
                },
            );
            self.set_dashed(false);
            let width = if trace == Trace::Speed { BOLD } else { THIN };
            self.draw_lines(&lines, ends, &Pen { colour, width });
        }
    }

    /// The scale of a trace for values up to this distance from zero.
    pub(crate) fn fit(&mut self, trace: Trace, extent: f64) -> Ends {
        let scale = match trace {
            Trace::Speed | Trace::Goal => &mut self.speed,
            Trace::Current => &mut self.current,
            Trace::Temperature | Trace::Position => {
                let (lower, upper) = scale::ends(trace, extent);
                if trace == Trace::Temperature {
                    self.temperature_end = upper;
                }
                return (f64::from(lower), f64::from(upper));
            }
        };
        *scale = scale.fitted(extent);
        (-scale.limit(), scale.limit())
    }

    fn set_dashed(&self, dashed: bool) {
        let pixels = self.layout.ratio * f64::from(FINE);
        let lengths = js_sys::Array::new();
        if dashed {
            for length in DASH {
                lengths.push(&(length * pixels).into());
            }
        }
        // It fails for lists of invalid numbers only.
        let _ = self.context.set_line_dash(&lengths);
    }

    /// The positions of dots in the plot, in subpixels.
    pub(crate) fn coordinates(&self, (lower, upper): Ends) -> Coordinates {
        let plot = self.layout.plot;
        let across = FINE * plot.left..FINE * (plot.left + plot.width);
        let up = FINE * (plot.top + plot.height)..FINE * plot.top;
        let columns = 0.0..f64::from(self.layout.columns());
        Cartesian2d::new(columns, lower..upper, (across, up))
    }

    pub(crate) fn draw_lines(&self, lines: &[Vec<Dot>], ends: Ends, pen: &Pen) {
        let coordinates = self.coordinates(ends);
        let thickness = (pen.width * self.layout.ratio).round().max(1.0) * f64::from(FINE);
        self.context.set_fill_style_str(&css(pen.colour));
        for line in lines {
            let points: Vec<Pixel> = line.iter().map(|dot| coordinates.translate(dot)).collect();
            let Strokes { bars, paths, .. } = strokes(&points, FINE);
            for bar in bars {
                // Aligned to whole pixels, which are the cheapest to draw.
                let left = on_pixel(f64::from(bar.x) - thickness / 2.0);
                let top = on_pixel(f64::from(bar.top) - thickness / 2.0);
                let bottom = on_pixel(f64::from(bar.bottom) + thickness / 2.0);
                self.context.fill_rect(left, top, thickness, bottom - top);
            }
            for path in paths {
                self.draw_path(path, pen);
            }
        }
    }

    fn draw_goals(&self, goals: &[Vec<Dot>], ends: Ends, pen: &Pen) {
        let coordinates = self.coordinates(ends);
        for goal in goals {
            let path = goal.iter().map(|dot| coordinates.translate(dot));
            self.draw_path(path.collect(), pen);
        }
    }

    fn draw_path(&self, path: Vec<Pixel>, pen: &Pen) {
        let (red, green, blue) = pen.colour;
        let style = ShapeStyle {
            color: RGBColor(red, green, blue).to_rgba(),
            filled: false,
            stroke_width: whole(pen.width * self.layout.ratio * f64::from(FINE)),
        };
        if let Some(area) = &self.area {
            // Drawing a line on a canvas cannot fail.
            let _ = area.draw(&PathElement::new(path, style));
        }
    }
}

/// The nearest edge of a device pixel.
fn on_pixel(fine: f64) -> f64 {
    (fine / f64::from(FINE)).round() * f64::from(FINE)
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a few pixels"
)]
fn whole(width: f64) -> u32 {
    width.round() as u32
}
