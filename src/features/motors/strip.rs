//! Region `Motors`: an overview of all found motors, and the buttons that concern all of them.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::MotorId;
use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement};

use crate::{
    features::motors::chips::{FIGURES, Figure, chips_html, figures},
    model::{page::use_page, snapshot::Session},
    ui::{
        drawer::{Drawer, toggle},
        list::replace_keeping_focus,
        reactive::{dynamic, handler, memo},
    },
};

const CHIPS: &str = "motor-chips";

/// Region `Motors`.
#[component]
pub(crate) fn MotorStrip() -> impl IntoView {
    let page = use_page();
    let found = memo(move || page.shown.with(Session::found));
    let html = memo(move || {
        let selected = page.selected.get();
        let names = page.motors.names;
        found.with(|found| names.with(|names| chips_html(found, names, selected)))
    });
    // The chips are created when the set of motors changes; their values are written into them.
    Effect::new(move |before: Option<Chips>| {
        let mut chips = before.unwrap_or_default();
        let row = document().get_element_by_id(CHIPS);
        if let Some(row) = row.and_then(|row| row.dyn_into::<HtmlElement>().ok()) {
            html.with(|html| {
                if chips.html != *html {
                    chips = found.with(|found| Chips::make(&row, html, found));
                }
            });
            page.shown.with(|session| chips.write(session));
        }
        chips
    });
    view! {
        <section class="motor-strip" aria-label=tr!("Motors")>
            <div
                class="motor-chips"
                id=CHIPS
                on:click=handler(move |event| page.click_in_list(&event))
            ></div>
            <div class="motor-strip-end">
                <DrawerButton which=Drawer::Together label=tr!("Drive together") />
                <DrawerButton which=Drawer::Link label=tr!("Link") />
                <DrawerButton which=Drawer::Experiments label=tr!("Experiments") />
                <DrawerButton which=Drawer::Session label=tr!("Session file") />
                <DrawerButton which=Drawer::Settings label=tr!("Settings") />
            </div>
        </section>
    }
}

/// The present chips and their values.
#[derive(Default)]
struct Chips {
    html: String,
    chips: Vec<(MotorId, [Place; 5])>,
}

/// The element of a value.
#[derive(Default)]
struct Place {
    element: Option<Element>,
    written: Figure,
}

impl Chips {
    fn make(row: &HtmlElement, html: &str, found: &[MotorId]) -> Self {
        replace_keeping_focus(row, html, "value");
        let chip = |id: &MotorId| {
            let number = id.get();
            let places = FIGURES.map(|name| {
                let selector = format!("[value='{number}'] ~ [data-figure='{name}']");
                Place {
                    element: row.query_selector(&selector).ok().flatten(),
                    written: Figure::default(),
                }
            });
            (*id, places)
        };
        Self {
            html: html.to_owned(),
            chips: found.iter().map(chip).collect(),
        }
    }

    fn write(&mut self, session: &Session) {
        for (id, places) in &mut self.chips {
            for (place, figure) in places.iter_mut().zip(figures(session, *id)) {
                place.write(figure);
            }
        }
    }
}

impl Place {
    fn write(&mut self, figure: Figure) {
        let Some(element) = &self.element else { return };
        if self.written.text != figure.text {
            element.set_text_content(Some(&figure.text));
        }
        if self.written.look != figure.look {
            // It fails only for invalid names.
            let _ = element.set_attribute("data-look", figure.look);
        }
        self.written = figure;
    }
}

/// Opens and closes a panel of the drawer.
#[component]
fn DrawerButton(which: Drawer, label: &'static str) -> impl IntoView {
    let page = use_page();
    let is_open = move || page.drawer.get() == Some(which);
    view! {
        <button
            type="button"
            class="button small"
            aria-expanded=dynamic(move || if is_open() { "true" } else { "false" })
            on:click=handler(move |_| toggle(page.drawer, which))
        >
            {label}
        </button>
    }
}
