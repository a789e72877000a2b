//! The whole picture as markup, and the classes of its moving parts.

use crate::features::telemetry::twin::{artwork, dial, gradients::gradients, markup::Markup};

/// Left, top, width and height of the picture in millimetres. The scale is open at the bottom, so the picture ends
/// there with the wheel's shadow.
pub const VIEW_BOX: &str = "-74 -72 148 138";

/// Everything inside the `svg` element.
#[must_use]
pub fn picture() -> String {
    let mut art = Markup::default();
    // The painter fills it in.
    art.element("desc", |_| ());
    art.element("defs", gradients);
    dial::ring(&mut art);
    artwork::wheel(&mut art);
    dial::needles(&mut art);
    art.finish()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn all_between<'a>(text: &'a str, before: &str, after: char) -> BTreeSet<&'a str> {
        text.split(before)
            .skip(1)
            .filter_map(|rest| rest.split(after).next())
            .collect()
    }

    #[test]
    fn every_gradient_is_defined_and_used() {
        let picture = picture();
        let defined = all_between(&picture, "Gradient id=\"", '"');
        let used = all_between(&picture, "url(#", ')');
        assert_eq!(defined, used);
    }

    /// The page's content security policy forbids both.
    #[test]
    fn no_inline_style_and_no_script() {
        let picture = picture();
        assert!(!picture.contains("style"));
        assert!(!picture.contains("script"));
        assert!(!picture.contains("on="));
    }

    #[test]
    fn every_number_is_a_number() {
        assert!(!picture().contains("NaN") && !picture().contains("inf"));
    }

    #[test]
    fn every_element_is_closed() {
        let picture = picture();
        let opened = picture.matches('<').count() - picture.matches("</").count();
        let closed = picture.matches("</").count() + picture.matches("/>").count();
        assert_eq!(opened, closed);
    }

    #[test]
    fn every_class_has_a_style() {
        // Classes that only the painter uses.
        let handles = ["twin-turning", "twin-wheel"];
        let sheet = include_str!("../../../../style/30-twin.css");
        let picture = picture();
        for class in all_between(&picture, "class=\"", '"') {
            let styled = handles.contains(&class) || sheet.contains(&format!(".{class}"));
            assert!(styled, "{class} has no style");
        }
    }

    /// The browser parses it on the first load.
    #[test]
    fn the_picture_is_small() {
        assert!(picture().len() < 40_000, "{} bytes", picture().len());
    }
}
