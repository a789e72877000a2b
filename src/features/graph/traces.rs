//! Draws the lines: on the screen with plotters, on their own canvas over the axes.

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
    features::graph::{
        kept::{drawing, state::Aligned},
        plot::{
            columns::{Dot, Grid, Spread, range},
            comparison::Subject,
            layout::{Layout, Rectangle},
            lines::{goal_lines, mean_lines, trace_lines},
            palette::{Colour, Palette, css},
            scale::{Ends, Fitting, Scales},
            strokes::{Bar, Pixel, Strokes, strokes},
            surface::{DASH, FINE, LineSurface, Pen},
            trace::{Trace, Traces},
        },
    },
    model::{
        history::{History, Track},
        mirror::Mirror,
    },
};

/// Line width of a motor's reports, in CSS pixels.
pub(crate) const BOLD: f64 = 1.75;
/// Line width of the other lines.
const THIN: f64 = 1.25;
/// How far lines may exceed the edge of the plot, so that a line at the end of its scale is not cut in half
/// lengthwise.
const BLEED: f64 = 2.0;

/// The canvas with the lines.
pub(crate) struct TraceCanvas {
    pub(crate) canvas: HtmlCanvasElement,
    context: CanvasRenderingContext2d,
    /// `None` before the canvas has a size.
    area: Option<DrawingArea<CanvasBackend, Shift>>,
    layout: Layout,
    /// The font of the labels.
    font: String,
}

/// Draws lines on a surface, and fits the scales to them.
pub(crate) struct Tracing<'a> {
    pub(crate) surface: &'a mut dyn LineSurface,
    pub(crate) scales: &'a mut Scales,
    pub(crate) fitting: Fitting,
    pub(crate) layout: Layout,
    pub(crate) palette: Palette,
    /// The kept run, under everything else.
    pub(crate) kept: Option<Aligned>,
}

/// Converts columns and values to subpixels.
pub(crate) type Coordinates = Cartesian2d<RangedCoordf64, RangedCoordf64>;

impl Tracing<'_> {
    /// Draws what was reported in these columns, and setpoints up to now.
    pub(crate) fn draw(&mut self, history: &History, subject: &Subject, grid: Grid, now_us: u64) {
        self.scales.choose(self.fitting);
        match subject {
            Subject::Motor { id, mirror, traces } => {
                if let Some(track) = history.track(*id) {
                    self.draw_motor(history, track, (*mirror, *traces), grid, now_us);
                }
            }
            Subject::Compared(comparison) => self.draw_compared(history, comparison, grid),
        }
    }

    /// Draws the reports of a motor in these columns, and its setpoints up to now.
    fn draw_motor(
        &mut self,
        history: &History,
        track: &Track,
        (mirror, traces): (Mirror, Traces),
        grid: Grid,
        now_us: u64,
    ) {
        let panes = traces.panes();
        for (&trace, pane) in panes.iter().zip(self.layout.panes(panes.len())) {
            let (lines, spreads) = match trace {
                Trace::Current => mean_lines(history, track, trace, mirror, grid),
                _ => (trace_lines(history, track, trace, mirror, grid), Vec::new()),
            };
            let goals = if traces.has(Trace::Goal) {
                goal_lines(track, trace, mirror, grid, now_us)
            } else {
                Vec::new()
            };
            let kept = self.kept_lines(trace, grid);
            let shown = range(lines.iter().chain(&goals).chain(&kept), &spreads);
            let ends = self.scales.fit(trace, shown).ends();
            let coordinates = self.coordinates(pane, ends);
            let colour = self.palette.of(trace);
            let pale = drawing::pen(colour, self.palette.surface);
            let goal = Pen {
                colour: self.palette.of(Trace::Goal),
                width: THIN,
                dashed: true,
            };
            let pen = Pen {
                colour,
                width: if trace == Trace::Speed { BOLD } else { THIN },
                dashed: false,
            };
            self.surface.begin_pane(pane);
            self.draw_spreads(&spreads, &coordinates, pale.colour);
            self.draw_lines(&kept, &coordinates, &pale);
            self.draw_lines(&goals, &coordinates, &goal);
            self.draw_lines(&lines, &coordinates, &pen);
            self.surface.end_pane();
        }
    }

    /// The lines of the kept run.
    pub(crate) fn kept_lines(&self, trace: Trace, grid: Grid) -> Vec<Vec<Dot>> {
        let kept = self.kept.as_ref();
        kept.map(|kept| kept.lines(trace, grid)).unwrap_or_default()
    }

    /// The positions of dots in a pane, in subpixels.
    pub(crate) fn coordinates(&self, pane: Rectangle, (lower, upper): Ends) -> Coordinates {
        let across = FINE * pane.left..FINE * (pane.left + pane.width);
        let up = FINE * (pane.top + pane.height)..FINE * pane.top;
        let columns = 0.0..f64::from(self.layout.columns());
        Cartesian2d::new(columns, lower..upper, (across, up))
    }

    fn draw_spreads(&mut self, spreads: &[Spread], at: &Coordinates, colour: Colour) {
        let bar = |(column, least, greatest): &Spread| {
            let ((x, bottom), (_, top)) = (
                at.translate(&(*column, *least)),
                at.translate(&(*column, *greatest)),
            );
            Bar { x, top, bottom }
        };
        let bars: Vec<Bar> = spreads.iter().map(bar).collect();
        if !bars.is_empty() {
            self.surface.bars(&bars, colour);
        }
    }

    pub(crate) fn draw_lines(&mut self, lines: &[Vec<Dot>], at: &Coordinates, pen: &Pen) {
        // What is far out of sight of a zoomed axis would exceed the numbers of what draws it.
        let far = 16 * FINE * self.layout.plot.height;
        for line in lines {
            let points = line.iter().map(|dot| {
                let (x, y) = at.translate(dot);
                (x, y.clamp(-far, far))
            });
            self.surface.line(points.collect(), pen);
        }
    }
}

impl TraceCanvas {
    /// `None` if the browser has no 2D context for the canvas.
    pub(crate) fn of(canvas: HtmlCanvasElement) -> Option<Self> {
        let context = canvas.get_context("2d").ok()??.dyn_into().ok()?;
        Some(Self {
            canvas,
            context,
            area: None,
            layout: Layout::default(),
            font: String::new(),
        })
    }

    pub(crate) fn resize(&mut self, layout: Layout) {
        self.layout = layout;
        super::axes::resize(&self.canvas, layout);
        let fine = f64::from(FINE);
        // A canvas loses its settings when its size is set. It fails for invalid numbers only.
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

    /// Clears all lines. The next labels have this font.
    pub(crate) fn clear(&mut self, font: String) {
        self.font = font;
        let (width, height) = (self.layout.width, self.layout.height);
        let fine = f64::from(FINE);
        self.context
            .clear_rect(0.0, 0.0, f64::from(width) * fine, f64::from(height) * fine);
    }

    /// A path through whole strokes, and steep ones as bars.
    fn draw_solid(&self, points: &[Pixel], pen: &Pen) {
        let thickness = (pen.width * self.layout.ratio).round().max(1.0) * f64::from(FINE);
        self.context.set_fill_style_str(&css(pen.colour));
        let Strokes { bars, paths, .. } = strokes(points, FINE);
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

impl LineSurface for TraceCanvas {
    fn begin_pane(&mut self, pane: Rectangle) {
        let bleed = (BLEED * self.layout.ratio).ceil();
        let [left, top, width, height] = [
            f64::from(pane.left),
            f64::from(pane.top) - bleed,
            f64::from(pane.width),
            f64::from(pane.height) + 2.0 * bleed,
        ]
        .map(|length| length * f64::from(FINE));
        self.context.save();
        self.context.begin_path();
        self.context.rect(left, top, width, height);
        self.context.clip();
    }

    fn end_pane(&mut self) {
        self.context.restore();
    }

    fn line(&mut self, points: Vec<Pixel>, pen: &Pen) {
        if pen.dashed {
            self.set_dashed(true);
            self.draw_path(points, pen);
            self.set_dashed(false);
        } else {
            self.draw_solid(&points, pen);
        }
    }

    fn bars(&mut self, bars: &[Bar], colour: Colour) {
        let pixel = f64::from(FINE);
        self.context.set_fill_style_str(&css(colour));
        for bar in bars {
            let (top, bottom) = (f64::from(bar.top), f64::from(bar.bottom));
            let left = f64::from(bar.x) - pixel / 2.0;
            self.context
                .fill_rect(left, top, pixel, (bottom - top).max(pixel));
        }
    }

    fn label(&mut self, text: &str, (x, y): (f64, f64), colour: Colour) {
        let context = &self.context;
        // Text is drawn in device pixels.
        context.save();
        // These fail for invalid numbers only.
        let _ = context.set_transform(1.0, 0.0, 0.0, 1.0, 0.0, 0.0);
        context.set_font(&self.font);
        context.set_text_baseline("middle");
        context.set_fill_style_str(&css(colour));
        let _ = context.fill_text(text, x, y);
        context.restore();
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
