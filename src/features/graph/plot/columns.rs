//! Decimates replies to the least and the greatest value of each pixel column, in the order of time.
//!
//! A column is a period of absolute time, not of the view. While the graph scrolls by whole columns, each column
//! keeps its values, so the line does not shimmer.

/// A point of a line: its position in columns from the left edge of the view, and the value in its unit.
pub type Dot = (f64, f64);

/// The columns of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Length of a column: at least 1 µs.
    pub column_us: u64,
    /// The number of the leftmost column, counted from zero of the worker's clock.
    first: i64,
    /// Number of columns.
    count: u32,
}

impl Default for Grid {
    /// No columns, as before the first drawing.
    fn default() -> Self {
        Self::new(0, 0, 0)
    }
}

impl Grid {
    /// `count` columns over `span_us`; the last one contains the moment at the right edge.
    ///
    /// A column lasts a whole number of microseconds, so the view can be up to half a microsecond per column shorter
    /// or longer than `span_us`.
    #[must_use]
    pub fn new(span_us: u64, right_us: u64, count: u32) -> Self {
        let columns = u64::from(count.max(1));
        let column_us = ((span_us + columns / 2) / columns).max(1);
        let end = whole(right_us / column_us) + 1;
        Self {
            column_us,
            first: end - i64::from(count),
            count,
        }
    }

    /// The moment at the left edge, but not before zero of the worker's clock.
    pub(crate) fn left_us(self) -> u64 {
        u64::try_from(self.first).unwrap_or(0) * self.column_us
    }

    /// The moment at the right edge: the end of the last column.
    pub(crate) fn right_us(self) -> u64 {
        u64::try_from(self.first + i64::from(self.count)).unwrap_or(0) * self.column_us
    }

    /// As many columns over times that are this much earlier, to the nearest column.
    pub(crate) fn earlier(self, by_us: i64) -> Self {
        let column_us = whole(self.column_us).max(1);
        let columns = (by_us + column_us / 2).div_euclid(column_us);
        Self {
            first: self.first.saturating_sub(columns),
            ..self
        }
    }

    /// Length of all columns.
    pub(crate) fn span_us(self) -> u64 {
        u64::from(self.count) * self.column_us
    }

    /// The position of a moment, in columns from the left edge.
    #[allow(
        clippy::cast_precision_loss,
        reason = "only moments near the view are asked for"
    )]
    pub(crate) fn place(self, at_us: u64) -> f64 {
        let columns = (whole(at_us / self.column_us) - self.first) as f64;
        columns + (at_us % self.column_us) as f64 / self.column_us as f64
    }

    /// The moment at a position, in columns from the left edge.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "microseconds of a session are exact in a double, and a cast back saturates"
    )]
    pub(crate) fn moment_us(self, place: f64) -> u64 {
        ((self.first as f64 + place) * self.column_us as f64) as u64
    }

    /// The middle of the column of this moment.
    #[allow(clippy::cast_precision_loss, reason = "as above")]
    fn middle(self, at_us: u64) -> f64 {
        (whole(at_us / self.column_us) - self.first) as f64 + 0.5
    }
}

/// A number of columns; there are fewer than 2^63 microseconds.
fn whole(columns: u64) -> i64 {
    i64::try_from(columns).unwrap_or(i64::MAX)
}

/// Several values in one column: its middle, and the least and the greatest of them.
pub(crate) type Spread = (f64, f64, f64);

/// Builds lines from values in the order of time.
pub struct Lines {
    grid: Grid,
    /// Whether a column has the mean of its values instead of the least and the greatest, which are in `spreads`.
    averaged: bool,
    spreads: Vec<Spread>,
    done: Vec<Vec<Dot>>,
    line: Vec<Dot>,
    column: Option<Column>,
}

/// The extremes of one column, in the order in which they came.
#[derive(Clone, Copy)]
struct Column {
    /// The start of the next column, on the worker's clock.
    end_us: u64,
    middle: f64,
    least: f32,
    greatest: f32,
    sum: f64,
    count: u32,
    /// Whether the greatest value came after the least.
    rising: bool,
}

impl Lines {
    /// No lines.
    #[must_use]
    pub fn new(grid: Grid) -> Self {
        Self {
            grid,
            averaged: false,
            spreads: Vec::new(),
            done: Vec::new(),
            line: Vec::new(),
            column: None,
        }
    }

    /// Lines through the mean of each column.
    pub(crate) fn averaged(grid: Grid) -> Self {
        Self {
            averaged: true,
            ..Self::new(grid)
        }
    }

    /// Adds a value. This is called tens of thousands of times a frame, so a value in the same column as the last one
    /// must be cheap.
    pub fn to(&mut self, at_us: u64, value: f32) {
        match &mut self.column {
            Some(column) if at_us < column.end_us => {
                column.sum += f64::from(value);
                column.count += 1;
                if value < column.least {
                    column.least = value;
                    column.rising = false;
                } else if value > column.greatest {
                    column.greatest = value;
                    column.rising = true;
                }
            }
            _ => self.begin_column(at_us, value),
        }
    }

    fn begin_column(&mut self, at_us: u64, value: f32) {
        self.end_column();
        let Grid { column_us, .. } = self.grid;
        self.column = Some(Column {
            end_us: (at_us / column_us + 1) * column_us,
            middle: self.grid.middle(at_us),
            least: value,
            greatest: value,
            sum: value.into(),
            count: 1,
            rising: true,
        });
    }

    /// Ends the line. The next value begins a new one.
    pub fn cut(&mut self) {
        self.end_column();
        let mut line = std::mem::take(&mut self.line);
        let right = f64::from(self.grid.count);
        match line.as_mut_slice() {
            [] => {}
            // The whole line lies before the view.
            [.., (x, _)] if *x < 0.0 => {}
            [(x, _), ..] if *x > right => {}
            // A single value gets the width of its column, so that it is visible.
            [(x, y)] => {
                let (from, to) = ((*x - 0.5, *y), (*x + 0.5, *y));
                self.done.push(vec![from, to]);
            }
            _ => self.done.push(line),
        }
    }

    /// The lines, and the columns in view with several values.
    pub(crate) fn finish_with_spreads(mut self) -> (Vec<Vec<Dot>>, Vec<Spread>) {
        self.cut();
        (self.done, self.spreads)
    }

    /// The lines, clipped at the edges of the view.
    #[must_use]
    pub fn finish(mut self) -> Vec<Vec<Dot>> {
        self.cut();
        self.done
    }

    fn end_column(&mut self) {
        let Some(column) = self.column.take() else {
            return;
        };
        let (least, greatest) = (f64::from(column.least), f64::from(column.greatest));
        if column.least.to_bits() == column.greatest.to_bits() {
            self.dot((column.middle, least));
        } else if self.averaged {
            if (0.0..=f64::from(self.grid.count)).contains(&column.middle) {
                self.spreads.push((column.middle, least, greatest));
            }
            self.dot((column.middle, column.sum / f64::from(column.count)));
        } else if column.rising {
            self.dot((column.middle, least));
            self.dot((column.middle, greatest));
        } else {
            self.dot((column.middle, greatest));
            self.dot((column.middle, least));
        }
    }

    /// Adds a dot. A dot before the view moves to its left edge, a dot after it to its right edge.
    fn dot(&mut self, dot: Dot) {
        let right = f64::from(self.grid.count);
        let mut dot = dot;
        if let Some(last) = self.line.last_mut() {
            if last.0 < 0.0 && dot.0 >= 0.0 {
                *last = crossing(*last, dot, 0.0);
            }
            if last.0 <= right && dot.0 > right {
                dot = crossing(*last, dot, right);
            }
        }
        match self.line.as_mut_slice() {
            // A constant value extends the line without a new dot.
            [.., before, last] if same(before.1, last.1) && same(last.1, dot.1) => last.0 = dot.0,
            _ => self.line.push(dot),
        }
    }
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits()
}

/// The value at which the line between two dots crosses an edge.
fn crossing(from: Dot, to: Dot, edge: f64) -> Dot {
    let part = (edge - from.0) / (to.0 - from.0);
    (edge, from.1 + (to.1 - from.1) * part)
}

/// The least and the greatest value of something.
pub(crate) type Range = (f64, f64);

/// The range of these lines and columns; `None` without any.
pub(crate) fn range<'a>(
    lines: impl IntoIterator<Item = &'a Vec<Dot>>,
    spreads: &[Spread],
) -> Option<Range> {
    let dots = lines.into_iter().flatten();
    let ranges = dots.map(|(_, value)| (*value, *value));
    let ranges = ranges.chain(
        spreads
            .iter()
            .map(|(_, least, greatest)| (*least, *greatest)),
    );
    ranges.reduce(|range, other| (range.0.min(other.0), range.1.max(other.1)))
}

#[cfg(test)]
#[path = "columns_tests.rs"]
mod tests;
