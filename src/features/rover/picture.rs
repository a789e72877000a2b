//! The vehicle from above as markup. One unit is one millimetre; the middle of the vehicle is the origin, and its nose
//! points up.

use std::fmt::Write;

use motorlink_i18n::tr;
use motorlink_messages::experiments::vehicle::{Geometry, Place, Vehicle, Wheel};

use crate::ui::{escape::escaped, format};

/// Length of a bar beside a wheel, in mm per rpm.
pub(crate) const BAR_MM_PER_RPM: f64 = 0.5;

/// The lengths of a drawing, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) radius: f64,
    pub(crate) half_tyre: f64,
    /// From the middle to either end of the body.
    pub(crate) nose: f64,
    /// From the middle to the upper edge of the picture.
    pub(crate) half: f64,
    /// From the middle to either side, the wheels with their bars included.
    pub(crate) half_width: f64,
    /// Between the lines of the grid.
    pub(crate) grid: f64,
}

impl Scale {
    pub(crate) fn of(vehicle: &Vehicle, geometry: Geometry) -> Self {
        let radius = geometry.radius_mm();
        let half_tyre = geometry.tyre_mm() / 2.0;
        let wheels = vehicle.base_mm(geometry) / 2.0 + radius;
        let nose = wheels.max(geometry.track_mm() * 0.45);
        let half = 1.5 * nose.max(geometry.track_mm() / 2.0 + radius);
        Self {
            radius,
            half_tyre,
            nose,
            half,
            half_width: geometry.track_mm() / 2.0 + 3.0 * half_tyre,
            grid: if half > 800.0 { 500.0 } else { 100.0 },
        }
    }

    /// The view box: the cards of the wheels lie beside it, and the panel shows the ground below them.
    pub(crate) fn view_box(self) -> String {
        let Self {
            half, half_width, ..
        } = self;
        let (width, height) = (2.0 * half_width, 2.0 * half);
        format!("{:.0} {:.0} {width:.0} {height:.0}", -half_width, -half)
    }
}

/// Everything inside the `svg` element.
pub(crate) fn picture(vehicle: &Vehicle, geometry: Geometry) -> String {
    let scale = Scale::of(vehicle, geometry);
    let mut art = String::from("<desc></desc><defs>");
    for head in ["commanded", "measured"] {
        // Writing to a string cannot fail.
        let _ = write!(
            art,
            "<marker id=\"rover-head-{head}\" class=\"rover-head {head}\" viewBox=\"0 0 6 6\" refX=\"2\" \
             refY=\"3\" markerWidth=\"3\" markerHeight=\"3\" orient=\"auto\"><path d=\"M0 0L6 3L0 6Z\"/></marker>"
        );
    }
    art.push_str("</defs>");
    ground(&mut art, scale);
    body(&mut art, vehicle, geometry, scale);
    for (wheel, place) in vehicle.wheels().iter().zip(vehicle.places(geometry)) {
        draw_wheel(&mut art, wheel, place, scale);
    }
    for arrow in ["commanded", "measured"] {
        let _ = write!(
            art,
            "<path class=\"rover-arrow {arrow}\" d=\"\" marker-end=\"url(#rover-head-{arrow})\"/>"
        );
    }
    art
}

/// The grid and the path, which turn and move below the vehicle.
fn ground(art: &mut String, scale: Scale) {
    // The panel is up to three times as wide as high, and the ground turns.
    let lines = (scale.half * 3.3 / scale.grid).ceil();
    let reach = lines * scale.grid;
    art.push_str("<g class=\"rover-ground\"><path class=\"rover-grid\" d=\"");
    let mut at = -reach;
    while at <= reach {
        let length = 2.0 * reach;
        let _ = write!(art, "M{at} {}v{length}M{} {at}h{length}", -reach, -reach);
        at += scale.grid;
    }
    art.push_str(
        "\"/><g class=\"rover-trail\"><g id=\"rover-path\"><path class=\"rover-known\"/>\
         <path class=\"rover-bridged\"/><path class=\"rover-gaps\"/></g>\
         <circle class=\"rover-start\" r=\"9\"/></g></g>",
    );
}

fn body(art: &mut String, vehicle: &Vehicle, geometry: Geometry, scale: Scale) {
    let half_width = geometry.track_mm() / 2.0;
    for place in vehicle.places(geometry) {
        let _ = write!(
            art,
            "<path class=\"rover-axle\" d=\"M0 {:.1}H{:.1}\"/>",
            place.y, place.x
        );
    }
    let (side, nose) = (
        (half_width - scale.half_tyre * 1.9).max(half_width * 0.3),
        scale.nose,
    );
    let _ = write!(
        art,
        "<rect class=\"rover-body\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"{:.1}\"/>\
         <path class=\"rover-nose\" d=\"M{:.1} {:.1}L0 {:.1}L{:.1} {:.1}Z\"/>",
        -side,
        -nose,
        side * 2.0,
        nose * 2.0,
        side * 0.28,
        -side * 0.22,
        -nose + side * 0.52,
        -nose + side * 0.18,
        side * 0.22,
        -nose + side * 0.52,
    );
}

fn draw_wheel(art: &mut String, wheel: &Wheel, place: Place, scale: Scale) {
    let Scale {
        radius, half_tyre, ..
    } = scale;
    let outside = if wheel.is_right { 1.0 } else { -1.0 };
    let (number, width, height) = (wheel.id.get(), 2.0 * half_tyre, 2.0 * radius);
    let _ = write!(
        art,
        "<g class=\"rover-wheel\" data-wheel=\"{number}\" transform=\"translate({:.1} {:.1})\">\
         <rect class=\"rover-tyre\" x=\"{:.1}\" y=\"{:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"{:.1}\"/>\
         <path class=\"rover-blocks\"/><path class=\"rover-mark\"/>\
         <path class=\"rover-edge\" d=\"M{:.1} {:.1}h{width:.1}v{:.1}h{:.1}ZM{:.1} {:.1}h{width:.1}v{:.1}h{:.1}Z\"/>\
         <path class=\"rover-bar commanded\" transform=\"translate({:.1} 0)\"/>\
         <path class=\"rover-bar measured\" transform=\"translate({:.1} 0)\"/>\
         <text class=\"rover-id\" x=\"{:.1}\" y=\"{:.1}\">{}</text>\
         <g class=\"rover-alarm\"><circle r=\"{:.1}\"/><text y=\"0\">!</text></g></g>",
        place.x,
        place.y,
        -half_tyre,
        -radius,
        half_tyre * 0.45,
        -half_tyre,
        -radius,
        radius * 0.3,
        -width,
        -half_tyre,
        radius,
        -radius * 0.3,
        -width,
        outside * half_tyre * 1.75,
        outside * half_tyre * 1.4,
        -outside * half_tyre * 3.6,
        -radius * 0.5,
        wheel.id,
        half_tyre * 0.7,
    );
}

/// The list of the wheels' cards, one list for each side.
pub(crate) fn cards(vehicle: &Vehicle) -> String {
    let mut html = String::new();
    for (right, name) in [(false, tr!("Left wheels")), (true, tr!("Right wheels"))] {
        let _ = write!(
            html,
            "<ul class=\"rover-cards\" role=\"list\" aria-label=\"{name}\">"
        );
        for wheel in vehicle.side(right) {
            let _ = write!(
                html,
                "<li class=\"rover-card\" data-card=\"{}\"><b><span>{}</span> <span>{}</span></b>\
                 <span class=\"rover-speed\"><span></span> {}</span>\
                 <span class=\"rover-rest\"></span><span class=\"rover-trouble\"></span></li>",
                wheel.id.get(),
                escaped(&wheel.name),
                wheel.id,
                format::rpm()
            );
        }
        html.push_str("</ul>");
    }
    html
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::model::vehicle::{tests::names, vehicle_of};

    fn of(count: u8) -> (Vehicle, Geometry) {
        (vehicle_of(&names(count)).unwrap(), Geometry::default())
    }

    fn classes(markup: &str) -> BTreeSet<&str> {
        let lists = markup.split("class=\"").skip(1);
        lists
            .filter_map(|rest| rest.split('"').next())
            .flat_map(str::split_whitespace)
            .collect()
    }

    #[test]
    fn every_class_has_a_style() {
        let (vehicle, geometry) = of(4);
        let sheet = include_str!("../../../style/later/46-rover.css");
        // A place that only the painter uses.
        let handles = ["rover-ground", "rover-trail"];
        for class in classes(&(picture(&vehicle, geometry) + &cards(&vehicle))) {
            let styled = handles.contains(&class) || sheet.contains(&format!(".{class}"));
            assert!(styled, "{class} has no style");
        }
    }

    /// The page's content security policy forbids both.
    #[test]
    fn no_inline_style_and_no_script_and_every_element_is_closed() {
        for count in [2, 4, 8] {
            let (vehicle, geometry) = of(count);
            let markup = picture(&vehicle, geometry) + &cards(&vehicle);
            assert!(!markup.contains("style=") && !markup.contains("script"));
            assert!(!markup.contains("NaN") && !markup.contains("inf"));
            let closed = markup.matches("</").count() + markup.matches("/>").count();
            assert_eq!(
                markup.matches('<').count() - markup.matches("</").count(),
                closed
            );
        }
    }

    #[test]
    fn a_name_is_text() {
        let mut names = names(2);
        names.change(crate::model::scan_texts::tests::id(1), |member| {
            member.set_name("<b>\"Left\"");
        });
        let html = cards(&vehicle_of(&names).unwrap());
        assert!(html.contains("&lt;b&gt;&quot;Left&quot;"), "{html}");
    }

    #[test]
    fn the_picture_has_room_for_the_vehicle_and_its_arrow() {
        for (count, radius, track) in [(2, 51, 300), (8, 51, 300), (4, 500, 3_000), (2, 10, 50)] {
            let (vehicle, _) = of(count);
            let geometry = Geometry::new(radius, track).unwrap();
            let scale = Scale::of(&vehicle, geometry);
            assert!(scale.half > vehicle.base_mm(geometry) / 2.0 + scale.radius);
            assert!(scale.half > geometry.track_mm() / 2.0 + scale.radius);
            assert!(picture(&vehicle, geometry).len() < 40_000);
        }
    }
}
