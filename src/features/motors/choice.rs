//! The selection of the motor and its model.

use std::fmt::Write;

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::{MotorId, family::Model};
use web_sys::HtmlSelectElement;

use crate::{
    model::{motor_model::choice_blocked_by, page::use_page, snapshot::Session},
    ui::reactive::{dynamic, handler, memo},
};

/// Combobox `Motor`: first the motors that have answered, then every other ID.
#[component]
pub(crate) fn MotorChoice() -> impl IntoView {
    let page = use_page();
    let found = memo(move || page.shown.with(Session::found));
    // A browser styles each of 254 options, which would delay the start of the page.
    let wanted = RwSignal::new(false);
    view! {
        <label class="labelled">
            <span class="label" aria-hidden="true">
                {tr!("Motor")}
            </span>
            <select
                aria-label=tr!("Motor")
                class="select motor-select"
                inner_html=dynamic(move || options(&found.get(), page.selected.get(), wanted.get()))
                on:pointerdown=handler(move |_| wanted.set(true))
                on:focus=handler(move |_| wanted.set(true))
                on:change=handler(move |event| {
                    if let Ok(id) = event_target_value(&event).parse() {
                        page.choose(id);
                    }
                })
            ></select>
        </label>
    }
}

/// The list as HTML, with every ID or only those needed while it is closed. As a view, each of 254 options would be
/// reactive.
fn options(found: &[MotorId], selected: MotorId, every: bool) -> String {
    let others = MotorId::all().filter(|id| !found.contains(id) && (every || *id == selected));
    let mut html = String::new();
    if !found.is_empty() {
        push_group(&mut html, tr!("Found"), found.iter().copied(), selected);
    }
    push_group(&mut html, tr!("All IDs"), others, selected);
    html
}

fn push_group(
    html: &mut String,
    label: &str,
    ids: impl Iterator<Item = MotorId>,
    selected: MotorId,
) {
    let _ = write!(html, "<optgroup label=\"{label}\">");
    for id in ids {
        let number = id.get();
        let mark = if id == selected { " selected" } else { "" };
        let _ = write!(
            html,
            "<option value=\"{number}\"{mark}>{id} · {number}</option>"
        );
    }
    html.push_str("</optgroup>");
}

/// Combobox `Model`.
#[component]
pub(crate) fn ModelChoice() -> impl IntoView {
    let page = use_page();
    let disabled_reason = page.of_motor(|session, _| choice_blocked_by(session));
    let key = move || page.model.get().spec().key;
    view! {
        <label class="labelled">
            <span class="label" aria-hidden="true">
                {tr!("Model")}
            </span>
            <select
                aria-label=tr!("Model")
                class="select model-select"
                title=disabled_reason
                disabled=dynamic(move || disabled_reason.with(Option::is_some))
                inner_html=Model::ALL.map(model_option).concat()
                // After the options, because it selects one of them.
                prop:value=dynamic(key)
                on:change=handler(move |event| {
                    let chosen = event_target_value(&event).parse::<Model>();
                    if !chosen.is_ok_and(|model| page.choose_model(model)) {
                        event_target::<HtmlSelectElement>(&event).set_value(untrack(key));
                    }
                })
            ></select>
        </label>
    }
}

/// `DDSM115 / M0601`
fn model_option(model: Model) -> String {
    let spec = model.spec();
    format!(
        "<option value=\"{}\">{} / {}</option>",
        spec.key, spec.name, spec.maker_name
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motors_that_answered_come_first_and_every_id_is_there_once() {
        let two = MotorId::new(2).unwrap();
        let html = options(&[two], MotorId::FIRST, true);
        let found = "<optgroup label=\"Found\"><option value=\"2\">0x02 · 2</option></optgroup>";
        assert!(html.starts_with(found), "{html}");
        assert!(html.contains("<option value=\"1\" selected>0x01 · 1</option>"));
        assert_eq!(html.matches("<option ").count(), 254);
        assert_eq!(html.matches(" selected").count(), 1);
        assert!(!options(&[], two, true).contains("Found"));
        // A closed list shows one option.
        let closed = options(&[two], MotorId::FIRST, false);
        assert_eq!(closed.matches("<option ").count(), 2);
        assert_eq!(closed.matches(" selected").count(), 1);
    }
}
