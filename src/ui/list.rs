//! Lists whose HTML comes from a pure function, and which keep the focus when they change.

use leptos::prelude::*;
use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement, MouseEvent};

/// Replaces the HTML of a list and keeps the focus of a keyboard user: the element with the same value of `attribute`
/// gets it again.
pub(crate) fn replace_keeping_focus(list: &Element, html: &str, attribute: &str) {
    let held = document()
        .active_element()
        .filter(|focused| list.contains(Some(focused)))
        .and_then(|element| element.get_attribute(attribute));
    list.set_inner_html(html);
    let Some(held) = held else { return };
    let again = list.query_selector(&format!("[{attribute}='{held}']"));
    if let Some(element) = again.ok().flatten()
        && let Ok(element) = element.dyn_into::<HtmlElement>()
    {
        // Without the focus the element is in the list all the same.
        let _ = element.focus();
    }
}

/// The position of the scroll bar, in whole pixels.
#[allow(
    clippy::cast_possible_truncation,
    clippy::unnecessary_cast,
    reason = "a float cast saturates, and a part of a pixel is nothing to see; without the flag for \
              Web Serial it is a whole number"
)]
pub(crate) fn scroll_px(scroller: &HtmlElement) -> i32 {
    scroller.scroll_top() as i32
}

/// The value of the button that was clicked.
pub(crate) fn clicked_value(event: &MouseEvent) -> Option<String> {
    let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let button = target.and_then(|at| at.closest("button").ok().flatten());
    button.and_then(|button| button.get_attribute("value"))
}
