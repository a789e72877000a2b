//! One trace of several motors: a line each, in its colour, and at its end whose it is.

use plotters::coord::CoordTranslate;

use crate::{
    features::graph::{
        plot::{
            columns::{Dot, Grid, extent},
            comparison::Comparison,
            end_labels::spread,
            lines::trace_lines,
            palette::{Colour, Palette, css},
        },
        traces::{BOLD, Ends, FINE, Pen, TraceCanvas},
    },
    model::history::History,
};

/// From one label to the next at least, in pixels of the style sheet.
const LABEL_GAP: f64 = 11.0;
/// From the plot to the labels.
const AIR: f64 = 6.0;

/// The line of a motor.
struct Line {
    /// Its ID.
    label: String,
    parts: Vec<Vec<Dot>>,
    colour: Colour,
}

impl TraceCanvas {
    /// Draws what each motor reported in these columns. All of them share a line that carries 576
    /// replies a second, so to draw many motors takes no more replies than to draw one; and of each it
    /// takes no more than two dots a column.
    pub(crate) fn draw_compared(
        &mut self,
        history: &History,
        comparison: &Comparison,
        grid: Grid,
        palette: Palette,
        font: &str,
    ) {
        let mut lines = Vec::new();
        for (place, id, mirror) in comparison.motors() {
            if let Some(track) = history.track(id) {
                lines.push(Line {
                    label: id.to_string(),
                    parts: trace_lines(history, track, comparison.trace, mirror, grid),
                    colour: palette.motors.get(place).copied().unwrap_or(palette.text),
                });
            }
        }
        let extent = lines.iter().map(|line| extent(&line.parts));
        let ends = self.fit(comparison.trace, extent.fold(0.0, f64::max));
        for line in &lines {
            let pen = Pen {
                colour: line.colour,
                width: BOLD,
            };
            self.draw_lines(&line.parts, ends, &pen);
        }
        self.label(&lines, ends, font);
    }

    /// Whose line is whose is said by more than its colour.
    fn label(&self, lines: &[Line], ends: Ends, font: &str) {
        let coordinates = self.coordinates(ends);
        let mut labelled = Vec::new();
        let mut heights = Vec::new();
        for line in lines {
            if let Some(end) = line.parts.last().and_then(|part| part.last()) {
                let (_, y) = coordinates.translate(end);
                labelled.push(line);
                heights.push(f64::from(y) / f64::from(FINE));
            }
        }
        let (pixel, plot) = (self.layout.ratio, self.layout.plot);
        let half = LABEL_GAP / 2.0 * pixel;
        let top = f64::from(plot.top) + half;
        let bottom = f64::from(plot.top + plot.height) - half;
        let x = f64::from(plot.left + plot.width) + AIR * pixel;
        let context = &self.context;
        // In pixels of the screen, as text is drawn.
        context.save();
        // It fails for numbers that are none.
        let _ = context.set_transform(1.0, 0.0, 0.0, 1.0, 0.0, 0.0);
        context.set_font(font);
        context.set_text_baseline("middle");
        let places = spread(&heights, LABEL_GAP * pixel, top, bottom);
        for (line, y) in labelled.into_iter().zip(places) {
            context.set_fill_style_str(&css(line.colour));
            let _ = context.fill_text(&line.label, x, y);
        }
        context.restore();
    }
}
