//! Divides the graph into the plot and its labels.

use crate::ui::mathematics::limited;

/// Width of the labels of the values, `+400 U/min`, in CSS pixels.
const LEFT: f64 = 76.0;
/// Width of the names behind compared lines, `0x0A`, and half a time of day.
const RIGHT: f64 = 36.0;
/// Half a line of text above the top line.
const TOP: f64 = 8.0;
/// Height of the time axis.
const BOTTOM: f64 = 22.0;

/// Width of a mark of the time axis that shows an age: `60 s` with a gap.
const AGO_WIDTH: f64 = 72.0;
/// Width of a mark that shows the time of day: `13:15:36.95` with a gap.
const DAY_WIDTH: f64 = 92.0;
/// Height of a row of labels with a gap.
const ROW: f64 = 24.0;
/// Gap between two panes.
const GAP: f64 = 10.0;

/// Least size of a picture in pixels, without its legend: it fills the width of a page in print.
const PICTURE: [f64; 2] = [1_600.0, 900.0];
/// Least number of a picture's pixels per CSS pixel: at one, its labels are too small to read in print.
const PICTURE_RATIO: f64 = 2.0;

/// A rectangle in device pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) struct Rectangle {
    pub(crate) left: i32,
    pub(crate) top: i32,
    pub(crate) width: i32,
    pub(crate) height: i32,
}

/// The division of the graph. Everything is drawn in device pixels; on a screen of high density a CSS pixel is
/// several of them.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(crate) struct Layout {
    /// Device pixels per CSS pixel.
    pub(crate) ratio: f64,
    /// Width of the graph in device pixels.
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// All panes with the gaps between them.
    pub(crate) plot: Rectangle,
}

impl Layout {
    /// The layout of a box of this size in CSS pixels.
    pub(crate) fn new(width: f64, height: f64, ratio: f64) -> Self {
        let ratio = if ratio.is_finite() {
            limited(ratio, 0.5, 8.0)
        } else {
            1.0
        };
        // A box that is too small for its labels has no plot.
        let pixels = |length: f64| pixels(limited((length * ratio).floor(), 0.0, 16_000.0));
        let (all_width, all_height) = (pixels(width), pixels(height));
        let (left, top) = (pixels(LEFT), pixels(TOP));
        Self {
            ratio,
            width: all_width.unsigned_abs(),
            height: all_height.unsigned_abs(),
            plot: Rectangle {
                left,
                top,
                width: (all_width - left - pixels(RIGHT)).max(0),
                height: (all_height - top - pixels(BOTTOM)).max(0),
            },
        }
    }

    /// The layout of a picture of this graph, which is no smaller than [`PICTURE`].
    pub(crate) fn of_picture(self) -> Self {
        let ratio = self.ratio.max(PICTURE_RATIO);
        let [width, height] = PICTURE;
        let length =
            |pixels: u32, least: f64| (f64::from(pixels) / self.ratio).max((least / ratio).ceil());
        Self::new(
            length(self.width, width),
            length(self.height, height),
            ratio,
        )
    }

    pub(crate) fn is_empty(self) -> bool {
        self.plot.width == 0 || self.plot.height == 0
    }

    /// Number of pixel columns in the plot.
    pub(crate) fn columns(self) -> u32 {
        self.plot.width.unsigned_abs()
    }

    /// Converts CSS pixels from the left of the graph to columns from the left edge of the plot.
    pub(crate) fn column(self, x: f64) -> f64 {
        x * self.ratio - f64::from(self.plot.left)
    }

    /// Converts columns from the left edge of the plot to CSS pixels from the left of the graph.
    pub(crate) fn x(self, column: f64) -> f64 {
        (column + f64::from(self.plot.left)) / self.ratio
    }

    /// The pane at a height in CSS pixels from the top of the graph, and the place in it: 0 at its top, 1 at its bottom.
    /// Above the first one it is the first, and below the last one the last.
    pub(crate) fn pane_at(self, count: usize, y: f64) -> Option<(usize, f64)> {
        let y = y * self.ratio;
        let last = count.checked_sub(1)?;
        let ends_below = |(place, pane): &(usize, Rectangle)| {
            *place == last || y < f64::from(pane.top + pane.height)
        };
        let (place, pane) = self.panes(count).enumerate().find(ends_below)?;
        Some((place, place_in(pane, y)))
    }

    /// The place of a height in this pane of so many, in CSS pixels.
    pub(crate) fn place_in(self, count: usize, pane: usize, y: f64) -> f64 {
        let pane = self.panes(count).nth(pane).unwrap_or(self.plot);
        place_in(pane, y * self.ratio)
    }

    /// The fraction of the plot's width to the left of a position in CSS pixels: 0 to 1.
    pub(crate) fn part(self, x: f64) -> f64 {
        let width = f64::from(self.plot.width.max(1));
        limited(self.column(x) / width, 0.0, 1.0)
    }

    /// The panes from the top, all of one height.
    pub(crate) fn panes(self, count: usize) -> impl Iterator<Item = Rectangle> {
        let count = i32::try_from(count).unwrap_or(1).max(1);
        let gap = pixels(GAP * self.ratio);
        let height = ((self.plot.height - gap * (count - 1)) / count).max(0);
        (0..count).map(move |place| Rectangle {
            top: self.plot.top + place * (height + gap),
            height,
            ..self.plot
        })
    }

    /// How many halves of a row of labels a pane is high.
    pub(crate) fn half_rows(self, pane: Rectangle) -> i32 {
        pixels(2.0 * f64::from(pane.height) / (ROW * self.ratio))
    }

    /// Maximal number of marks on the time axis.
    pub(crate) fn marks(self, live: bool) -> u32 {
        let width = if live { AGO_WIDTH } else { DAY_WIDTH };
        let marks = f64::from(self.plot.width) / (width * self.ratio);
        pixels(marks.floor()).unsigned_abs().max(1)
    }
}

/// The place of a height in device pixels: 0 at the top of a pane, 1 at its bottom.
fn place_in(pane: Rectangle, y: f64) -> f64 {
    (y - f64::from(pane.top)) / f64::from(pane.height.max(1))
}

/// The row and the left position of parts of these lengths, placed one after another in rows of this width. `taken`
/// is occupied at the end of the first row.
pub(crate) fn in_rows(lengths: &[f64], width: f64, taken: f64) -> Vec<(f64, f64)> {
    let (mut row, mut x, mut room) = (0.0, 0.0, width - taken);
    let place = |length: &f64| {
        // A part that is too long for any row gets its own row; the first row is never empty.
        if x > 0.0 && x + length > room {
            (row, x, room) = (row + 1.0, 0.0, width);
        }
        x += length;
        (row, x - length)
    };
    lengths.iter().map(place).collect()
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "clamped to what a canvas can have"
)]
fn pixels(length: f64) -> i32 {
    length as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_the_density_is_twice_the_pixels() {
        let once = Layout::new(700.0, 200.0, 1.0);
        let twice = Layout::new(700.0, 200.0, 2.0);
        assert_eq!((once.width, once.height), (700, 200));
        assert_eq!((twice.width, twice.height), (1_400, 400));
        assert_eq!(twice.columns(), 2 * once.columns());
        assert_eq!(twice.marks(true), once.marks(true));
    }

    #[test]
    fn a_picture_of_any_graph_is_large_enough_to_print() {
        for (width, height, ratio) in [
            (563.0, 128.0, 1.0),
            (366.0, 210.0, 3.0),
            (2_500.0, 700.0, 1.5),
        ] {
            let picture = Layout::new(width, height, ratio).of_picture();
            assert!(
                picture.width >= 1_600 && picture.height >= 900,
                "{picture:?}"
            );
            assert!(picture.ratio >= 2.0);
        }
        // A large graph keeps its shape.
        let large = Layout::new(1_400.0, 700.0, 2.0);
        assert_eq!(large.of_picture(), large);
    }

    #[test]
    fn a_place_is_found_from_either_side() {
        for ratio in [1.0, 1.25, 2.0, 3.0] {
            let layout = Layout::new(703.4, 201.7, ratio);
            for x in [68.0, 100.0, 655.5] {
                assert!((layout.x(layout.column(x)) - x).abs() < 1e-9);
            }
            assert!(layout.column(LEFT).abs() < 1.0);
            assert_eq!((layout.part(0.0), layout.part(700.0)), (0.0, 1.0));
        }
    }

    #[test]
    fn a_box_without_room_has_no_plot() {
        for (width, height, ratio) in [(0.0, 0.0, 1.0), (80.0, 500.0, 2.0), (500.0, 20.0, 1.0)] {
            assert!(Layout::new(width, height, ratio).is_empty());
        }
        assert!(!Layout::new(300.0, 120.0, f64::NAN).is_empty());
    }

    #[test]
    fn a_legend_goes_on_in_the_next_row_where_one_is_full() {
        let places = in_rows(&[40.0, 40.0, 40.0, 40.0], 100.0, 30.0);
        let whole = places.iter().map(|(row, x)| (row.round(), x.round()));
        let wanted = [(0.0, 0.0), (1.0, 0.0), (1.0, 40.0), (2.0, 0.0)];
        assert!(whole.eq(wanted), "{places:?}");
        assert!(in_rows(&[], 100.0, 30.0).is_empty());
    }

    #[test]
    fn marks_have_room() {
        assert_eq!(Layout::new(346.0, 150.0, 3.0).marks(true), 3);
        assert_eq!(Layout::new(346.0, 150.0, 3.0).marks(false), 2);
        assert_eq!(Layout::new(90.0, 150.0, 1.0).marks(true), 1);
    }

    #[test]
    fn panes_share_the_height_and_have_room_for_their_labels() {
        for ratio in [1.0, 2.0] {
            let layout = Layout::new(500.0, 230.0, ratio);
            assert_eq!(layout.panes(1).collect::<Vec<_>>(), [layout.plot]);
            let panes: Vec<Rectangle> = layout.panes(2).collect();
            let gap = panes[1].top - panes[0].top - panes[0].height;
            assert_eq!(f64::from(gap).to_bits(), (GAP * ratio).to_bits());
            let bottom = panes[1].top + panes[1].height;
            assert_eq!(bottom, layout.plot.top + layout.plot.height);
            let half_rows = [layout.plot, panes[1]].map(|pane| layout.half_rows(pane));
            assert_eq!(half_rows, [16, 7]);
            let [upper, lower] = [8.0 + 95.0 / 2.0, 113.0 + 95.0].map(|y| layout.pane_at(2, y));
            assert_eq!((upper, lower), (Some((0, 0.5)), Some((1, 1.0))));
            assert!(
                layout
                    .pane_at(2, 0.0)
                    .is_some_and(|(pane, place)| pane == 0 && place < 0.0)
            );
            assert_eq!(layout.pane_at(0, 50.0), None);
        }
    }
}
