//! The height of the graph that the user has dragged it to. It is a property of the whole page from its first paint on,
//! so that nothing moves when the graph is loaded.

use leptos::prelude::document;
use wasm_bindgen::JsCast;
use web_sys::HtmlElement;

use crate::model::local_storage::{remember as store, remembered};

/// The storage key.
const STORED_AS: &str = "graph-height";

/// Shows the remembered height.
pub(crate) fn show_remembered() {
    show(remembered(STORED_AS).and_then(|height| height.parse().ok()));
}

/// Shows a height in CSS pixels, within the bounds of the style sheet; `None` is the height of the style sheet.
pub(crate) fn show(height_px: Option<i32>) {
    let root = document().document_element();
    let Some(root) = root.and_then(|root| root.dyn_into::<HtmlElement>().ok()) else {
        return;
    };
    let height = height_px.map_or_else(String::new, |height| format!("{height}px"));
    // It fails only for invalid values. An empty one removes the property.
    let _ = root.style().set_property("--graph-height", &height);
}

/// Remembers it for the next visit.
pub(crate) fn remember(height_px: Option<i32>) {
    let height = height_px.map_or_else(String::new, |height| height.to_string());
    store(STORED_AS, &height);
}
