//! The whole picture as markup, and the classes of its moving parts.

use crate::features::telemetry::twin::{
    artwork, dial, gradients::gradients, look::Look, markup::Markup, scale::SpeedScale,
};

/// Left, top, width and height of the picture in millimetres. The scale is open at the bottom, so the picture ends
/// there with the wheel's shadow.
pub const VIEW_BOX: &str = "-74 -72 148 138";

/// Everything inside the `svg` element.
#[must_use]
pub fn picture(look: Look) -> String {
    let scale = SpeedScale {
        limit_rpm: look.speed_rpm_max.into(),
    };
    let mut art = Markup::default();
    // The painter fills it in.
    art.element("desc", |_| ());
    art.element("defs", gradients);
    dial::ring(&mut art, scale);
    artwork::wheel(&mut art, look);
    dial::needles(&mut art, scale);
    art.finish()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use motorlink_messages::protocol::family::Model;

    use super::*;

    fn pictures() -> [String; 4] {
        Model::ALL.map(|model| picture(Look::of(model)))
    }

    fn all_between<'a>(text: &'a str, before: &str, after: char) -> BTreeSet<&'a str> {
        text.split(before)
            .skip(1)
            .filter_map(|rest| rest.split(after).next())
            .collect()
    }

    #[test]
    fn every_gradient_is_defined_and_used() {
        for picture in pictures() {
            let defined = all_between(&picture, "Gradient id=\"", '"');
            let used = all_between(&picture, "url(#", ')');
            assert_eq!(defined, used);
        }
    }

    /// The page's content security policy forbids both.
    #[test]
    fn no_inline_style_and_no_script() {
        for picture in pictures() {
            for forbidden in ["style", "script", "on="] {
                assert!(!picture.contains(forbidden));
            }
        }
    }

    #[test]
    fn every_number_is_a_number() {
        for picture in pictures() {
            assert!(!picture.contains("NaN") && !picture.contains("inf"));
        }
    }

    #[test]
    fn every_element_is_closed() {
        for picture in pictures() {
            let opened = picture.matches('<').count() - picture.matches("</").count();
            let closed = picture.matches("</").count() + picture.matches("/>").count();
            assert_eq!(opened, closed);
        }
    }

    #[test]
    fn every_class_has_a_style() {
        // Classes that only the painter uses.
        let handles = ["twin-pointer", "twin-turning", "twin-wheel"];
        let sheet = include_str!("../../../../style/30-twin.css");
        let [picture, ..] = pictures();
        for class in all_between(&picture, "class=\"", '"') {
            let styled = handles.contains(&class) || sheet.contains(&format!(".{class}"));
            assert!(styled, "{class} has no style");
        }
    }

    /// The browser parses it on the first load.
    #[test]
    fn the_picture_is_small() {
        for picture in pictures() {
            assert!(picture.len() < 40_000, "{} bytes", picture.len());
        }
    }

    #[test]
    fn each_model_has_a_wheel_and_a_scale_of_its_own() {
        let pictures = pictures();
        assert_eq!(BTreeSet::from(pictures.clone()).len(), 4);
        let [_, _, ddsm210, ddsm400] = pictures;
        assert!(ddsm210.contains("pathLength=\"420\""), "up to 210 rpm");
        assert!(ddsm400.contains("pathLength=\"760\""), "up to 380 rpm");
    }
}
