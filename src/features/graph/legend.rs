//! The legend, which is the read-out too: the traces of the motor or the compared motors, with their values. And the
//! choice of what to compare.

use std::fmt::Write;

use leptos::prelude::*;
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement, HtmlInputElement};

use crate::{
    features::graph::{
        overlay,
        plot::{
            comparison::{COMPARABLE, Comparison, MOTORS_MAX},
            palette::{Colour, parse_colour},
            trace::Trace,
        },
        state::Chart,
    },
    ui::{
        reactive::{dynamic, handler},
        text::Text,
    },
};

/// The list of what can be compared.
pub(crate) fn choice(compared: Option<Trace>) -> String {
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
    html + "</select></label>"
}

/// The compared motors: one item per place, and one for the motors without a place.
fn motors() -> String {
    let legend = tr!("Motors compared");
    let mut html =
        format!("<ul hidden class=\"graph-legend\" role=\"list\" aria-label=\"{legend}\">");
    for place in 0..MOTORS_MAX {
        let class = overlay::motor_class(place);
        // Writing to a string cannot fail.
        let _ = write!(
            html,
            "<li class=\"{class}\" hidden><span></span><b aria-hidden=\"true\"></b></li>"
        );
    }
    html + "<li hidden><span></span></li></ul>"
}

/// The motor that the graph shows; nothing while it compares all of them.
pub(crate) fn title(chart: Chart) -> String {
    chart.page.motors.names.track();
    let id = chart.page.selected.get();
    let compares = chart.traces.with(|traces| traces.compared.is_some());
    if compares {
        String::new()
    } else {
        chart.motor_name(id)
    }
}

/// The legend: the motor, and the switch of each trace or the compared motors, with their values at the crosshair; at the
/// newest reply without one.
#[component]
pub(crate) fn LegendPanel(chart: Chart) -> impl IntoView {
    view! {
        <div class="graph-side">
            <p class="graph-of">{dynamic(move || title(chart))}</p>
            <div class="graph-traces" role="group" aria-label=tr!("Traces")>
                <Switch chart trace=Trace::Speed />
                <Switch chart trace=Trace::Current />
                <Switch chart trace=Trace::Goal />
                <Switch chart trace=Trace::Temperature />
                <Switch chart trace=Trace::Position />
            </div>
            <div class="graph-motors" inner_html=motors()></div>
            // Outside of the img: screen readers do not read its content.
            <output
                class="graph-values absent"
                aria-label=tr!("Crosshair")
                aria-live="off"
                aria-atomic="true"
                inner_html=overlay::rows()
            ></output>
        </div>
    }
}

/// The switch of a trace, with its value.
#[component]
fn Switch(chart: Chart, trace: Trace) -> impl IntoView {
    let traces = chart.traces;
    let (name, rest) = trace.name_in_parts();
    view! {
        <label class=format!("graph-trace {}", trace.class())>
            <input
                type="checkbox"
                aria-label=trace.switch_name()
                prop:checked=dynamic(move || traces.get().has(trace))
                on:change=handler(move |event| {
                    let on = event_target_checked(&event);
                    traces.update(|traces| *traces = traces.with(trace, on));
                    chart.wake();
                })
            />
            <span>{name}<span class="graph-rest">{rest}</span></span>
            // The status `Crosshair` says it.
            <b aria-hidden="true"></b>
        </label>
    }
}

/// The legend of a mounted graph, and the switches of the traces, which have no effect while it is shown.
pub(crate) struct Legend {
    side: Element,
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
            side: panel.query_selector(".graph-side").ok()??,
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
            .side
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
            text.set(name.map_or("", |(_, name)| name));
        }
        let more = comparison.and_then(Comparison::more);
        self.more.0.set_hidden(more.is_none());
        self.more.1.set(&more.unwrap_or_default());
    }
}
