//! The keys of a tablist and of a radiogroup.

use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement, KeyboardEvent};

/// An arrow key, Home or End chooses another button of the same list, and takes the focus there. What is hidden is left
/// out.
pub(crate) fn move_choice(event: &KeyboardEvent) {
    let from = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let Some(from) = from else { return };
    let mut shown = Vec::new();
    let parent = from.parent_element();
    let mut next = parent.and_then(|parent| parent.first_element_child());
    while let Some(button) = next {
        next = button.next_element_sibling();
        if !button.has_attribute("hidden") {
            shown.push(button);
        }
    }
    let last = shown.len().saturating_sub(1);
    let place = shown.iter().position(|button| *button == from);
    let place = place.unwrap_or_default();
    // The other arrow keys scroll a page with tabs.
    let is_radio = from.get_attribute("role").as_deref() == Some("radio");
    let place = match event.key().as_str() {
        "ArrowDown" | "ArrowUp" if !is_radio => return,
        "ArrowRight" | "ArrowDown" if place == last => 0,
        "ArrowRight" | "ArrowDown" => place + 1,
        "ArrowLeft" | "ArrowUp" => place.checked_sub(1).unwrap_or(last),
        "Home" => 0,
        "End" => last,
        _ => return,
    };
    event.prevent_default();
    let to = shown.into_iter().nth(place);
    if let Some(to) = to.and_then(|to| to.dyn_into::<HtmlElement>().ok()) {
        to.click();
        // Without the focus it is chosen all the same.
        let _ = to.focus();
    }
}
