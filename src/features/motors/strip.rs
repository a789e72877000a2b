//! Region `Motors`: an overview of all found motors, and whether the motor or the group is driven.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::MotorId;
use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement, HtmlInputElement};

use crate::{
    features::motors::chips::{FIGURES, Figure, chips_html, figures},
    model::{
        names_and_sides::NamesAndSides,
        page::{Page, use_page},
        place::Place,
        snapshot::Session,
    },
    ui::{
        attribute::Attribute,
        list::replace_keeping_focus,
        reactive::{effect, handler, memo},
        text::Text,
    },
};

const CHIPS: &str = "motor-chips";
const CHOICE: &str = "drive-choice";

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
    offer_group(page, found);
    write_titles(page, found);
    // HTML: views of these elements would be many times as large.
    view! {
        <section
            class="motor-strip"
            aria-label=tr!("Motors")
            on:click=handler(move |event| page.click_in_list(&event))
            on:change=handler(move |event| page.group.set(event_target_value(&event) == "true"))
            inner_html=content()
        ></section>
    }
}

/// Radiogroup `Drive` with `Motor` and `Group`, and the place of the chips.
fn content() -> String {
    let radio = |(group, name)| {
        format!(
            r#"<label><input type="radio" name="drive-choice" value="{group}"><span>{name}</span></label>"#
        )
    };
    let radios = [(false, tr!("Motor")), (true, tr!("Group"))].map(radio);
    let name = tr!("Drive" as "place");
    let motors = tr!("Motors");
    format!(
        r#"<div id="{CHOICE}" role="radiogroup" aria-label="{name}" hidden>{}</div><div class="motor-chips" id="{CHIPS}" role="list" aria-label="{motors}"></div>"#,
        radios.concat()
    )
}

/// Writes the selected motor into the titles of the wheel and of the read-outs, where there are several motors.
fn write_titles(page: Page, found: Memo<Vec<MotorId>>) {
    effect(move || {
        let id = page.selected.get();
        let is_one_of_many = found.with(|found| found.len() > 1);
        // The name is shown whole or not at all: two names may begin with the same word.
        let title = page
            .motors
            .names
            .with(|names| format!("{id} {}", names.name(id).replace(' ', "\u{A0}")));
        // The words of the wheel follow its ID. A name would lie over the ring.
        let [title, id] = if is_one_of_many {
            [title.trim_end(), &format!("{id} · ")]
        } else {
            [""; 2]
        };
        // Written here, so that the first part of the page needs no code for names.
        let titles = document().get_elements_by_class_name("motor-title");
        for element in (0..titles.length()).filter_map(|place| titles.item(place)) {
            let is_wheel = element.closest(".wheel-chip").ok().flatten().is_some();
            element.set_text_content(Some(if is_wheel { id } else { title }));
        }
    });
}

/// Offers the group from two motors on, found or in the group.
fn offer_group(page: Page, found: Memo<Vec<MotorId>>) {
    let is_one = memo(move || {
        let members = page.motors.names.with(NamesAndSides::group_members);
        found.with(|found| {
            let unseen = members.iter().filter(|(id, _)| !found.contains(id));
            found.len() + unseen.count() < 2
        })
    });
    effect(move || {
        if is_one.get() {
            page.group.set(false);
        }
        let class = match page.place() {
            Place::Drive => "drive-choice",
            _ => "drive-choice absent",
        };
        if let Some(choice) = document().get_element_by_id(CHOICE) {
            // These fail only for invalid names.
            let _ = choice.set_attribute("class", class);
            let _ = choice.toggle_attribute_with_force("hidden", is_one.get());
        }
        let chosen = format!("#{CHOICE} [value={}]", page.group.get());
        let radio = document().query_selector(&chosen).ok().flatten();
        if let Some(radio) = radio.and_then(|radio| radio.dyn_into::<HtmlInputElement>().ok()) {
            radio.set_checked(true);
        }
    });
}

/// The present chips and their values.
#[derive(Default)]
struct Chips {
    html: String,
    chips: Vec<(MotorId, [Option<Value>; 5])>,
}

/// The text of a value, and its look.
struct Value {
    text: Text,
    look: Attribute,
}

impl Chips {
    fn make(row: &HtmlElement, html: &str, found: &[MotorId]) -> Self {
        replace_keeping_focus(row, html, "value");
        let chip = |id: &MotorId| {
            let number = id.get();
            let places = FIGURES.map(|name| {
                let selector = format!("[value='{number}'] ~ [data-figure='{name}']");
                let element = row.query_selector(&selector).ok().flatten();
                element.map(Value::of)
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
                if let Some(value) = place {
                    value.write(&figure);
                }
            }
        }
    }
}

impl Value {
    fn of(element: Element) -> Self {
        Self {
            text: Text::of(element.clone()),
            look: Attribute::of(element, "data-look"),
        }
    }

    fn write(&mut self, figure: &Figure) {
        self.text.set(&figure.text);
        self.look.set(figure.look.to_owned());
    }
}
