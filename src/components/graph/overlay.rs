//! The crosshair: a line over the graph, and a box of one size with the values at it.

use std::fmt::Write;

use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement};

use crate::{
    attribute::Attribute,
    graph::{
        crosshair::Values,
        trace::{Trace, Traces},
    },
};

/// Between the line and the box, in pixels of the style sheet.
const BESIDE: f64 = 12.0;

/// What stands in the img: the canvases, the lower one with axes, and the crosshair's line.
pub(super) const PLOT: &str = "<canvas class=\"graph-axes\"></canvas>\
                               <canvas class=\"graph-lines\"></canvas>\
                               <div class=\"graph-cross absent\"></div>";

/// The rows of the box with the values: the time, and one for each trace.
pub(super) fn rows() -> String {
    let mut rows = "<p class=\"graph-when\"></p>".to_owned();
    for trace in Trace::ALL {
        let (class, name) = (trace.class(), trace.name());
        // Writing to a string cannot fail.
        let _ = write!(rows, "<p class=\"{class}\"><span>{name} </span><b></b></p>");
    }
    rows
}

/// One text of the page, written only when it changes.
pub(super) struct Text {
    element: Element,
    written: String,
}

impl Text {
    pub(super) fn of(element: Element) -> Self {
        Self {
            element,
            written: String::new(),
        }
    }

    pub(super) fn set(&mut self, text: String) {
        if self.written != text {
            self.element.set_text_content(Some(&text));
            self.written = text;
        }
    }
}

/// The crosshair of a mounted graph.
pub(super) struct Overlay {
    line: HtmlElement,
    values: HtmlElement,
    /// How wide the box is, in pixels of the style sheet. It changes with the style sheet only.
    values_width: f64,
    aloud: Attribute,
    when: Text,
    rows: Vec<Row>,
    shown: Option<Traces>,
}

/// The value of one trace.
struct Row {
    trace: Trace,
    element: HtmlElement,
    value: Text,
}

impl Overlay {
    /// Finds the parts; `None` where the element does not hold them.
    pub(super) fn of(graph: &Element) -> Option<Self> {
        let find = |selector: &str| graph.query_selector(selector).ok().flatten();
        let html = |selector: &str| find(selector)?.dyn_into::<HtmlElement>().ok();
        let mut rows = Vec::new();
        for trace in Trace::ALL {
            let row = html(&format!(".graph-values .{}", trace.class()))?;
            let value = Text::of(row.query_selector("b").ok().flatten()?);
            rows.push(Row {
                trace,
                element: row,
                value,
            });
        }
        Some(Self {
            line: html(".graph-cross")?,
            values: html(".graph-values")?,
            values_width: 0.0,
            aloud: Attribute::find(graph, ".graph-values", "aria-live")?,
            when: Text::of(find(".graph-when")?),
            rows,
            shown: None,
        })
    }

    /// The graph has another size, and its box perhaps too.
    pub(super) fn measure(&mut self) {
        self.values_width = f64::from(self.values.offset_width());
    }

    /// Shows the values at a place, in pixels of the style sheet from the left of a graph of this
    /// width. Values that keys have brought here are read aloud.
    pub(super) fn show(
        &mut self,
        (x, width): (f64, f64),
        when: String,
        values: &Values,
        traces: Traces,
        by_keys: bool,
    ) {
        self.aloud
            .set(if by_keys { "polite" } else { "off" }.to_owned());
        self.when.set(when);
        for row in &mut self.rows {
            row.value.set(values.text(row.trace));
        }
        // On the side with more room, and never out of the graph.
        let left = if x > width / 2.0 {
            x - BESIDE - self.values_width
        } else {
            x + BESIDE
        };
        place(&self.line, x);
        place(
            &self.values,
            left.clamp(0.0, (width - self.values_width).max(0.0)),
        );
        self.set_shown(Some(traces));
    }

    pub(super) fn hide(&mut self) {
        self.set_shown(None);
    }

    fn set_shown(&mut self, shown: Option<Traces>) {
        if self.shown == shown {
            return;
        }
        self.shown = shown;
        for element in [&self.line, &self.values] {
            // It fails for names with spaces.
            let _ = element
                .class_list()
                .toggle_with_force("absent", shown.is_none());
        }
        for row in &self.rows {
            row.element
                .set_hidden(!shown.is_some_and(|traces| traces.has(row.trace)));
        }
    }
}

fn place(element: &HtmlElement, x: f64) {
    let whole = x.round();
    // It fails for names and values that are none, and these are ours.
    let _ = element
        .style()
        .set_property("transform", &format!("translateX({whole}px)"));
}
