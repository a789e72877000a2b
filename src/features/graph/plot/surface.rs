//! What the graph is drawn on: a canvas, or a vector picture.

use crate::features::graph::plot::{
    layout::Rectangle,
    palette::Colour,
    strokes::{Bar, Pixel},
};

/// Subpixels per device pixel. plotters draws at whole pixels, which turns a gentle slope into steps. So it gets
/// coordinates eight times as large, and a canvas scales them down.
pub(crate) const FINE: i32 = 8;

/// Where a text is, relative to its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    /// Right of it.
    Left,
    /// On both sides of it.
    Center,
    /// Left of it.
    Right,
}

/// The style of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pen {
    pub(crate) colour: Colour,
    /// In CSS pixels.
    pub(crate) width: f64,
    pub(crate) dashed: bool,
}

/// The dashes of a dashed line and their gaps, in CSS pixels.
pub(crate) const DASH: [f64; 2] = [5.0, 4.0];

/// A surface for axes and legend. Positions are in device pixels.
pub(crate) trait AxesSurface {
    /// Fills a rectangle, given by its left and top edge, its width and its height.
    fn fill(&mut self, rectangle: [f64; 4], colour: Colour, opacity: Opacity);

    /// Writes a text. Its middle is at the height `y`.
    fn write(&mut self, text: &str, at: (f64, f64), align: Align, colour: Colour);
}

/// How much of what is below a fill is visible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Opacity {
    /// Nothing.
    Full,
    /// A good half: the fill covers 45 %.
    Weak,
}

/// A surface for lines.
pub(crate) trait LineSurface {
    /// The lines up to [`LineSurface::end_pane`] are cut off at the edges of this rectangle.
    fn begin_pane(&mut self, pane: Rectangle);

    fn end_pane(&mut self);

    /// Draws a line through these points, which are in subpixels, from left to right.
    fn line(&mut self, points: Vec<Pixel>, pen: &Pen);

    /// Draws bars that are one device pixel wide; their ends are in subpixels.
    fn bars(&mut self, bars: &[Bar], colour: Colour);

    /// Writes a text to the right of a position in device pixels. Its middle is at the height `y`.
    fn label(&mut self, text: &str, at: (f64, f64), colour: Colour);
}
