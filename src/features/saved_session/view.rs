//! The saved session among the notices, with buttons `Restore session` and `Delete session`. As HTML, it is a
//! tenth of the size of a view.

use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{Element, Event};

use crate::{
    features::saved_session::{actions::SavedSession, offer::Offer, texts},
    ui::{
        clock::{page_now_ms, page_origin_ms},
        listener::on_window,
        reactive::{dynamic, effect},
    },
};

const RESTORE: &str = "restore-session";
const FORGET: &str = "forget-session";
const LEAVE: &str = "leave-session";
const SAID: &str = "kept-words";

/// Status `Previous session` and its buttons.
fn markup() -> String {
    [
        r#"<p class="notice-title">"#,
        tr!("Previous session"),
        r#"</p><p class="notice-advice" role="status" aria-label=""#,
        tr!("Previous session"),
        r#"" id="kept-words"></p><button type="button" class="button small" "#,
        r#"id="restore-session" title=""#,
        tr!("Adds it before this session in log and recording; no motor starts"),
        r#"">"#,
        tr!("Restore session"),
        r#"</button> <button type="button" class="button small" id="forget-session">"#,
        tr!("Delete session"),
        r#"</button><button type="button" class="dismiss" aria-label=""#,
        tr!("Dismiss previous session"),
        r#"" title=""#,
        tr!("Hides the offer; the session stays stored"),
        r#"" id="leave-session"></button>"#,
    ]
    .concat()
}

/// Whether no session is offered, or something is looked at that the offer would cover.
pub(crate) fn is_hidden(saved: SavedSession) -> bool {
    saved.offer.with(|offer| *offer == Offer::None)
        || saved
            .page
            .shown
            .with(|session| session.is_recording() || session.active_motors().next().is_some())
}

/// The offer, among the notices.
#[component]
pub(crate) fn SavedSessionNotice(saved: SavedSession) -> impl IntoView {
    attach_handlers(saved);
    view! {
        <div
            class="notice kept"
            hidden=dynamic(move || is_hidden(saved))
            inner_html=markup()
        ></div>
    }
}

/// Attaches the updates and the handlers of the buttons.
fn attach_handlers(saved: SavedSession) {
    on_window("click", move |event| on_event(saved, &event));
    effect(move || {
        let offer = saved.offer.get();
        if let Some(said) = document().get_element_by_id(SAID) {
            let now_ms = page_origin_ms() + page_now_ms();
            said.set_text_content(Some(&texts::of_offer(&offer, now_ms)));
        }
        for id in [RESTORE, FORGET, LEAVE] {
            if let Some(button) = document().get_element_by_id(id) {
                let is_open = matches!(offer, Offer::Open(_));
                let _ = button.toggle_attribute_with_force("disabled", !is_open);
            }
        }
    });
}

fn on_event(saved: SavedSession, event: &Event) {
    let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let id = target.map(|target| target.id()).unwrap_or_default();
    let act: fn(SavedSession) = match id.as_str() {
        RESTORE => SavedSession::restore,
        FORGET => SavedSession::forget,
        LEAVE => |saved| saved.offer.set(Offer::None),
        _ => return,
    };
    // In the next turn: a button must not be hidden while it is being pressed.
    spawn_local(async move { act(saved) });
}
