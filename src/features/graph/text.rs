use web_sys::Element;

/// One text of the page, written only when it changes.
pub(crate) struct Text {
    element: Element,
    written: String,
}

impl Text {
    pub(crate) fn of(element: Element) -> Self {
        Self {
            element,
            written: String::new(),
        }
    }

    pub(crate) fn set(&mut self, text: String) {
        if self.written != text {
            self.element.set_text_content(Some(&text));
            self.written = text;
        }
    }
}
