//! Attributes of drawings: a drawing changes by a few attributes of elements that stay.

use web_sys::Element;

/// One attribute of one element, written only when it changes.
pub(crate) struct Attribute {
    element: Element,
    name: &'static str,
    written: String,
}

impl Attribute {
    pub(crate) const fn of(element: Element, name: &'static str) -> Self {
        Self {
            element,
            name,
            written: String::new(),
        }
    }

    /// The attribute of the first element in `inside` that the selector finds; `None` if there is none.
    pub(crate) fn find(inside: &Element, selector: &str, name: &'static str) -> Option<Self> {
        let element = inside.query_selector(selector).ok().flatten()?;
        Some(Self::of(element, name))
    }

    pub(crate) fn set(&mut self, value: String) {
        if self.written != value {
            // It fails for invalid names; these are valid.
            let _ = self.element.set_attribute(self.name, &value);
            self.written = value;
        }
    }

    pub(crate) fn rotate(&mut self, clockwise_deg: f64) {
        self.set(format!("rotate({clockwise_deg:.2})"));
    }
}
