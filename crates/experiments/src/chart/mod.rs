//! Charts of findings: lines in two axes, as data and as SVG.
//!
//! | module | idea |
//! |---|---|
//! | `axis` | a scale with its ticks |
//! | `of_findings` | the charts of one run, or of several over each other |
//! | `svg` | a chart as SVG |

mod axis;
mod of_findings;
mod svg;

pub use axis::Axis;
pub use of_findings::{charts, compared_charts};
pub(crate) use svg::WIDTH;
pub use svg::{HEIGHT_MAX, STYLE, file};

/// Maximal number of runs over each other, and of colours.
pub const RUNS_MAX: usize = 8;

/// What an axis shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisName {
    /// Seconds.
    Time,
    /// rpm.
    Speed,
    /// A.
    Current,
    /// deg C.
    Temperature,
    /// Hz, on a logarithmic scale.
    Frequency,
    /// dB.
    Gain,
    /// Degrees.
    Phase,
    /// Degrees of the wheel.
    Position,
    /// The part of the power that a sine explains, 0 to 1.
    RSquared,
}

/// Gives the name of an axis with its unit, in the language of the reader.
pub type Names<'a> = dyn Fn(AxisName) -> String + 'a;

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// A thin line behind the others, for one of several repeats.
    Faint,
    /// A line.
    Plain,
    /// What was commanded.
    Dashed,
    /// A dotted line: a fitted model.
    Dotted,
    /// A dot for each point.
    Dots,
    /// A cross for each point: it is not valid.
    Crosses,
}

/// A line of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its place in the list of colours.
    pub colour: usize,
    /// How it is drawn.
    pub look: Look,
    /// Its entry in the legend; empty for none.
    pub name: String,
    /// Its points, in the units of the axes.
    pub points: Vec<(f64, f64)>,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// The lower axis.
    pub x: Axis,
    /// The left axis.
    pub y: Axis,
    /// Its lines, the first behind the others.
    pub lines: Vec<Line>,
}

impl Chart {
    /// A chart whose axes hold all points; `None` without points.
    #[must_use]
    pub fn of(x: AxisName, y: AxisName, lines: Vec<Line>) -> Option<Self> {
        let points = || lines.iter().flat_map(|line| &line.points);
        Some(Self {
            x: Axis::holding(x, points().map(|point| point.0))?,
            y: Axis::holding(y, points().map(|point| point.1))?,
            lines,
        })
    }
}
