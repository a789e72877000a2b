//! One trace of several motors: one line per motor in its colour, labelled with its ID at the end.

use plotters::coord::CoordTranslate;

use crate::{
    features::graph::{
        kept::drawing,
        plot::{
            columns::{Dot, Grid, range},
            comparison::Comparison,
            end_labels::spread,
            lines::trace_lines,
            palette::Colour,
            surface::{FINE, Pen},
        },
        traces::{BOLD, Coordinates, Tracing},
    },
    model::history::History,
};

/// Minimal distance between labels, in CSS pixels.
const LABEL_GAP: f64 = 11.0;
/// Gap between the plot and the labels, in CSS pixels.
const PLOT_GAP: f64 = 6.0;

/// The line of a motor.
struct Line {
    /// Its ID.
    label: String,
    parts: Vec<Vec<Dot>>,
    colour: Colour,
}

impl Tracing<'_> {
    /// Draws what each motor reported in these columns. All motors share a bus of 576 replies a second, so many
    /// motors have no more replies to draw than one. Each line has at most two dots per column.
    pub(crate) fn draw_compared(&mut self, history: &History, comparison: &Comparison, grid: Grid) {
        let palette = self.palette;
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
        let kept = self.kept_lines(comparison.trace, grid);
        let shown = range(lines.iter().flat_map(|line| &line.parts).chain(&kept), &[]);
        let ends = self.scales.fit(comparison.trace, shown).ends();
        let coordinates = self.coordinates(self.layout.plot, ends);
        self.surface.begin_pane(self.layout.plot);
        let pale = drawing::pen(palette.text, palette.surface);
        self.draw_lines(&kept, &coordinates, &pale);
        for line in &lines {
            let pen = Pen {
                colour: line.colour,
                width: BOLD,
                dashed: false,
            };
            self.draw_lines(&line.parts, &coordinates, &pen);
        }
        self.surface.end_pane();
        self.label(&lines, &coordinates);
    }

    /// Labels each line, so that motors can be told apart without colours.
    fn label(&mut self, lines: &[Line], coordinates: &Coordinates) {
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
        let x = f64::from(plot.left + plot.width) + PLOT_GAP * pixel;
        let places = spread(&heights, LABEL_GAP * pixel, top, bottom);
        for (line, y) in labelled.into_iter().zip(places) {
            self.surface.label(&line.label, (x, y), line.colour);
        }
    }
}
