//! The controls of the filter, and whether the list follows the newest.

use std::{fmt::Write, time::Duration};

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{protocol::MotorId, recorder::Kind};
use wasm_bindgen::JsCast;
use web_sys::{HtmlInputElement, KeyboardEvent};

use crate::{
    features::packet_log::actions::Log,
    model::{recorder_texts::no_recorder, snapshot::Session},
    ui::reactive::{dynamic, handler, memo},
};

/// A filter is sent after this pause in typing, because each one filters a million entries.
const TYPED_OUT: Duration = Duration::from_millis(150);

/// The kinds as the list `Log direction` has them. The value of each is its place.
const KINDS: [Option<Kind>; 5] = [
    None,
    Some(Kind::Tx),
    Some(Kind::Rx),
    Some(Kind::System),
    Some(Kind::Error),
];

fn kind_name(kind: Option<Kind>) -> &'static str {
    match kind {
        None => tr!("All"),
        Some(Kind::Tx) => "TX",
        Some(Kind::Rx) => "RX",
        Some(Kind::System) => tr!("System"),
        Some(Kind::Error) => tr!("Error"),
    }
}

/// Searchbox `Filter`, comboboxes `Log ID` and `Log direction`, checkboxes `Collapse status polls`
/// and `Auto-scroll`.
#[component]
pub(crate) fn Filters(log: Log) -> impl IntoView {
    let page = log.page;
    let found = memo(move || page.shown.with(Session::found));
    // The controls show the present filter when they are created again.
    let filter = log.feed.with_value(|feed| feed.filter().clone());
    let id = RwSignal::new(filter.id);
    let typed = StoredValue::new(0_u32);
    let collapse = move || page.preferences.with(|chosen| chosen.collapse_polls);
    let following = memo(move || log.state.with(|state| state.following));
    let stopped = move || !page.recorder.alive.get();
    let title = |hint: &'static str| dynamic(move || if stopped() { no_recorder() } else { hint });
    view! {
        <div class="packet-filters">
            <input
                type="search"
                class="packet-filter"
                aria-label=tr!("Filter")
                placeholder=tr!("Filter")
                title=title(tr!("Searches time, ID, hex bytes and meaning"))
                prop:value=filter.text
                autocomplete="off"
                spellcheck="false"
                disabled=dynamic(stopped)
                on:input=handler(move |event| type_in(log, typed, event_target_value(&event)))
                on:keydown=handler(move |event| clear_on_escape(log, typed, &event))
            />
            <select
                class="select"
                aria-label=tr!("Log ID")
                title=title(tr!("Filter by motor"))
                disabled=dynamic(stopped)
                inner_html=dynamic(move || id_options(&found.get(), id.get()))
                on:change=handler(move |event| {
                    let chosen = event_target_value(&event).parse().ok();
                    id.set(chosen);
                    log.refilter(|filter| filter.id = chosen);
                })
            ></select>
            <select
                class="select"
                aria-label=tr!("Log direction")
                title=title(tr!("Filter by type"))
                disabled=dynamic(stopped)
                inner_html=kind_options(filter.kind)
                on:change=handler(move |event| {
                    let chosen = kind_at(&event_target_value(&event));
                    log.refilter(|filter| filter.kind = chosen);
                })
            ></select>
            <label
                class="check"
                title=tr!("Hides queries, unchanged drive frames and their valid replies")
            >
                <input
                    type="checkbox"
                    prop:checked=dynamic(collapse)
                    on:change=handler(move |event| {
                        let checked = event_target_checked(&event);
                        page.prefer(|preferences| preferences.collapse_polls = checked);
                        log.refilter(|filter| filter.collapse = checked);
                    })
                />
                {tr!("Collapse status polls")}
            </label>
            <label class="check" title=tr!("Keeps the newest entries in view")>
                <input
                    type="checkbox"
                    prop:checked=dynamic(move || following.get())
                    on:change=handler(move |event| log.follow(event_target_checked(&event)))
                />
                {tr!("Auto-scroll")}
            </label>
        </div>
    }
}

/// Clears the text, as Chromium does by itself and Firefox does not. An Escape that stops is not for the filter.
fn clear_on_escape(log: Log, typed: StoredValue<u32>, event: &KeyboardEvent) {
    let target = event.target();
    let field = target.and_then(|field| field.dyn_into::<HtmlInputElement>().ok());
    if let Some(field) = field
        && event.key() == "Escape"
        && !event.default_prevented()
        && !field.value().is_empty()
    {
        field.set_value("");
        type_in(log, typed, String::new());
    }
}

/// Sends the text after a pause in typing.
fn type_in(log: Log, typed: StoredValue<u32>, text: String) {
    let Some(mine) = typed.try_update_value(|count| {
        *count = count.wrapping_add(1);
        *count
    }) else {
        return;
    };
    set_timeout(
        move || {
            if typed.try_get_value() == Some(mine) {
                log.refilter(|filter| filter.text = text);
            }
        },
        TYPED_OUT,
    );
}

/// All, the motors that have answered, and the selected one.
fn id_options(found: &[MotorId], chosen: Option<MotorId>) -> String {
    let mut html = format!("<option value=\"\">{}</option>", tr!("All IDs"));
    let gone = chosen.filter(|id| !found.contains(id));
    for id in found.iter().copied().chain(gone) {
        let mark = if Some(id) == chosen { " selected" } else { "" };
        let _ = write!(html, "<option value=\"{}\"{mark}>{id}</option>", id.get());
    }
    html
}

fn kind_options(chosen: Option<Kind>) -> String {
    let mut html = String::new();
    for (place, kind) in KINDS.into_iter().enumerate() {
        let mark = if kind == chosen { " selected" } else { "" };
        let name = kind_name(kind);
        let _ = write!(html, "<option value=\"{place}\"{mark}>{name}</option>");
    }
    html
}

fn kind_at(place: &str) -> Option<Kind> {
    KINDS.get(place.parse::<usize>().ok()?).copied().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chosen_motor_stays_in_the_list_when_it_is_gone() {
        let two = MotorId::new(2).unwrap();
        let html = id_options(&[MotorId::FIRST], Some(two));
        assert!(html.starts_with("<option value=\"\">All IDs</option><option value=\"1\">0x01<"));
        assert!(html.ends_with("<option value=\"2\" selected>0x02</option>"));
        assert_eq!(id_options(&[two], Some(two)).matches("0x02").count(), 1);
    }

    #[test]
    fn every_kind_is_named_once() {
        let html = kind_options(Some(Kind::System));
        for (place, kind) in KINDS.into_iter().enumerate() {
            assert_eq!(kind_at(&place.to_string()), kind);
            assert!(html.contains(&format!(">{}</option>", kind_name(kind))));
        }
        assert_eq!(html.matches("<option ").count(), 5);
        assert!(html.contains("<option value=\"3\" selected>System<"));
    }
}
