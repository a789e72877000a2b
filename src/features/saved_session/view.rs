//! The session that the browser keeps, among the notices, with buttons `Restore session` and
//! `Forget session`. As HTML, it weighs a tenth of a view.

use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{Element, Event};

use crate::{
    features::saved_session::{actions::Offer, texts as words},
    link::clock::{page_now_ms, page_origin_ms},
    model::desk::Desk,
    ui::{listener::on_window, reactive::follow},
};

const RESTORE: &str = "restore-session";
const FORGET: &str = "forget-session";
const LEAVE: &str = "leave-session";
const SAID: &str = "kept-words";

/// Status `Kept session`, and what can be done with it.
pub(crate) fn markup() -> String {
    [
        r#"<p class="notice-title">"#,
        tr!("Kept session"),
        r#"</p><p class="notice-advice" role="status" aria-label=""#,
        tr!("Kept session"),
        r#"" id="kept-words"></p><button type="button" class="button small" "#,
        r#"id="restore-session" title=""#,
        tr!("It stands before this one in log and recording; nothing is driven"),
        r#"">"#,
        tr!("Restore session"),
        r#"</button> <button type="button" class="button small" id="forget-session">"#,
        tr!("Forget session"),
        r#"</button><button type="button" class="dismiss" aria-label=""#,
        tr!("Dismiss kept session"),
        r#"" title=""#,
        tr!("It stays kept, and is offered again"),
        r#"" id="leave-session"></button>"#,
    ]
    .concat()
}

/// Has it show what there is, and its buttons work, from now on.
pub(crate) fn keep_working(desk: Desk) {
    on_window("click", move |event| hear(desk, &event));
    follow(move || {
        let offer = desk.recorder.kept.get();
        if let Some(said) = document().get_element_by_id(SAID) {
            let now_ms = page_origin_ms() + page_now_ms();
            said.set_text_content(Some(&words::of_offer(&offer, now_ms)));
        }
        for id in [RESTORE, FORGET, LEAVE] {
            if let Some(button) = document().get_element_by_id(id) {
                let is_open = matches!(offer, Offer::Open(_));
                let _ = button.toggle_attribute_with_force("disabled", !is_open);
            }
        }
    });
}

fn hear(desk: Desk, event: &Event) {
    let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let id = target.map(|target| target.id()).unwrap_or_default();
    let act: fn(Desk) = match id.as_str() {
        RESTORE => Desk::restore_session,
        FORGET => Desk::forget_session,
        LEAVE => |desk| desk.recorder.kept.set(Offer::None),
        _ => return,
    };
    // Afterwards: what hides a button must not do so while it is being pressed.
    spawn_local(async move { act(desk) });
}
