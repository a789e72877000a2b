//! The keyboard: keys that work anywhere on the page.

use std::{
    cell::{Cell, RefCell},
    rc::Rc,
};

use leptos::prelude::*;
use motorlink_messages::bus::StopReason;
use wasm_bindgen::JsCast;
use web_sys::{Element, Event, HtmlElement, HtmlInputElement, KeyboardEvent, MouseEvent};

use crate::{
    app::features::Features,
    model::{
        keys::{Focus, Reaction, Scene, StopKey, StopKeys, key_action},
        page::{Dialog, Page},
        place::Place,
        replay::{self, Crossing},
        snapshot::Session,
    },
    ui::listener::{is_of_window, on_window},
};

thread_local! {
    /// The element that had the focus when a key was last pressed, or has got it since. `None` behind Tab, until a control
    /// gets the focus.
    static LAST_TARGET: RefCell<Option<Element>> = const { RefCell::new(None) };
}

/// What had the focus when a key was last pressed, or has got it since. `None` behind Tab, until a control gets the focus.
pub(crate) fn last_target() -> Option<Element> {
    LAST_TARGET.with_borrow(Clone::clone)
}

/// A control has got the focus.
pub(crate) fn has_focus(target: Element) {
    LAST_TARGET.set(Some(target));
}

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
    // Events of elements that lose the focus too: a release without its press stops.
    on_window("blur", move |event| {
        if is_of_window(&event) {
            stop_keys.set(StopKeys::default());
        }
    });
    on_window("click", blur_clicked_button);
}

fn on_key(features: Features, stop_keys: &Cell<StopKeys>, event: &KeyboardEvent) {
    let goes_down = event.type_() == "keydown";
    let key = event.key();
    if goes_down {
        LAST_TARGET.set(document().active_element().filter(|_| key != "Tab"));
    }
    if let Some(key) = StopKey::of(&key) {
        let scene = Scene {
            focus: focus(),
            driven: features.page.is_anything_driven(),
            at_rest: features.page.is_known_to_rest(),
            halted: features.page.latest.with_value(Session::is_halted),
        };
        let mut keys = stop_keys.get();
        let reaction = if goes_down {
            keys.down(key, event.repeat(), scene)
        } else {
            keys.up(key, scene)
        };
        stop_keys.set(keys);
        let handled = match reaction {
            Reaction::Stop => {
                features.stop_all(StopReason::Operator);
                true
            }
            Reaction::Take => true,
            Reaction::Close => close_one(features.page) || replay::keeps(Crossing::Stop),
            Reaction::Pass => false,
        };
        if handled {
            event.prevent_default();
        }
        return;
    }
    // A held Enter presses a button again and again. When it closes a dialog, it would press the button that gets the
    // focus.
    if key == "Enter" && event.repeat() && focus() == Focus::Button {
        event.prevent_default();
        return;
    }
    let modified = event.ctrl_key() || event.alt_key() || event.meta_key();
    // Keys do not drive while a dialog is open, nor where the controls are not shown: most hex digits are drive keys.
    if goes_down
        && !event.repeat()
        && let Some(action) = key_action(&key, modified, focus())
        && features.page.dialog.with_untracked(Option::is_none)
        && (!action.drives() || features.page.open.get_untracked().place == Place::Drive)
    {
        event.prevent_default();
        features.run_key_action(action);
    }
}

/// What Escape ends before a panel, while it has the focus: the text of a filter, the note of a bookmark.
const FIRST_TO_ESCAPE: &str = "[type=search]:focus:not(:placeholder-shown),.replay-bookmark :focus";

/// Closes the innermost open thing: a dialog, the text of the focused filter, a panel. Returns false if the focused
/// control has to do it, or if nothing is open.
fn close_one(page: Page) -> bool {
    let dialog = page.dialog.get_untracked();
    if let Some(Dialog::Help(_)) = dialog {
        page.dialog.set(None);
    } else if dialog.is_some() {
        page.decline();
    } else {
        let inner = document().query_selector(FIRST_TO_ESCAPE);
        if page.open.get_untracked().panel.is_none() || matches!(inner, Ok(Some(_))) {
            return false;
        }
        page.show_panel(None);
    }
    true
}

fn focus() -> Focus {
    let Some(focused) = document().active_element() else {
        return Focus::Free;
    };
    match focused.tag_name().as_str() {
        "TEXTAREA" => Focus::Text,
        // In an open list that the page draws itself, the focus is on an option.
        "SELECT" | "OPTION" => Focus::List,
        "INPUT" if focused.get_attribute("role").as_deref() == Some("spinbutton") => Focus::Number,
        "INPUT" => match focused.dyn_ref::<HtmlInputElement>() {
            Some(input) => match input.type_().as_str() {
                "range" => Focus::Free,
                "checkbox" | "radio" | "file" => Focus::Button,
                _ => Focus::Text,
            },
            None => Focus::Text,
        },
        // Space does not press a tab: focusing a tab selects it.
        "BUTTON" if focused.get_attribute("role").as_deref() == Some("tab") => Focus::Free,
        "BUTTON" | "A" | "SUMMARY" => Focus::Button,
        _ => Focus::Free,
    }
}

/// Removes the focus from a button that was clicked with the mouse, so that the next Space stops all
/// motors instead of pressing the button again. A button reached by Tab keeps the focus.
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
        // Not every browser focuses a clicked button.
        let _ = button.blur();
    }
}
