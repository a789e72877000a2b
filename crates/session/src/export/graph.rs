//! The graph of a report: speed and current of each motor over time, as SVG.

use std::fmt::Write;

use motorlink_markup::Element;

use crate::overview::{Extent, MotorOverview, Overview};

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 160.0;
/// Margin above and below the trace, in pixels.
const MARGIN: f64 = 12.0;

/// A quantity of the graph.
pub(super) struct Quantity {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) colour: &'static str,
    /// Returns the least and greatest value of a bucket, if it has any.
    pub(super) of: fn(&Extent) -> Option<(f64, f64)>,
}

/// The quantities, in their order.
pub(super) const QUANTITIES: [Quantity; 2] = [
    Quantity {
        name: "Speed",
        unit: "rpm",
        colour: "#0072b2",
        of: |extent| Some((extent.speed.0.rpm().into(), extent.speed.1.rpm().into())),
    },
    Quantity {
        name: "Current",
        unit: "A",
        colour: "#d55e00",
        of: |extent| {
            let (least, most) = extent.current?;
            Some((least.amps().into(), most.amps().into()))
        },
    },
];

/// The trace of a motor: a bar from the least to the greatest value of each bucket, and marks.
pub(super) fn graph(overview: &Overview, motor: &MotorOverview, quantity: &Quantity) -> Element {
    let duration = overview.duration().as_secs_f64().max(1e-3);
    let bucket = overview.bucket().as_secs_f64();
    let extremes = motor
        .extent()
        .and_then(|extent| (quantity.of)(&extent))
        .unwrap_or_default();
    let (low, high) = (extremes.0.min(0.0), extremes.1.max(0.0));
    let span = (high - low).max(1e-3);
    let y = |value: f64| MARGIN + (high - value) / span * (HEIGHT - 2.0 * MARGIN);
    let mut path = String::new();
    for (number, extent) in (0_u32..).zip(motor.buckets()) {
        let Some((least, greatest)) = extent.as_ref().and_then(quantity.of) else {
            continue;
        };
        let x = f64::from(number) * bucket / duration * WIDTH;
        // Half a pixel more on each side, so that a constant value is visible.
        let (top, bottom) = (y(greatest) - 0.5, y(least) + 0.5);
        // Writing to a string cannot fail.
        let _ = write!(path, "M{x:.1} {top:.1}V{bottom:.1}");
    }
    let mark_lines = overview
        .marks()
        .iter()
        .filter(|mark| mark.error)
        .map(|mark| {
            let x = mark.after.as_secs_f64() / duration * WIDTH;
            let line = Element::new("line").with("class", "mark");
            let line = line
                .with("x1", format!("{x:.1}"))
                .with("x2", format!("{x:.1}"));
            line.with("y1", "0").with("y2", HEIGHT.to_string())
        });
    let zero = format!("{:.1}", y(0.0));
    let label = |place: f64, value: f64| {
        let text = format!("{value:.2} {}", quantity.unit);
        Element::new("text")
            .with("x", "4")
            .with("y", place.to_string())
            .text(text)
    };
    let Quantity {
        name, unit, colour, ..
    } = quantity;
    Element::new("svg")
        .with("viewBox", format!("0 0 {WIDTH} {HEIGHT}"))
        .with("role", "img")
        .with(
            "aria-label",
            format!("{name} in {unit} over time, from {low:.2} to {high:.2}"),
        )
        .children(mark_lines)
        .child(
            Element::new("line")
                .with("class", "zero")
                .with("x1", "0")
                .with("x2", WIDTH.to_string())
                .with("y1", zero.as_str())
                .with("y2", zero),
        )
        .child(Element::new("path").with("d", path).with("stroke", *colour))
        .child(label(10.0, high))
        .child(label(HEIGHT - 2.0, low))
}
