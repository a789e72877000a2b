//! Texts of elements that change often.

use web_sys::Element;

/// The text of one element, written only when it changes.
pub(crate) struct Text {
    element: Element,
    written: String,
}

impl Text {
    pub(crate) const fn of(element: Element) -> Self {
        Self {
            element,
            written: String::new(),
        }
    }

    /// The text of the first element in `inside` that the selector finds; `None` if there is none.
    pub(crate) fn find(inside: &Element, selector: &str) -> Option<Self> {
        let element = inside.query_selector(selector).ok().flatten()?;
        Some(Self::of(element))
    }

    pub(crate) fn set(&mut self, text: &str) {
        if self.written != text {
            write_text(&self.element, text);
            text.clone_into(&mut self.written);
        }
    }
}

/// Writes the text of an element that is empty or has one text node.
///
/// For a new text node, the browser checks the rules with `:has()` for all elements around it. Where a browser has
/// translated the page, an element holds the text; then it gets a new one.
pub(crate) fn write_text(element: &Element, text: &str) {
    match element.first_child() {
        Some(node) if element.first_element_child().is_none() => node.set_node_value(Some(text)),
        _ => element.set_text_content(Some(text)),
    }
}
