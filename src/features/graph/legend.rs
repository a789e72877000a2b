//! The choice of what to compare across motors, and the legend of the motors' colours.

use std::fmt::Write;

use leptos::prelude::*;
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement, HtmlInputElement};

use crate::features::graph::{
    plot::{
        comparison::{COMPARABLE, Comparison, MOTORS_MAX},
        palette::{Colour, parse_colour},
        trace::Trace,
    },
    text::Text,
};

/// The class with the colour of a place.
pub(crate) fn class(place: usize) -> String {
    format!("motor-{place}")
}

/// The list of what can be compared, and the legend: one item per place, and one for the motors without a place.
pub(crate) fn markup(compared: Option<Trace>) -> String {
    let (compare, off) = (tr!("Compare"), tr!("Compare: off"));
    let hint = tr!("Plots one trace for every motor with data");
    let mut html = format!(
        "<label class=\"graph-compare\"><span aria-hidden=\"true\">{compare}</span>\
         <select class=\"select\" aria-label=\"{compare}\" title=\"{hint}\">\
         <option value=\"\">{off}</option>"
    );
    for trace in COMPARABLE {
        let (class, name) = (trace.class(), trace.name());
        let mark = if compared == Some(trace) {
            " selected"
        } else {
            ""
        };
        // Writing to a string cannot fail.
        let _ = write!(html, "<option value=\"{class}\"{mark}>{name}</option>");
    }
    let legend = tr!("Motors compared");
    let _ = write!(
        html,
        "</select></label>\
         <ul hidden class=\"graph-legend\" role=\"list\" aria-label=\"{legend}\">"
    );
    for place in 0..MOTORS_MAX {
        let class = class(place);
        let _ = write!(html, "<li class=\"{class}\" hidden><span></span></li>");
    }
    html + "<li hidden><span></span></li></ul>"
}

/// The legend of a mounted graph, and the switches of the traces, which have no effect while it is shown.
pub(crate) struct Legend {
    head: Element,
    list: HtmlElement,
    items: Vec<(HtmlElement, Text)>,
    more: (HtmlElement, Text),
    boxes: Vec<HtmlInputElement>,
}

impl Legend {
    /// Finds the parts; `None` if the panel does not contain them.
    pub(crate) fn of(panel: &Element) -> Option<Self> {
        let list: HtmlElement = panel
            .query_selector(".graph-legend")
            .ok()??
            .dyn_into()
            .ok()?;
        let mut items = Vec::new();
        let mut next = list.first_element_child();
        while let Some(item) = next {
            next = item.next_element_sibling();
            let text = Text::of(item.first_element_child()?);
            items.push((item.dyn_into().ok()?, text));
        }
        let more = items.pop()?;
        let mut boxes = Vec::new();
        for trace in Trace::ALL {
            let selector = format!(".graph-trace.{} input", trace.class());
            boxes.push(panel.query_selector(&selector).ok()??.dyn_into().ok()?);
        }
        Some(Self {
            head: panel.query_selector(".graph-head").ok()??,
            list,
            items,
            more,
            boxes,
        })
    }

    /// The colours of compared motors in the current theme.
    pub(crate) fn motor_colours(&self) -> [Colour; MOTORS_MAX] {
        let mut colours = [Colour::default(); MOTORS_MAX];
        for (place, (item, _)) in colours.iter_mut().zip(&self.items) {
            let style = window().get_computed_style(item).ok().flatten();
            let colour = style.and_then(|style| style.get_property_value("color").ok());
            *place = parse_colour(&colour.unwrap_or_default());
        }
        colours
    }

    /// Shows the compared motors, or nothing.
    pub(crate) fn show(&mut self, comparison: Option<&Comparison>, names: &[(usize, String)]) {
        self.list.set_hidden(comparison.is_none());
        // It fails for names with spaces.
        let _ = self
            .head
            .class_list()
            .toggle_with_force("compares", comparison.is_some());
        for checkbox in &self.boxes {
            checkbox.set_disabled(comparison.is_some());
            checkbox.set_title(comparison.map_or("", |_| {
                tr!("While comparing motors, only the selected trace is shown.")
            }));
        }
        for (place, (item, text)) in self.items.iter_mut().enumerate() {
            let name = names.iter().find(|(of, _)| *of == place);
            item.set_hidden(name.is_none());
            text.set(name.map(|(_, name)| name.clone()).unwrap_or_default());
        }
        let more = comparison.and_then(Comparison::more);
        self.more.0.set_hidden(more.is_none());
        self.more.1.set(more.unwrap_or_default());
    }
}
