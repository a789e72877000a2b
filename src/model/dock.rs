//! How the dock with graph and packet log is shown: its height, whether it is folded, and which of the two is shown where
//! there is no room for both. These are properties of the whole page from its first paint on, so that nothing moves when
//! the dock is loaded.

use leptos::prelude::document;
use wasm_bindgen::JsCast;
use web_sys::HtmlElement;

use crate::model::local_storage::{remember, remembered};

/// The storage key of the height. Earlier versions stored the height of the graph, which is the same.
const HEIGHT: &str = "graph-height";

/// The storage key of [`Look`].
const LOOK: &str = "dock";

/// The property of the root element with the height.
const PROPERTY: &str = "--graph-height";

/// The attribute of the root element with [`Look`], which the style sheet reads.
const ATTRIBUTE: &str = "data-dock";

/// What is shown of the dock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Look {
    /// Only its title is shown.
    pub(crate) folded: bool,
    /// The packet log is shown, not the graph, where there is no room for both.
    pub(crate) log: bool,
}

/// Shows what is remembered.
pub(crate) fn show_remembered() {
    show_height(remembered(HEIGHT).and_then(|height| height.parse().ok()));
    show_words(&remembered(LOOK).unwrap_or_default());
}

/// Shows a height in CSS pixels, within the bounds of the style sheet; `None` is the height of the style sheet.
pub(crate) fn show_height(height_px: Option<i32>) {
    let height = height_px.map_or_else(String::new, |height| format!("{height}px"));
    if let Some(root) = root() {
        // It fails only for invalid values. An empty one removes the property.
        let _ = root.style().set_property(PROPERTY, &height);
    }
}

/// The height to which the dock was dragged; `None` is the height of the style sheet.
pub(crate) fn height() -> Option<i32> {
    let height = root()?.style().get_property_value(PROPERTY).ok()?;
    height.strip_suffix("px")?.parse().ok()
}

/// Remembers it for the next visit.
pub(crate) fn remember_height(height_px: Option<i32>) {
    let height = height_px.map_or_else(String::new, |height| height.to_string());
    remember(HEIGHT, &height);
}

/// What is shown.
pub(crate) fn look() -> Look {
    let words = root().and_then(|root| root.get_attribute(ATTRIBUTE));
    let words = words.unwrap_or_default();
    let has = |word| words.split(' ').any(|it| it == word);
    Look {
        folded: has("folded"),
        log: has("log"),
    }
}

/// Shows it, and remembers it for the next visit.
pub(crate) fn show(look: Look) {
    let words = match (look.folded, look.log) {
        (false, false) => "",
        (true, false) => "folded",
        (false, true) => "log",
        (true, true) => "folded log",
    };
    show_words(words);
    remember(LOOK, words);
}

fn show_words(words: &str) {
    if let Some(root) = root() {
        // It fails only for invalid names.
        let _ = root.set_attribute(ATTRIBUTE, words);
    }
}

fn root() -> Option<HtmlElement> {
    document().document_element()?.dyn_into().ok()
}
