//! A chart as SVG. The classes of its parts take their colours from a style sheet.

use std::fmt::Write;

use motorlink_markup::Element;

use super::{Chart, Line, Look, Names};

/// The width of a chart in a file. Text size is 12 units.
pub(crate) const WIDTH: f64 = 720.0;
/// The greatest height without a legend.
pub const HEIGHT_MAX: f64 = 340.0;
/// Space for the labels: left, top, right, bottom.
const MARGIN: [f64; 4] = [64.0, 30.0, 16.0, 44.0];
/// Height of a row of the legend.
const ROW: f64 = 18.0;
/// Columns of the legend, if its names have room there. It stands above the plot, never over a curve.
const LEGEND_COLUMNS: u32 = 2;
/// Width of a character in the legend, at most.
const CHAR: f64 = 8.0;
/// A chart is drawn at least so wide.
const WIDTH_MIN: f64 = 200.0;
/// A line with more points is drawn by the least and greatest of each of this many columns.
const COLUMNS: usize = 1_000;

/// The style of a chart in a file, in the light colours of the page.
pub const STYLE: &str = ".chart text{font:12px system-ui,sans-serif;fill:#5a6474}.chart-grid{stroke:#e2e6eb}\
.chart path{fill:none;stroke:currentColor;stroke-width:2}.chart .faint{stroke-width:1;opacity:.4}\
.chart .dashed{stroke:#5a6474;stroke-width:1.5;stroke-dasharray:5 4}.chart .dots{stroke-width:5;stroke-linecap:round}\
.chart .crosses{stroke:#c3261b;stroke-width:1.5}.chart .legend{fill:currentColor}\
.colour-0{color:#0b64bd}.colour-1{color:#6741c9}.colour-2{color:#a84c06}.colour-3{color:#0a7a46}\
.colour-4{color:#a3206e}.colour-5{color:#7a6300}.colour-6{color:#08727f}.colour-7{color:#5a6474}";

/// Charts below each other as one SVG file.
#[must_use]
pub fn file(charts: &[Chart], names: &Names<'_>) -> String {
    let charts: Vec<Drawing> = charts
        .iter()
        .map(|chart| chart.of_size(WIDTH, HEIGHT_MAX))
        .collect();
    let height: f64 = charts.iter().map(Drawing::height).sum();
    let mut root = Element::new("svg")
        .with("xmlns", "http://www.w3.org/2000/svg")
        .with("width", WIDTH.to_string())
        .with("height", height.to_string())
        .with("viewBox", format!("0 0 {WIDTH} {height}"))
        .child(Element::new("style").text(STYLE))
        .child(
            Element::new("rect")
                .with("width", "100%")
                .with("height", "100%")
                .with("fill", "#ffffff"),
        );
    let mut down = 0.0;
    for chart in charts {
        root = root.child(
            chart
                .parts(names)
                .with("transform", format!("translate(0 {down})")),
        );
        down += chart.height();
    }
    let mut out = String::new();
    root.write(&mut out);
    out
}

impl Chart {
    /// The chart as an element `svg` of this width, hidden from screen readers: the figures say what it shows. Its units are
    /// pixels where it is shown at this width. Without its legend it is at most `height_max` high.
    #[must_use]
    pub fn svg(&self, names: &Names<'_>, width: f64, height_max: f64) -> Element {
        let drawing = self.of_size(width, height_max);
        Element::new("svg")
            .with("viewBox", format!("0 0 {width} {}", drawing.height()))
            .with("aria-hidden", "true")
            .child(drawing.parts(names))
    }

    const fn of_size(&self, width: f64, height_max: f64) -> Drawing<'_> {
        Drawing {
            chart: self,
            width: width.max(WIDTH_MIN),
            height_max,
        }
    }
}

/// A chart of this size.
struct Drawing<'a> {
    chart: &'a Chart,
    width: f64,
    height_max: f64,
}

impl Drawing<'_> {
    /// The lines in the legend.
    fn entries(&self) -> impl Iterator<Item = &Line> {
        let lines = self.chart.lines.iter();
        lines.filter(|line| !line.name.is_empty())
    }

    fn legend_columns(&self) -> u32 {
        // A Chinese character is twice as wide.
        let width =
            |name: &str| -> u32 { name.chars().map(|c| 1 + u32::from(c >= '\u{2E80}')).sum() };
        let [left, _, right, _] = MARGIN;
        let column = (self.width - left - right) / f64::from(LEGEND_COLUMNS);
        let longest = self.entries().map(|line| width(&line.name)).max();
        if longest.is_some_and(|longest| f64::from(longest) * CHAR > column) {
            1
        } else {
            LEGEND_COLUMNS
        }
    }

    fn legend_height(&self) -> f64 {
        let count = u32::try_from(self.entries().count()).unwrap_or(u32::MAX);
        ROW * f64::from(count.div_ceil(self.legend_columns()))
    }

    fn height(&self) -> f64 {
        (160.0 + self.width / 4.0).min(self.height_max) + self.legend_height()
    }

    /// The top of the plot.
    fn top(&self) -> f64 {
        MARGIN[1] + self.legend_height()
    }

    fn parts(&self, names: &Names<'_>) -> Element {
        let [left, _, right, bottom] = MARGIN;
        let Chart { x, y, lines } = self.chart;
        let (end, top, floor) = (self.width - right, self.top(), self.height() - bottom);
        let text = |x: f64, y: f64, anchor: &str, words: String| {
            Element::new("text")
                .with("x", short(x))
                .with("y", short(y))
                .with("text-anchor", anchor)
                .text(words)
        };
        let grid = |x1: f64, y1: f64, x2: f64, y2: f64| {
            Element::new("line")
                .with("class", "chart-grid")
                .with("x1", short(x1))
                .with("y1", short(y1))
                .with("x2", short(x2))
                .with("y2", short(y2))
        };
        let mut group = Element::new("g").with("class", "chart");
        for tick in &y.ticks {
            let (at, label) = (self.y_of(*tick), y.label(*tick));
            group = group.child(grid(left, at, end, at)).child(text(
                left - 8.0,
                at + 4.0,
                "end",
                label,
            ));
        }
        for tick in &x.ticks {
            let (at, label) = (self.x_of(*tick), x.label(*tick));
            group = group.child(grid(at, floor, at, floor + 4.0)).child(text(
                at,
                floor + 18.0,
                "middle",
                label,
            ));
        }
        group = group
            .child(text(left, top - 14.0, "start", names(y.name)))
            .child(text(end, self.height() - 8.0, "end", names(x.name)));
        group = group.children(lines.iter().map(|line| self.path(line)));
        let columns = self.legend_columns();
        let column = (end - left) / f64::from(columns);
        for (place, line) in (0..).zip(self.entries()) {
            let x = left + column * f64::from(place % columns);
            let y = ROW * f64::from(1 + place / columns);
            let entry = text(x, y, "start", line.name.clone());
            group = group.child(entry.with("class", format!("legend {}", colour(line))));
        }
        group
    }

    fn path(&self, line: &Line) -> Element {
        let look = match line.look {
            Look::Faint => "faint",
            Look::Plain | Look::Dotted => "plain",
            Look::Dashed => "dashed",
            Look::Dots => "dots",
            Look::Crosses => "crosses",
        };
        let finite = |(x, y): &&(f64, f64)| x.is_finite() && y.is_finite();
        let places = line.points.iter().filter(finite);
        let places: Vec<(f64, f64)> = places
            .map(|(x, y)| (self.x_of(*x), self.y_of(*y)))
            .collect();
        let mut path = String::new();
        // Writing to a string cannot fail.
        match line.look {
            Look::Dots => {
                for (x, y) in places {
                    let _ = write!(path, "M{} {}h0", short(x), short(y));
                }
            }
            Look::Crosses => {
                for (x, y) in places {
                    let (x, y) = (short(x - 4.0), short(y - 4.0));
                    let _ = write!(path, "M{x} {y}l8 8m0 -8l-8 8");
                }
            }
            _ => {
                for (number, (x, y)) in fewer(places).into_iter().enumerate() {
                    let letter = if number == 0 { 'M' } else { 'L' };
                    let _ = write!(path, "{letter}{} {}", short(x), short(y));
                }
            }
        }
        let element = Element::new("path")
            .with("class", format!("{look} {}", colour(line)))
            .with("d", path);
        match line.look {
            Look::Dotted => element.with("stroke-dasharray", "2 5"),
            _ => element,
        }
    }

    fn x_of(&self, value: f64) -> f64 {
        let [left, _, right, _] = MARGIN;
        left + self.chart.x.place(value) * (self.width - left - right)
    }

    fn y_of(&self, value: f64) -> f64 {
        let floor = self.height() - MARGIN[3];
        floor - self.chart.y.place(value) * (floor - self.top())
    }
}

fn colour(line: &Line) -> String {
    format!("colour-{}", line.colour)
}

/// A tenth of a unit is less than a pixel.
fn short(value: f64) -> String {
    format!("{value:.1}")
}

/// The least and greatest of each column, in their order.
fn fewer(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    if points.len() <= 4 * COLUMNS {
        return points;
    }
    let mut kept = Vec::new();
    for column in points.chunks(points.len().div_ceil(COLUMNS)) {
        let by_value = |one: &&(f64, f64), other: &&(f64, f64)| one.1.total_cmp(&other.1);
        let least = column.iter().min_by(by_value).copied();
        let greatest = column.iter().max_by(by_value).copied();
        let (mut first, mut second) = (least, greatest);
        if greatest < least {
            (first, second) = (second, first);
        }
        kept.extend(first.into_iter().chain(second));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::{super::AxisName, *};

    #[test]
    fn names_are_escaped_and_every_point_is_inside() {
        let line = Line {
            colour: 0,
            look: Look::Plain,
            name: "<b>".to_owned(),
            points: (0..10_000)
                .map(|number| (f64::from(number), f64::from(number % 7)))
                .collect(),
        };
        let chart = Chart::of(AxisName::Time, AxisName::Speed, vec![line]).unwrap();
        let text = file(&[chart.clone(), chart.clone()], &|name| format!("{name:?}"));
        assert!(text.contains("&lt;b&gt;") && !text.contains("<b>"));
        assert!(text.contains("translate(0 358)"));
        assert!(text.len() < 100_000, "{}", text.len());
        for (width, height) in [(WIDTH, 340.0), (360.0, 250.0)] {
            let drawing = chart.of_size(width, HEIGHT_MAX);
            for (x, y) in &chart.lines[0].points {
                assert!((64.0..=width - 16.0).contains(&drawing.x_of(*x)));
                assert!((48.0..=height - 26.0).contains(&drawing.y_of(*y)));
            }
        }
    }
}
