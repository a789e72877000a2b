//! The crosshair: a line over the graph, and the values in the legend, where they cover no curve.

use std::fmt::Write;

use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement};

use crate::{
    features::graph::plot::{comparison::MOTORS_MAX, trace::Trace},
    ui::{attribute::Attribute, text::Text},
};

/// The content of the graph: two canvases, of which the lower has the axes, and the line of the crosshair.
pub(crate) const PLOT: &str = "<canvas class=\"graph-axes\"></canvas>\
                               <canvas class=\"graph-lines\"></canvas>\
                               <div class=\"graph-cross absent\"></div>\
                               <div class=\"graph-cross second absent\"></div>\
                               <div class=\"graph-zoom\" hidden></div>";

/// The parts of the values: the time, one per trace, and one per compared motor.
pub(crate) fn rows() -> String {
    let mut rows = "<p class=\"graph-when\"></p>".to_owned();
    let mut row = |class: &str, name: &str| {
        // Writing to a string cannot fail.
        let _ = write!(rows, "<p class=\"{class}\"><span>{name} </span><b></b></p>");
    };
    for trace in Trace::ALL {
        row(trace.class(), trace.name());
    }
    for place in 0..MOTORS_MAX {
        row(&motor_class(place), "");
    }
    rows
}

fn move_to(line: &HtmlElement, x: f64) {
    // It fails for invalid names and values; these are valid.
    let _ = line
        .style()
        .set_property("transform", &format!("translateX({})", pixels(x)));
}

fn pixels(length: f64) -> String {
    format!("{}px", length.round())
}

/// The class with the colour of a place.
pub(crate) fn motor_class(place: usize) -> String {
    format!("motor-{place}")
}

/// A value at the crosshair: of a trace, or of the compared motor at a place.
pub(crate) enum CrosshairValue {
    Trace(Trace, String),
    Motor(usize, String),
}

/// The crosshair of a mounted graph.
pub(crate) struct Overlay {
    line: HtmlElement,
    second: HtmlElement,
    /// What a drag encloses.
    zoom: HtmlElement,
    zoomed: Option<[(f64, f64); 2]>,
    values: HtmlElement,
    aloud: Attribute,
    when: Text,
    rows: Vec<Row>,
    /// Which rows are visible; `None` if the crosshair is hidden.
    shown: Option<Vec<bool>>,
}

/// The value of one trace, or of one motor.
struct Row {
    element: HtmlElement,
    name: Text,
    value: Text,
    /// The value in the legend.
    legend: Text,
}

impl Overlay {
    /// Finds the elements; `None` if one is missing.
    pub(crate) fn of(graph: &Element) -> Option<Self> {
        let find = |selector: &str| graph.query_selector(selector).ok().flatten();
        let html = |selector: &str| find(selector)?.dyn_into::<HtmlElement>().ok();
        let traces = Trace::ALL.map(|trace| trace.class().to_owned());
        let motors = (0..MOTORS_MAX).map(motor_class);
        let mut rows = Vec::new();
        for class in traces.into_iter().chain(motors) {
            let element = html(&format!(".graph-values .{class}"))?;
            let part = |name| element.query_selector(name).ok().flatten().map(Text::of);
            let legend = find(&format!(
                ".graph-side label.{class} b, .graph-side li.{class} b"
            ))?;
            rows.push(Row {
                legend: Text::of(legend),
                name: part("span")?,
                value: part("b")?,
                element,
            });
        }
        Some(Self {
            line: html(".graph-cross")?,
            second: html(".graph-cross.second")?,
            zoom: html(".graph-zoom")?,
            zoomed: None,
            values: html(".graph-values")?,
            aloud: Attribute::find(graph, ".graph-values", "aria-live")?,
            when: Text::of(find(".graph-when")?),
            rows,
            shown: None,
        })
    }

    /// Sets the name of the motor at a place.
    pub(crate) fn name(&mut self, place: usize, name: &str) {
        if let Some(row) = self.rows.get_mut(Trace::ALL.len() + place) {
            row.name.set(&format!("{name} "));
        }
    }

    /// Shows the values at a position, in CSS pixels from the left of the graph. Values selected by keys are announced
    /// to screen readers.
    pub(crate) fn show(&mut self, x: f64, when: &str, values: Vec<CrosshairValue>, by_keys: bool) {
        self.aloud
            .set(if by_keys { "polite" } else { "off" }.to_owned());
        self.when.set(when);
        let shown = self.write(values);
        move_to(&self.line, x);
        self.set_shown(Some(shown));
    }

    /// Shows the second cursor at a position in CSS pixels, or hides it.
    pub(crate) fn show_second(&self, x: Option<f64>) {
        // It fails for names with spaces.
        let _ = self
            .second
            .class_list()
            .toggle_with_force("absent", x.is_none());
        if let Some(x) = x {
            move_to(&self.second, x);
        }
    }

    /// Shows what a drag encloses, by two opposite corners in CSS pixels.
    pub(crate) fn show_box(&mut self, corners: Option<[(f64, f64); 2]>) {
        // The browser restyles the page for each write, also of the same value.
        if corners == self.zoomed {
            return;
        }
        self.zoomed = corners;
        self.zoom.set_hidden(corners.is_none());
        if let Some([from, to]) = corners {
            let style = self.zoom.style();
            for (name, from, to) in [("left", from.0, to.0), ("top", from.1, to.1)] {
                let length = if name == "left" { "width" } else { "height" };
                // It fails for invalid names and values; these are valid.
                let _ = style.set_property(name, &pixels(from.min(to)));
                let _ = style.set_property(length, &pixels((to - from).abs()));
            }
        }
    }

    /// Shows these values in the legend, without a crosshair.
    pub(crate) fn show_newest(&mut self, values: Vec<CrosshairValue>) {
        self.write(values);
    }

    pub(crate) fn hide(&mut self) {
        self.set_shown(None);
    }

    /// Writes the values. Returns which rows have one.
    fn write(&mut self, values: Vec<CrosshairValue>) -> Vec<bool> {
        let mut texts = vec![None; self.rows.len()];
        for value in values {
            let (place, text) = match value {
                CrosshairValue::Trace(trace, text) => (trace.place(), text),
                CrosshairValue::Motor(place, text) => (Trace::ALL.len() + place, text),
            };
            if let Some(at) = texts.get_mut(place) {
                *at = Some(text);
            }
        }
        let shown = texts.iter().map(Option::is_some).collect();
        for (row, text) in self.rows.iter_mut().zip(texts) {
            let text = text.unwrap_or_default();
            row.value.set(&text);
            row.legend.set(&text);
        }
        shown
    }

    fn set_shown(&mut self, shown: Option<Vec<bool>>) {
        if self.shown == shown {
            return;
        }
        for element in [&self.line, &self.values] {
            // It fails for names with spaces.
            let _ = element
                .class_list()
                .toggle_with_force("absent", shown.is_none());
        }
        let places = shown.iter().flatten();
        for (row, shown) in self.rows.iter().zip(places) {
            row.element.set_hidden(!shown);
        }
        self.shown = shown;
    }
}
