//! The rail: which place of the page is open. On a phone it is a bar at the bottom.

use leptos::prelude::*;
use motorlink_i18n::tr;
use strum::VariantArray;
use wasm_bindgen::JsCast;
use web_sys::{Element, KeyboardEvent};

use crate::{
    model::{
        page::{Page, use_page},
        place::Place,
        snapshot::Session,
    },
    ui::{
        listener::on_window,
        reactive::{effect, memo},
    },
};

/// In the order of the rail, and of the keys Alt+1 to Alt+5.
const PLACES: &[Place] = Place::VARIANTS;

/// The attribute of the root element with the open place, which the style sheet reads.
const ATTRIBUTE: &str = "data-place";

/// In it, the place Record during a replay: it shows the instruments too.
const REPLAY: &str = "replay";

/// The buttons that open a place, by its number.
const OPENS: &str = ".rail-button, .link button";

fn name(place: Place) -> &'static str {
    match place {
        Place::Drive => tr!("Drive" as "place"),
        Place::Record => tr!("Record" as "place"),
        Place::Test => tr!("Test" as "place"),
        Place::Setup => tr!("Setup" as "place"),
        Place::Diagnose => tr!("Diagnose" as "place"),
    }
}

/// A gauge, a dot in a circle, a step response, sliders, a pulse.
const fn icon(place: Place) -> &'static str {
    match place {
        Place::Drive => "M5.6 18.4a9 9 0 1 1 12.8 0M12 14l4-5M12 14h.01",
        Place::Record => "M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18zM12 9a3 3 0 1 0 0 6 3 3 0 0 0 0-6z",
        Place::Test => "M2 17h5l1-9c.5-5 3-5 4 0s2.500 3 3 1 1-2 2-2h5",
        Place::Setup => {
            "M3 8h9M18 8h3M3 16h3M12 16h9M15 5a3 3 0 1 0 0 6 3 3 0 0 0 0-6zM9 13a3 3 0 1 0 0 6 3 3 0 0 0 0-6z"
        }
        Place::Diagnose => "M2 12h4l3-8 6 16 3-8h4",
    }
}

/// Whether something goes on there that the other places do not show.
fn is_working(page: Page, place: Place) -> bool {
    match place {
        Place::Record => page.recorder.recording.with(|status| status.recording),
        Place::Setup => page.shown.with(|session| session.job.is_some()),
        Place::Diagnose => page
            .shown
            .with(|session| session.raw.is_some_and(|raw| raw.running)),
        Place::Drive | Place::Test => false,
    }
}

/// Navigation `Places`. Its buttons are HTML: a view would be many times as large.
#[component]
pub(crate) fn Rail() -> impl IntoView {
    let page = use_page();
    // What is shown, the open place, and those where something goes on.
    let state = memo(move || {
        let open = page.place();
        let replays = page.shown.with(Session::is_recording);
        let shown = match open {
            Place::Record if replays => REPLAY,
            place => place.into_str(),
        };
        let working = PLACES.iter().filter(|place| is_working(page, **place));
        let words = [shown, open.into_str()]
            .into_iter()
            .chain(working.map(Place::into_str));
        words.collect::<Vec<_>>().join(" ")
    });
    effect(move || show(&state.get()));
    let open = move |number: &str| {
        let number = number.parse::<usize>().ok();
        let place = number.and_then(|number| PLACES.get(number.checked_sub(1)?));
        if let Some(place) = place {
            page.open(*place);
            window().scroll_to_with_x_and_y(0.0, 0.0);
        }
        place.is_some()
    };
    on_window("keydown", move |event| {
        if let Some(event) = event.dyn_ref::<KeyboardEvent>()
            && event.alt_key()
            && !(event.ctrl_key() || event.meta_key() || event.shift_key())
            && !untrack(|| page.is_behind_dialog())
            // By the place of the key: some layouts type another character with Alt.
            && event.code().strip_prefix("Digit").is_some_and(open)
        {
            event.prevent_default();
        }
    });
    on_window("click", move |event| {
        let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
        let button = target.and_then(|target| target.closest(OPENS).ok().flatten());
        if let Some(button) = button {
            open(&button.get_attribute("value").unwrap_or_default());
        }
    });
    if let Ok(Some(link)) = document().query_selector(".header .link") {
        // It fails only for invalid positions. The first program has no room for it.
        let _ = link.insert_adjacent_html("beforeend", &link_button());
    }
    view! { <nav class="rail" aria-label=tr!("Places") inner_html=buttons()></nav> }
}

/// Shows the state in the attributes that the style sheet reads.
fn show(state: &str) {
    let mut words = state.split(' ');
    let (shown, open) = (words.next(), words.next());
    let working: Vec<&str> = words.collect();
    // These fail only for invalid names.
    if let Some(root) = document().document_element() {
        let _ = root.set_attribute(ATTRIBUTE, shown.unwrap_or_default());
    }
    let rail = document().query_selector("nav.rail").ok().flatten();
    let mut button = rail.and_then(|rail| rail.first_element_child());
    for place in PLACES.iter().map(Place::into_str) {
        let Some(element) = button else { return };
        let current = if open == Some(place) { "page" } else { "false" };
        let _ = element.set_attribute("aria-current", current);
        let _ = element.toggle_attribute_with_force("data-working", working.contains(&place));
        button = element.next_element_sibling();
    }
}

/// The button over the figures of the link, as HTML. It leads to Diagnose.
fn link_button() -> String {
    let (name, title) = (tr!("Link"), title(5, Place::Diagnose));
    format!(r#"<button type="button" value="5" aria-label="{name}" title="{title}"></button>"#)
}

fn title(number: u8, place: Place) -> String {
    tr!("{place} (Alt+{number})", place = name(place), number)
}

/// The buttons, as HTML: an icon and a word each.
fn buttons() -> String {
    let button = |(number, place)| {
        let (path, name, title) = (icon(place), name(place), title(number, place));
        format!(
            r#"<button type="button" class="rail-button" value="{number}" title="{title}"><svg viewBox="0 0 24 24" width="22" height="22" aria-hidden="true"><path d="{path}" fill="none" stroke="currentColor" stroke-width="1.5" stroke-linecap="round" stroke-linejoin="round"/></svg><span>{name}</span></button>"#
        )
    };
    (1_u8..).zip(PLACES.iter().copied()).map(button).collect()
}
