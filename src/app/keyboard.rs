//! The keyboard: keys that work wherever the focus is, and focus that does not get in their way.

use std::{cell::Cell, rc::Rc};

use leptos::prelude::*;
use motorlink_messages::bus::StopReason;
use wasm_bindgen::JsCast;
use web_sys::{Element, Event, HtmlElement, HtmlInputElement, KeyboardEvent, MouseEvent, Window};

use crate::{
    app::features::Features,
    model::keys::{Focus, Reaction, Scene, StopKey, StopKeys, key_action},
    ui::listener::on_window,
};

/// Listens to the keyboard from now on.
pub(crate) fn listen(features: Features) {
    let stop_keys = Rc::new(Cell::new(StopKeys::default()));
    for name in ["keydown", "keyup"] {
        let stop_keys = Rc::clone(&stop_keys);
        on_window(name, move |event| {
            if let Some(event) = event.dyn_ref::<KeyboardEvent>() {
                on_key(features, &stop_keys, event);
            }
        });
    }
    // Of elements that lose the focus too: a release that is heard without its press stops.
    on_window("blur", move |event| {
        if event
            .target()
            .is_some_and(|target| target.is_instance_of::<Window>())
        {
            stop_keys.set(StopKeys::default());
        }
    });
    on_window("click", blur_clicked_button);
}

fn on_key(features: Features, stop_keys: &Cell<StopKeys>, event: &KeyboardEvent) {
    let goes_down = event.type_() == "keydown";
    let key = event.key();
    if let Some(key) = StopKey::of(&key) {
        let scene = Scene {
            focus: focus(),
            driven: features.page.is_anything_driven(),
            halted: features.page.latest.with_value(|session| session.halted),
        };
        let mut keys = stop_keys.get();
        let reaction = if goes_down {
            keys.down(key, event.repeat(), scene)
        } else {
            keys.up(key, scene)
        };
        stop_keys.set(keys);
        if reaction == Reaction::Stop {
            features.stop_all(StopReason::Operator);
        }
        if reaction != Reaction::Pass {
            event.prevent_default();
        }
        return;
    }
    let modified = event.ctrl_key() || event.alt_key() || event.meta_key();
    // While a dialog asks for attention, nothing is driven behind it; nor beside a textbox that takes
    // hex digits, most of which are keys that drive.
    if goes_down
        && !event.repeat()
        && let Some(action) = key_action(&key, modified, focus())
        && features.page.dialog.with_untracked(Option::is_none)
        && !(action.drives() && features.page.loops.tab.get_untracked().is_tool())
    {
        event.prevent_default();
        features.run_key_action(action);
    }
}

fn focus() -> Focus {
    let Some(focused) = document().active_element() else {
        return Focus::Free;
    };
    match focused.tag_name().as_str() {
        "TEXTAREA" => Focus::Text,
        // The focus is on an option while a list is open that the page draws itself.
        "SELECT" | "OPTION" => Focus::List,
        "INPUT" => match focused.dyn_ref::<HtmlInputElement>() {
            Some(input) => match input.type_().as_str() {
                "range" => Focus::Free,
                "checkbox" | "radio" | "file" => Focus::Button,
                _ => Focus::Text,
            },
            None => Focus::Text,
        },
        // A tab has nothing that Space could press: it is chosen by being focused.
        "BUTTON" if focused.get_attribute("role").as_deref() == Some("tab") => Focus::Free,
        "BUTTON" | "A" | "SUMMARY" => Focus::Button,
        _ => Focus::Free,
    }
}

/// A button that was clicked with the mouse gives up the focus, so that the next Space stops all
/// motors at a standstill too and does not press it again. One that is reached by Tab keeps it.
#[allow(clippy::needless_pass_by_value, reason = "the signature of a listener")]
fn blur_clicked_button(event: Event) {
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
