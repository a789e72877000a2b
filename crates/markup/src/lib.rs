//! Builds HTML and SVG from elements. Every text and attribute is escaped.

/// An element with its content.
#[derive(Clone, Debug)]
pub struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    content: Vec<Content>,
}

#[derive(Clone, Debug)]
enum Content {
    Element(Element),
    Text(String),
}

/// Elements without content and end tag.
const EMPTY: [&str; 6] = ["meta", "line", "path", "rect", "circle", "polyline"];

impl Element {
    /// An element without attributes and content.
    #[must_use]
    pub const fn new(name: &'static str) -> Self {
        Self {
            name,
            attributes: Vec::new(),
            content: Vec::new(),
        }
    }

    /// With this attribute.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.attributes.push((name, value.into()));
        self
    }

    /// With this text behind its content.
    #[must_use]
    pub fn text(mut self, text: impl Into<String>) -> Self {
        self.content.push(Content::Text(text.into()));
        self
    }

    /// With this element behind its content.
    #[must_use]
    pub fn child(mut self, element: Self) -> Self {
        self.content.push(Content::Element(element));
        self
    }

    /// With these elements behind its content.
    #[must_use]
    pub fn children(mut self, elements: impl IntoIterator<Item = Self>) -> Self {
        self.content
            .extend(elements.into_iter().map(Content::Element));
        self
    }

    /// Appends it to a text.
    pub fn write(&self, out: &mut String) {
        out.push('<');
        out.push_str(self.name);
        for (name, value) in &self.attributes {
            out.push(' ');
            out.push_str(name);
            out.push_str("=\"");
            push_escaped(out, value);
            out.push('"');
        }
        out.push('>');
        if EMPTY.contains(&self.name) {
            // SVG in HTML may omit the end tag of a shape only if the tag is self-closing.
            if self.name != "meta" {
                out.insert(out.len() - 1, '/');
            }
            return;
        }
        for content in &self.content {
            match content {
                Content::Element(element) => element.write(out),
                // The style sheet is a constant, and HTML does not decode entities in it.
                Content::Text(text) if self.name == "style" => out.push_str(text),
                Content::Text(text) => push_escaped(out, text),
            }
        }
        out.push_str("</");
        out.push_str(self.name);
        out.push('>');
    }
}

fn push_escaped(out: &mut String, text: &str) {
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            _ => out.push(letter),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_attributes_are_escaped() {
        let mut out = String::new();
        let link = Element::new("p")
            .with("title", "\"a\" & 'b'")
            .text("<script>");
        let shape = Element::new("line").with("x1", "7");
        link.child(shape).write(&mut out);
        assert_eq!(
            out,
            "<p title=\"&quot;a&quot; &amp; &#39;b&#39;\">&lt;script&gt;<line x1=\"7\"/></p>"
        );
    }
}
