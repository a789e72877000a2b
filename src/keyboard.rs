//! The keyboard: keys that act wherever the focus is, and focus that does not get in their way.

use leptos::prelude::*;
use motorlink_messages::bus::StopReason;
use wasm_bindgen::JsCast;
use web_sys::{Element, Event, HtmlElement, HtmlInputElement, KeyboardEvent, MouseEvent};

use crate::{
    desk::Desk,
    keys::{Act, Focus, act},
    listener::on_window,
};

/// Listens to the keyboard from now on.
pub(crate) fn listen(desk: Desk) {
    on_window("keydown", move |event| {
        if let Some(event) = event.dyn_ref::<KeyboardEvent>() {
            key_down(desk, event);
        }
    });
    on_window("click", let_go_of_clicked_button);
}

fn key_down(desk: Desk, event: &KeyboardEvent) {
    let modified = event.ctrl_key() || event.alt_key() || event.meta_key();
    let Some(act) = act(&event.key(), modified, focus()) else {
        return;
    };
    // While a dialog asks for attention, nothing is driven behind it; nor beside a textbox that takes
    // hex digits, most of which are keys that drive.
    if act == Act::StopAll {
        // A key held down is one press, as long as the first was heard.
        if !event.repeat() || !desk.latest.with_value(|session| session.halted) {
            desk.stop_all(StopReason::Operator);
        }
        event.prevent_default();
    } else if !event.repeat()
        && desk.dialog.with_untracked(Option::is_none)
        && !(act.drives() && desk.tab.get_untracked().is_tool())
    {
        event.prevent_default();
        desk.act(act);
    }
}

fn focus() -> Focus {
    let Some(focused) = document().active_element() else {
        return Focus::Free;
    };
    match focused.tag_name().as_str() {
        "TEXTAREA" | "SELECT" => Focus::Text,
        "INPUT" => match focused.dyn_ref::<HtmlInputElement>() {
            Some(input) if input.type_() == "range" => Focus::Free,
            Some(input) if input.type_() == "checkbox" => Focus::Button,
            _ => Focus::Text,
        },
        // A tab has nothing that Space could press: it is chosen by being focused.
        "BUTTON" if focused.get_attribute("role").as_deref() == Some("tab") => Focus::Free,
        "BUTTON" | "A" | "SUMMARY" => Focus::Button,
        _ => Focus::Free,
    }
}

/// A button that was clicked with the mouse gives up the focus, so that the next Space stops all
/// motors and does not press it again. One that is reached by Tab keeps it.
#[allow(clippy::needless_pass_by_value, reason = "the signature of a listener")]
fn let_go_of_clicked_button(event: Event) {
    let by_pointer = event
        .dyn_ref::<MouseEvent>()
        .is_some_and(|click| click.detail() > 0);
    let target = event
        .target()
        .and_then(|target| target.dyn_into::<Element>().ok());
    let button = target.and_then(|target| target.closest("button").ok().flatten());
    if by_pointer
        && let Some(button) = button.and_then(|button| button.dyn_into::<HtmlElement>().ok())
    {
        // It has it only if it took it; a click gives no focus in every browser.
        let _ = button.blur();
    }
}
